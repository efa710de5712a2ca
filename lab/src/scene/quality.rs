//! `lab scene-quality`: what each measure of training is worth on views that were held out, on scenes of known truth and
//! on the frames of a pool.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use anyhow::Result;
use aquafuse_scene::train::Options;
use xtask::setup::python_environment;
use xtask::shell::{command, root, run as call, say};

use super::bed::{Bed, Outcome};
use super::training::SIZE;
use super::water;
use crate::pages::{RESULTS, real_images, show_section};
use crate::programs;

/// A change of the options, by its name.
type Measure = (&'static str, fn(&mut Options));

/// What training does unless it is changed, each measure changed alone, and steps.
const MEASURES: [Measure; 5] = [
    ("as it is", |_| ()),
    ("rates do not fall at the end", |options| options.rates.last = 1.0),
    ("λ of SSIM .4", |options| options.lambda = 0.4),
    ("half the steps", |options| options.iterations /= 2),
    ("twice the steps", |options| options.iterations *= 2),
];

/// Views of the synthetic scene; steps and splats on it.
const VIEWS: [usize; 2] = [28, 100];
const STEPS: u32 = 1200;
const SPLATS: usize = 24_000;
/// Pixels on the longer side of the pool's frames; steps and splats there.
const LONGEST: usize = 400;
const POOL_STEPS: u32 = 700;
const POOL_SPLATS: usize = 30_000;

/// All scenes, or those of one name: `truth`, `water` or `pool`.
pub(crate) fn run(only: Option<&str>) -> Result<()> {
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    one_thread.install(|| {
        let is_asked_for = |name: &str| only.is_none_or(|only| only == name);
        if is_asked_for("truth") {
            show_section(RESULTS, "scene-quality-truth", &truth()?)?;
        }
        if is_asked_for("water") {
            show_section(RESULTS, "scene-quality-water", &water::table()?)?;
        }
        if is_asked_for("pool") {
            match real_images() {
                Ok(data) => show_section(RESULTS, "scene-quality-pool", &pool(Path::new(&data))?)?,
                Err(error) => println!("skipped: the pool: {error}"),
            }
        }
        Ok(())
    })
}

const HEAD: &str = "| scene | measure | points | splats | CPU seconds | held out: PSNR, dB | SSIM | trained on: PSNR, dB | \
                    held out, drawn twice as large: PSNR, dB |\n|---|---|---|---|---|---|---|---|---|\n";

fn truth() -> Result<String> {
    let mut table = HEAD.to_owned();
    for views in VIEWS {
        say(&format!("Training on {views} synthetic views by {} measures (minutes)", MEASURES.len()));
        let bed = Bed::of_truth(views, SIZE);
        let options = Options { iterations: STEPS, max_splats: SPLATS, ..Options::default() };
        rows(&mut table, &format!("synthetic, {views} views"), &bed, &options, &MEASURES)?;
    }
    Ok(table)
}

/// The pool by the cameras it comes with, and by cameras of our own. What the first loses on the views it was trained on is
/// the fault of its cameras; what views held out lose beside those is overfitting.
fn pool(data: &Path) -> Result<String> {
    let given = data.join("sequence_subvo_pool");
    let found = found_cameras(&given.join("images"))?;
    let mut table = HEAD.to_owned();
    let options = Options { iterations: POOL_STEPS, max_splats: POOL_SPLATS, ..Options::default() };
    say("Training on the pool by the cameras it comes with (minutes)");
    rows(&mut table, "pool, given cameras", &Bed::of_folder(&given, LONGEST)?, &options, &MEASURES[..1])?;
    say("Training on the pool by cameras of our own (minutes)");
    let bed = Bed::of_folder(&found, LONGEST)?;
    rows(&mut table, "pool, cameras by `scene sfm`", &bed, &options, &MEASURES)?;
    Ok(table)
}

/// A scene of these frames by `aquafuse scene sfm`, made once.
fn found_cameras(images: &Path) -> Result<PathBuf> {
    let scene = root().join("target/pool-sfm");
    if !scene.join("sparse").exists() {
        let python = python_environment("python-cameras", "lab/scene_cameras/requirements.txt")?;
        let aquafuse = programs::aquafuse()?;
        say("Finding the cameras of the pool's frames by pycolmap (minutes)");
        let words = [
            "scene".to_owned(),
            "sfm".into(),
            images.to_string_lossy().into_owned(),
            "-o".into(),
            scene.to_string_lossy().into_owned(),
            "--python".into(),
            python.join("bin/python").to_string_lossy().into_owned(),
        ];
        call(command(aquafuse, &words.each_ref().map(String::as_str)))?;
    }
    Ok(scene)
}

fn rows(table: &mut String, scene: &str, bed: &Bed, like: &Options, measures: &[Measure]) -> Result<()> {
    for (name, change) in measures {
        let mut options = like.clone();
        change(&mut options);
        let Outcome { begun_with, splats, seconds, held_out, training, finer } = bed.run(&options)?;
        let finer = finer.map_or(String::new(), |[near, _]| format!("{near:.2}"));
        let row = format!(
            "| {scene} | {name}, {} steps | {begun_with} | {splats} | {seconds:.1} | {:.2} | {:.3} | {:.2} | {finer} |",
            options.iterations, held_out[0], held_out[1], training[0]
        );
        println!("{row}");
        writeln!(table, "{row}")?;
    }
    Ok(())
}
