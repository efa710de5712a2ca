//! `lab variations`: small datasets, folders and scenes of every kind, varied in the ways of users: what is lost without a word.

use std::fs;

use anyhow::{Context, Result};
use xtask::setup::python_environment;
use xtask::shell::{command, output, say, target};

use crate::pages::{RESULTS, show_section};
use crate::programs;

pub(crate) fn run() -> Result<()> {
    let program = programs::aquafuse()?;
    let python = python_environment("python", "xtask/requirements.txt")?.join("bin/python");
    let work = target().join("variations");
    if work.exists() {
        fs::remove_dir_all(&work).context("cannot clear the last run")?;
    }
    say("Varying datasets, folders and scenes (about five minutes)");
    let mut varying = command(python, &["apps/cli/tests/variations.py"]);
    varying.arg(program).arg(work);
    show_section(RESULTS, "variations", &output(varying)?)
}
