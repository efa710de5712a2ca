//! What `aquafuse bench --json` says.

use anyhow::{Context, Result};
use serde::Deserialize;

use super::Size;
use super::turns::Turns;
use xtask::shell::{command, output, target};

#[derive(Deserialize)]
struct Report {
    machine: Machine,
    results: Vec<Case>,
    restorations: Vec<Speed>,
}

/// The machine, as the command names it.
#[derive(Deserialize)]
pub(super) struct Machine {
    pub(super) processor: String,
    pub(super) cores: usize,
    pub(super) vectors: String,
    pub(super) aquafuse: String,
}

#[derive(Deserialize)]
struct Case {
    threads: usize,
    reference: String,
    smooth: String,
    stages: Stages,
    #[serde(flatten)]
    speed: Speed,
}

#[derive(Deserialize)]
struct Speed {
    ms_per_frame: f64,
}

#[derive(Deserialize)]
struct Stages {
    depth: f64,
    waterbody: f64,
    fusion: f64,
    bilateral: f64,
}

/// What of it is wanted.
pub(super) const ALL: &[&str] = &[];
pub(super) const CACHED: &[&str] = &["--reference", "cached", "--smooth", "none"];

/// One turn at this size on one thread: frames `cached`, `estimated`, `streamed`, `smoothed`, `restored`, and the stages by name.
pub(super) fn turn(turns: &mut Turns, size: Size, frames: &str, wanted: &[&str]) -> Result<Machine> {
    let report = report(size, frames, &[&["--threads", "1"], wanted].concat())?;
    add(turns, report.results.iter());
    for restored in &report.restorations {
        turns.add("restored", restored.ms_per_frame);
    }
    Ok(report.machine)
}

/// One turn on one thread and one on all, of cached frames.
pub(super) fn turns(alone: &mut Turns, together: &mut Turns, size: Size, frames: &str) -> Result<()> {
    let report = report(size, frames, CACHED)?;
    add(alone, report.results.iter().filter(|case| case.threads == 1));
    add(together, report.results.iter().filter(|case| case.threads > 1));
    Ok(())
}

fn report((width, height): Size, frames: &str, wanted: &[&str]) -> Result<Report> {
    let size = format!("{width}x{height}");
    let arguments = ["bench", "--json", "--size", &size, "--frames", frames];
    let said = output(command(target().join("release/aquafuse"), &[&arguments[..], wanted].concat()))?;
    serde_json::from_str(&said).context("`aquafuse bench --json` is not what it was")
}

fn add<'a>(turns: &mut Turns, cases: impl Iterator<Item = &'a Case>) {
    for Case { reference, smooth, stages, speed, .. } in cases {
        let name = match (reference.as_str(), smooth.as_str()) {
            (reference, "none") => reference,
            ("cached", _) => "smoothed",
            _ => continue,
        };
        turns.add(name, speed.ms_per_frame);
        if name == "cached" {
            for (stage, milliseconds) in [
                ("depth", stages.depth),
                ("waterbody", stages.waterbody),
                ("fusion", stages.fusion),
                ("bilateral", stages.bilateral),
            ] {
                turns.add(stage, milliseconds);
            }
        }
    }
}
