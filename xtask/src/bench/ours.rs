//! What `aquafuse bench --json` says.

use anyhow::{Context, Result};
use serde::Deserialize;

use super::Size;
use super::turns::Turns;
use crate::shell::{command, output, target};

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

/// One turn at this size: frames `cached`, `estimated`, `smoothed`, `restored`, and the stages by name.
pub(super) fn turn(
    turns: &mut Turns,
    (width, height): Size,
    threads: usize,
    frames: &str,
    wanted: &[&str],
) -> Result<Machine> {
    let (size, threads) = (format!("{width}x{height}"), threads.to_string());
    let arguments = ["bench", "--json", "--size", &size, "--threads", &threads, "--frames", frames];
    let said = output(command(target().join("release/aquafuse"), &[&arguments[..], wanted].concat()))?;
    let report: Report = serde_json::from_str(&said).context("`aquafuse bench --json` is not what it was")?;
    for Case { reference, smooth, stages, speed } in &report.results {
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
    for restored in &report.restorations {
        turns.add("restored", restored.ms_per_frame);
    }
    Ok(report.machine)
}
