//! `cargo xtask helps`: whether a network learns more from a dataset that was multiplied, tried in a water it has not seen.

use std::fs;

use anyhow::{Context, Result};

use crate::results::{RESULTS, write_section};
use crate::setup::trainer_python;
use crate::shell::{cargo, command, output, run, say, target};

pub(crate) fn run_all() -> Result<()> {
    say("Building the command, and the scenes");
    run(cargo(&["build", "--release", "--quiet", "--locked", "--package", "aquafuse-cli"]))?;
    let example = ["--package", "aquafuse-data", "--example", "labelled_scenes"];
    run(cargo(&[&["build", "--release", "--quiet", "--locked"][..], &example].concat()))?;
    let python = trainer_python()?;
    let work = target().join("helps");
    if work.exists() {
        fs::remove_dir_all(&work).context("cannot clear the last run")?;
    }
    say("Training small networks (about an hour on one core)");
    let [scenes, aquafuse] =
        ["release/examples/labelled_scenes", "release/aquafuse"].map(|name| target().join(name));
    let mut training = command(python, &["examples/does_it_help/experiment.py"]);
    training.args([scenes, aquafuse, work]);
    let table = output(training)?;
    println!("{table}");
    write_section(RESULTS, "helps", &table)
}
