//! `lab helps`: whether a network learns more from images in other waters, tried in a water it has not seen.

use anyhow::Result;
use xtask::setup::{python_environment, set_up};
use xtask::shell::{command, output, say, target};

use crate::bench::python::install;
use crate::pages::{RESULTS, show_section};
use crate::programs;

/// Trains what is not trained yet, and writes the table of all finished runs. `options` are those of `experiment.py`.
pub(crate) fn run(options: &[&str]) -> Result<()> {
    let scenes = programs::example("aquafuse-data", "labelled_scenes")?;
    let python =
        python_environment("python-trainer", "lab/does_it_help/requirements.txt")?.join("bin/python");
    install(&set_up()?.python, &python)?;
    say(
        "Training small networks (some hours on one core; the same command continues a run that was stopped)",
    );
    let mut training = command(python, &["lab/does_it_help/experiment.py"]);
    training.arg(scenes).arg(target().join("helps")).args(options);
    // One core, as the page says.
    training.env("OMP_NUM_THREADS", "1").env("RAYON_NUM_THREADS", "1");
    show_section(RESULTS, "helps", &output(training)?)
}
