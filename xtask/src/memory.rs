//! `cargo xtask memory`: how much memory a run over many large images really holds.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

use crate::results::{RESULTS, write_section};
use crate::runner::{End, Limits, Outcome, Runner};
use crate::shell::{cargo, root, run, say, target};

pub(crate) const PICTURES: usize = 1000;
/// Different ones; the rest are further names of these.
const DIFFERENT: usize = 4;
const BUDGET: &str = "1GiB";
const LIMITS: Limits = Limits { seconds: 7200, address_space: 16 << 20 };

pub(crate) fn run_with(images: usize) -> Result<()> {
    say("Building the command and large images");
    run(cargo(&["build", "--release", "--quiet", "--package", "aquafuse-cli"]))?;
    let folder = root().join("target/memory");
    let photos = photos(&folder, images)?;
    let program = target().join("release/aquafuse");
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
    println!("{table}");
    write_section(RESULTS, "memory", &table)
}

/// A folder of so many images.
fn photos(folder: &Path, count: usize) -> Result<PathBuf> {
    let example =
        ["run", "--release", "--quiet", "--package", "aquafuse-data", "--example", "large_images", "--"];
    run(cargo(&[&example[..], &[&folder.to_string_lossy(), &DIFFERENT.to_string()]].concat()))?;
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
