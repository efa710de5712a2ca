//! `lab helps`: whether a network learns more from a dataset that was multiplied, tried in a water it has not seen.

use std::fs;

use anyhow::{Context, Result};
use xtask::setup::python_environment;
use xtask::shell::{command, output, say, target};

use crate::pages::{RESULTS, show_section};
use crate::programs;

pub(crate) fn run() -> Result<()> {
    let programs = [programs::example("aquafuse-data", "labelled_scenes")?, programs::aquafuse()?];
    let python =
        python_environment("python-trainer", "lab/does_it_help/requirements.txt")?.join("bin/python");
    let work = target().join("helps");
    if work.exists() {
        fs::remove_dir_all(&work).context("cannot clear the last run")?;
    }
    say("Training small networks (about an hour on one core)");
    let mut training = command(python, &["lab/does_it_help/experiment.py"]);
    training.args(programs).arg(work);
    show_section(RESULTS, "helps", &output(training)?)
}
