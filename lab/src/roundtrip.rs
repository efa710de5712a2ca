//! `lab roundtrip`: datasets in ten layouts, multiplied, and read by the readers that people use.

use std::fs;

use anyhow::{Context, Result};
use xtask::setup::python_environment;
use xtask::shell::{command, output, say, target};

use crate::pages::{RESULTS, show_section};
use crate::programs;

/// Images to train on of each layout; a third as many are to validate by.
const IMAGES: &str = "60";

pub(crate) fn run() -> Result<()> {
    let program = programs::aquafuse()?;
    let python = python_environment("python", "xtask/requirements.txt")?.join("bin/python");
    let work = target().join("roundtrip");
    if work.exists() {
        fs::remove_dir_all(&work).context("cannot clear the last run")?;
    }
    say("Multiplying datasets and reading them again (about a minute)");
    let mut reading = command(python, &["apps/cli/tests/round_trip.py"]);
    reading.arg(program).arg(work).arg(IMAGES);
    let printed = output(reading)?;
    // The readers report their progress.
    let rows = printed.lines().filter(|line| line.starts_with('|'));
    let table: String = rows.map(|line| format!("{line}\n")).collect();
    show_section(RESULTS, "roundtrip", &table)
}
