//! `lab gst`: the GStreamer element in a live pipeline of 1920 x 1080 at 30 frames a second.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::fmt::Write;

use anyhow::{Context, Result, bail};
use serde::Deserialize;
use xtask::setup::lacks_gstreamer;
use xtask::shell::{self, GST_WORKSPACE, cargo, command, output, say, target};

use crate::pages::{RESULTS, show_section};

const SECONDS: &str = "10";
/// Formats, and what is done in them.
const ROWS: [(&str, &str); 7] = [
    ("RGB", "water=preset:jerlov-3C"),
    ("BGRx", "water=preset:jerlov-3C"),
    ("NV12", "water=preset:jerlov-3C"),
    ("RGB", "water=preset:jerlov-3C content-water=preset:jerlov-IB"),
    ("RGB", "effect=restore"),
    ("RGB", "effect=enhance"),
    ("NV12", "effect=enhance"),
];
/// A pipeline that does nothing: what it takes is the source's and the sink's.
const NOTHING: &str = "effect=none";

#[derive(Deserialize)]
struct Measured {
    sent: u32,
    shown: u32,
    cpu: f64,
    median_ms: f64,
    p95_ms: f64,
    max_ms: f64,
}

pub(crate) fn run() -> Result<()> {
    if let Some(why) = lacks_gstreamer() {
        bail!("{why}");
    }
    say("Building the element");
    let target = target();
    let folder = target.to_string_lossy();
    let build = ["--release", "--quiet", "--locked", "--example", "live", "--target-dir", &folder];
    shell::run(cargo(&[&["build"], &GST_WORKSPACE[..], &build].concat()))?;
    let measure = |format: &str, properties: &str| -> Result<Measured> {
        say(&format!("{format} {properties}"));
        let program = target.join("release/examples/live");
        let line = output(command(program, &[format, SECONDS, properties]))?;
        serde_json::from_str(&line).context("the example does not print its figures")
    };
    let mut table = String::from(
        "| format | properties | frames dropped | share of one core | processor, ms a frame | latency added, ms: median / 95 % / most |\n\
         |---|---|---|---|---|---|\n",
    );
    let mut nothing = BTreeMap::new();
    for (format, properties) in ROWS {
        let nothing = match nothing.entry(format) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(place) => place.insert(measure(format, NOTHING)?),
        };
        let made = measure(format, properties)?;
        let cpu = (made.cpu - nothing.cpu).max(0.0);
        // Frames that were dropped cost nothing.
        let seconds: f64 = SECONDS.parse()?;
        let each = 1e3 * cpu * seconds / f64::from(made.shown.max(1));
        writeln!(
            table,
            "| {format} | `{properties}` | {} of {} | {:.0} % | {each:.1} | {:.1} / {:.1} / {:.1} |",
            made.sent.saturating_sub(made.shown),
            made.sent,
            1e2 * cpu,
            made.median_ms,
            made.p95_ms,
            made.max_ms
        )?;
    }
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    write!(table, "\n{cores} threads")?;
    // What else the machine did is the second half of these figures.
    if let Ok(load) = std::fs::read_to_string("/proc/loadavg") {
        let load = load.split(' ').next().unwrap_or_default();
        write!(
            table,
            "; when this ended, {load} threads wanted to run on average, those of the pipeline among them"
        )?;
    }
    table += ".\n";
    show_section(RESULTS, "gst", &table)
}
