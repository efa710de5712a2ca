//! What the command takes beside its work: memory, time to start, time for files.

use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::time::Instant;

use anyhow::{Context, Result};
use aquafuse::truth::{Scene, Size as SceneSize, waters};
use aquafuse_data::image_file::{ImageFile, WriteOptions};
use xtask::shell::{command, output, say, target};

use super::turns::{TURNS, Turns};
use super::{FULL_HD, Size};
use crate::pages::show_section;

/// Images in the folder; enough for a rate.
const PICTURES: usize = 24;

pub(super) fn write(page: &str) -> Result<()> {
    say("Start, a folder of JPEGs, memory");
    let folder = target().join("bench/footprint");
    if folder.exists() {
        fs::remove_dir_all(&folder).with_context(|| format!("cannot empty {}", folder.display()))?;
    }
    fs::create_dir_all(&folder).with_context(|| format!("cannot make {}", folder.display()))?;
    let mut table = String::from("| what | measured |\n|---|---|\n");
    let memory = memory(&folder)?;
    writeln!(
        table,
        "| peak memory of a 1920 x 1080 frame in place, above the image itself | {memory} MiB |"
    )?;
    writeln!(
        table,
        "| start to finished output, 256 x 256 PNG, the whole process | {:.1} ms |",
        start(&folder)?
    )?;
    let (share, rate) = photos(&folder)?;
    writeln!(
        table,
        "| `fuse` of a folder of 1920 x 1080 JPEGs, one thread, against decoding and encoding them alone | {share:.2} of the \
         speed, {rate:.1} images/s |"
    )?;
    show_section(page, "footprint", &table)
}

fn memory(folder: &Path) -> Result<String> {
    let image = made(folder, "frame.png", FULL_HD)?;
    Ok(lab(&["frame-memory", &image])?.trim().to_owned())
}

/// The median of some runs, each into a file that is not there yet.
fn start(folder: &Path) -> Result<f64> {
    let content = made(folder, "content.png", (256, 256))?;
    aquafuse(&["water", "extract", &content, "-o", &water(folder)])?;
    let mut turns = Turns::default();
    for turn in 0..4 * TURNS {
        let out = text(&folder.join(format!("{turn}.png")));
        let began = Instant::now();
        aquafuse(&["fuse", &content, &water(folder), "-o", &out])?;
        turns.add("start", began.elapsed().as_secs_f64() * 1e3);
    }
    Ok(turns.median("start"))
}

/// The share of the speed of decoding and encoding alone, and images a second.
fn photos(folder: &Path) -> Result<(f64, f64)> {
    let photos = folder.join("photos");
    fs::create_dir_all(&photos).with_context(|| format!("cannot make {}", photos.display()))?;
    let photo = made(folder, "photo.jpg", FULL_HD)?;
    for i in 0..PICTURES {
        fs::hard_link(&photo, photos.join(format!("{i:02}.jpg"))).context("cannot link an image")?;
    }
    let (mut ours, mut alone) = (Turns::default(), Turns::default());
    for _ in 0..TURNS {
        for (turns, fuse) in [(&mut ours, true), (&mut alone, false)] {
            let out = folder.join("out");
            let began = Instant::now();
            if fuse {
                aquafuse(&[
                    "fuse",
                    &text(&photos),
                    &water(folder),
                    "-o",
                    &text(&out),
                    "--threads",
                    "1",
                    "--quiet",
                ])?;
            } else {
                lab(&["copy", &text(&photos), &text(&out)])?;
            }
            turns.add("folder", began.elapsed().as_secs_f64() * 1e3);
            fs::remove_dir_all(&out)?;
        }
    }
    Ok((alone.times("folder", (&ours, "folder")), PICTURES as f64 * 1e3 / ours.median("folder")))
}

/// An image of a synthetic place.
fn made(folder: &Path, name: &str, (width, height): Size) -> Result<String> {
    let path = folder.join(name);
    let seen = Scene::new(1, SceneSize { width, height }).seen_through(&waters()[0].water);
    ImageFile::new(seen.convert::<u8>()).write(&path, &WriteOptions::default())?;
    Ok(text(&path))
}

fn water(folder: &Path) -> String {
    text(&folder.join("a.water.json"))
}

fn lab(arguments: &[&str]) -> Result<String> {
    output(command(crate::programs::lab()?, arguments))
}

fn aquafuse(arguments: &[&str]) -> Result<String> {
    output(command(target().join("release/aquafuse"), arguments))
}

fn text(path: &Path) -> String {
    path.to_string_lossy().into_owned()
}
