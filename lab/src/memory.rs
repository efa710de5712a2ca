//! `lab memory`: how much memory a run over many large images really holds, and commands on scenes and long records.

mod photos;
mod runs;

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

use crate::pages::{RESULTS, show_section};
use crate::runner::{End, Limits, Outcome, Runner};
use xtask::shell::{root, say};

pub(crate) const IMAGES: usize = 1000;
/// Different ones; the rest are further names of these.
const DIFFERENT: usize = 4;
const BUDGET: &str = "1GiB";
const LIMITS: Limits = Limits { seconds: 7200, address_space: 16 << 20 };

pub(crate) fn run(images: usize) -> Result<()> {
    let program = crate::programs::aquafuse()?;
    let folder = root().join("target/memory");
    let photos = photos(&folder, images)?;
    let mut runner = Runner::new(LIMITS)?;
    let mut table = String::from(
        "| images of 24 megapixels | threads | budget | peak memory, MiB | seconds an image |\n|---|---|---|---|---|\n",
    );
    for threads in ["1", "2"] {
        say(&format!("Fusing {images} of them on {threads} threads"));
        let fused = folder.join("fused");
        let water = folder.join("0.jpg");
        let options = ["--max-memory", BUDGET, "--threads", threads, "--quiet"].map(Path::new);
        let paths = [Path::new("fuse"), &photos, &water, Path::new("-o"), &fused];
        let arguments = [&paths[..], &options].concat();
        let Outcome { end, milliseconds, peak, said } = runner.run(&program, &arguments)?;
        if end != End::Exit(0) {
            bail!("it ended with {end:?}: {said}");
        }
        fs::remove_dir_all(&fused)?;
        let each = milliseconds / 1000.0 / images as f64;
        writeln!(table, "| {images} | {threads} | {BUDGET} | {peak:.0} | {each:.2} |")?;
    }
    show_section(RESULTS, "memory", &table)?;
    show_section(RESULTS, "memory-runs", &runs::table(&program, &folder)?)
}

/// The second table alone: scenes, and the files of long runs.
pub(crate) fn runs() -> Result<()> {
    let program = crate::programs::aquafuse()?;
    let folder = root().join("target/memory");
    fs::create_dir_all(&folder)?;
    show_section(RESULTS, "memory-runs", &runs::table(&program, &folder)?)
}

/// A folder of so many images.
fn photos(folder: &Path, count: usize) -> Result<PathBuf> {
    say(&format!("Making {DIFFERENT} images of 24 megapixels"));
    fs::create_dir_all(folder)?;
    for seed in 0..DIFFERENT {
        photos::write(&folder.join(format!("{seed}.jpg")), seed as u32, photos::LARGE)?;
    }
    let photos = folder.join("photos");
    if photos.exists() {
        fs::remove_dir_all(&photos)?;
    }
    fs::create_dir_all(&photos)?;
    for i in 0..count {
        let made = folder.join(format!("{}.jpg", i % DIFFERENT));
        fs::hard_link(&made, photos.join(format!("{i:04}.jpg"))).context("cannot link an image")?;
    }
    Ok(photos)
}
