//! `lab multiply`: a dataset of many small images multiplied, against reading and writing alone; killed and
//! gone on with.

pub(crate) mod dataset;

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

use crate::pages::{RESULTS, show_section};
use crate::runner::{End, Limits, Outcome, Runner};
use xtask::shell::{cargo, output, root, say};

pub(crate) const IMAGES: usize = 10_000;
/// Variants of each image.
const TIMES: &str = "2";
const TURNS: usize = 3;
const KILLS: &str = "50";
const LIMITS: Limits = Limits { seconds: 7200, address_space: 16 << 20 };

pub(crate) fn run(image_files: usize) -> Result<()> {
    let program = crate::programs::aquafuse()?;
    let mut runner = Runner::new(LIMITS)?;
    let mut table = String::from(
        "| images of 160 x 120 | variants | images written a second | of reading and writing alone | peak memory, MiB |\n\
         |---|---|---|---|---|\n",
    );
    for count in [image_files / 10, image_files] {
        let folder = root().join("target/multiply").join(count.to_string());
        if folder.exists() {
            fs::remove_dir_all(&folder)?;
        }
        dataset::make(&folder, count)?;
        say(&format!("Multiplying {count} images, {TURNS} turns"));
        let mut ratios = Vec::new();
        let (mut rate, mut peak) = (0.0_f64, 0.0_f64);
        for _ in 0..TURNS {
            let (ours, more) = (augment(&mut runner, &program, &folder)?, plain(&mut runner, &folder)?);
            ratios.push(more.milliseconds / ours.milliseconds);
            let written = 2 * count;
            rate = rate.max(1000.0 * written as f64 / ours.milliseconds);
            peak = peak.max(ours.peak);
        }
        ratios.sort_by(f64::total_cmp);
        let ratio = ratios[TURNS / 2];
        writeln!(table, "| {count} | {} | {rate:.0} | {ratio:.2} | {peak:.0} |", 2 * count)?;
    }
    show_section(RESULTS, "multiplied", &(table + "\n" + &kills()?))
}

/// One run of the command.
fn augment(runner: &mut Runner, program: &Path, folder: &Path) -> Result<Outcome> {
    let (set, waters, more) = (folder.join("set"), folder.join("waters"), folder.join("more"));
    clear(&more)?;
    let options = ["--per-image", TIMES, "--quiet", "--preview", "0"].map(Path::new);
    let paths = [Path::new("augment"), &set, &waters, Path::new("-o"), &more];
    finished(runner.run(program, &[&paths[..], &options].concat())?)
}

/// The same images read and written as often, and nothing else.
fn plain(runner: &mut Runner, folder: &Path) -> Result<Outcome> {
    let (images, again) = (folder.join("set/images"), folder.join("again"));
    clear(&again)?;
    let lab = crate::programs::lab()?;
    finished(runner.run(&lab, &["recode".as_ref(), &images, &again, TIMES.as_ref()])?)
}

fn clear(folder: &PathBuf) -> Result<()> {
    if folder.exists() {
        fs::remove_dir_all(folder).context("cannot clear the last output")?;
    }
    Ok(())
}

fn finished(outcome: Outcome) -> Result<Outcome> {
    match outcome.end {
        End::Exit(0) => Ok(outcome),
        end => bail!("it ended with {end:?}: {}", outcome.said),
    }
}

/// The test that kills a run and goes on with it.
fn kills() -> Result<String> {
    say(&format!("Killing an augmentation {KILLS} times"));
    let mut command =
        cargo(&["test", "--package", "aquafuse-cli", "--test", "augment", "killed", "--", "--nocapture"]);
    command.env("AQUAFUSE_KILLS", KILLS);
    let said = output(command)?;
    let name = "augmentations killed: ";
    let line = said.lines().find_map(|line| line.find(name).map(|at| &line[at..]));
    Ok(format!("- {}\n", line.context("the test said nothing of kills")?))
}
