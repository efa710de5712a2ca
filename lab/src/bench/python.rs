//! The Python package beside its library and other augmentations, in one run.

use std::fmt::Write;
use std::path::Path;
use std::time::Instant;

use anyhow::{Context, Result};
use aquafuse::fusion::Options;
use aquafuse::image::Image;
use aquafuse::scene_area::Border;
use aquafuse::truth::{Scene, Size as SceneSize, waters};
use aquafuse::waterbody::WaterMap;
use aquafuse_data::image_file::{ImageFile, Pixels};
use aquafuse_data::pipeline::{DepthSource, Operation, PixelEncoding, analyse_in};
use xtask::setup::{python_environment, set_up};
use xtask::shell::{command, output, run as call, say, target};

use super::turns::{TURNS, Turns};
use super::{PAGE, Size, frames_of};
use crate::pages::show_section;
use crate::synthetic::images;

const SIZES: [Size; 3] = [(256, 256), (640, 640), super::FULL_HD];

/// Builds the release wheel, measures, and writes the section `python`.
pub(super) fn write() -> Result<()> {
    let tools = set_up()?;
    let environment = python_environment("python-rivals", "benches/requirements.txt")?;
    let python = environment.join("bin/python");
    install(&tools.python, &python)?;
    let mut table = String::from(
        "| size | library, ms | `Fuser.fuse`, ms | binding, % | `WaterFusion`, ms | ColorJitter, ms | times as fast | RandomFog, ms | \
         times as fast | two Python threads, times as fast |\n|---|---|---|---|---|---|---|---|---|---|\n",
    );
    for size @ (width, height) in SIZES {
        say(&format!("{width} x {height} in Python"));
        let (folder, frames) = (images(size)?, frames_of(size));
        let mut turns = Turns::default();
        for _ in 0..TURNS {
            turns.add("library", library(size, frames.parse()?)?);
            let [content, reference] =
                ["blue.ppm", "green.ppm"].map(|name| folder.join(name).to_string_lossy().into_owned());
            let script = ["benches/python_wheel.py", &content, &reference, "--frames", &frames];
            turns.read(&output(command(&python, &script))?);
        }
        let [library, fuse, transform, jitter, fog, two] =
            ["library", "fuse", "transform", "color-jitter", "random-fog", "two-threads"]
                .map(|case| turns.median(case));
        let binding = 100.0 * (turns.times("fuse", (&turns, "library")) - 1.0);
        let [than_jitter, than_fog] =
            ["color-jitter", "random-fog"].map(|rival| turns.times(rival, (&turns, "transform")));
        writeln!(
            table,
            "| {width} x {height} | {library:.2} | {fuse:.2} | {binding:.0} | {transform:.2} | {jitter:.2} | {than_jitter:.1} | \
             {fog:.0} | {than_fog:.0} | {two:.2} |"
        )?;
    }
    show_section(PAGE, "python", &table)
}

/// Builds the wheel as it is released, and installs it beside what else is measured.
pub(crate) fn install(tools: &Path, python: &Path) -> Result<()> {
    let folder = target().join("wheels-release");
    let _ = std::fs::remove_dir_all(&folder);
    let place = folder.to_string_lossy();
    let maturin = ["build", "--release", "--quiet", "--manifest-path", "python/Cargo.toml", "--out", &place];
    call(command(tools.with_file_name("maturin"), &maturin))?;
    let wheel = folder.read_dir()?.flatten().next().context("maturin wrote no wheel")?.path();
    let pip = ["-m", "pip", "install", "--quiet", "--no-index", "--no-deps", "--force-reinstall"];
    call(command(python, &[&pip[..], &[&wheel.to_string_lossy()]].concat()))
}

/// The median of one turn of the library alone: what `Fuser.fuse` calls, with its copy of the image, on one thread.
fn library((width, height): Size, frames: usize) -> Result<f64> {
    let scene = Scene::new(1, SceneSize { width, height });
    let named = |name: &str| {
        let water =
            waters().into_iter().find(|named| named.name == name).context("there is no such water")?;
        Ok::<Image<u8>, anyhow::Error>(scene.seen_through(&water.water).convert())
    };
    let (content, reference) = (named("blue")?, ImageFile::new(named("green")?).cut_to_scene(Border::Auto)?);
    let (encoding, source) = (PixelEncoding::Encoded, DepthSource::default());
    let reference = analyse_in(encoding, &reference, &source)?.estimate;
    let operation = Operation::Fuse { reference, options: Options::default() };
    let frame = || -> Result<Pixels> {
        // `Fuser` finds open water this way unless it is asked for another.
        let whole = ImageFile::new(content.clone()).with_water_map(WaterMap::BEST);
        let mut image = whole.cut_to_scene(Border::Auto)?;
        let found = analyse_in(encoding, &image, &source)?;
        operation.apply(&mut image.pixels, Some(&found))?;
        Ok(image.joined().pixels)
    };
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    alone.install(|| {
        frame()?;
        let mut spent = Vec::with_capacity(frames);
        for _ in 0..frames {
            let began = Instant::now();
            frame()?;
            spent.push(1e3 * began.elapsed().as_secs_f64());
        }
        spent.sort_by(f64::total_cmp);
        Ok(spent[frames / 2])
    })
}
