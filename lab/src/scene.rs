//! `lab scene`: splats trained on a truth scene, with the water inside; and the paper's table of view synthesis, on
//! that scene and on real images of a pool.

mod bed;
mod cost;
mod files;
mod quality;
mod training;
mod water;

pub(crate) use files::run as files;
pub(crate) use quality::run as quality;

use std::path::Path;

use anyhow::{Context, Result};
use xtask::shell::{command, output, root, run as call, say};

use crate::pages::{RESULTS, real_images, show_section, write_section};
use crate::programs;

const MODELS: [&str; 3] = ["aquafuse", "physical", "exchange"];
/// Small images and short runs: five of them on either scene take minutes.
const TRAINED: [&str; 8] = ["--longest", "200", "--iterations", "700", "--splats", "24000", "--hold", "8"];

/// Images of the truth scene to look at go into a folder, if one is given.
pub(crate) fn run(images: Option<&Path>) -> Result<()> {
    say("Training on a truth scene, on one thread (some minutes)");
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let [learned, water] = one_thread.install(|| training::tables(images))?;
    for (name, table) in [learned, water] {
        show_section(RESULTS, name, &table)?;
    }
    cost()?;
    fused()
}

/// The paper's table of view synthesis: scenes fused, and trained on as they were.
pub(crate) fn fused() -> Result<()> {
    let (aquafuse, truth_scene) =
        (programs::aquafuse()?, programs::example("aquafuse-scene", "truth_scene")?);
    let work = root().join("target/scenes");
    if work.exists() {
        std::fs::remove_dir_all(&work).with_context(|| format!("cannot empty {}", work.display()))?;
    }
    let path = |name: &str| work.join(name).to_string_lossy().into_owned();
    call(command(truth_scene, &[&path("reef")]))?;
    let compared = |section, scene: &str, water: &str| compared(&aquafuse, section, scene, water, &work);
    compared("scene-fused-truth", &path("reef"), &path("reef.water.png"))?;
    match real_images() {
        Ok(data) => compared(
            "scene-fused-pool",
            &format!("{data}/sequence_subvo_pool"),
            &format!("{data}/scenes/blueish_01.jpg"),
        ),
        Err(error) => {
            println!("skipped: the pool: {error}");
            Ok(())
        }
    }
}

/// What a step of training costs.
pub(crate) fn cost() -> Result<()> {
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    show_section(RESULTS, "scene-cost", &one_thread.install(cost::table))
}

/// Fuses a scene by each model, trains on all, and writes the comparison into a section.
fn compared(aquafuse: &Path, section: &str, scene: &str, water: &str, work: &Path) -> Result<()> {
    let name = Path::new(scene).file_name().unwrap_or_default().to_string_lossy().into_owned();
    let path = |what: &str| work.join(format!("{name}_{what}")).to_string_lossy().into_owned();
    let in_scene = |arguments: &[&str]| call(command(aquafuse, &[&["--quiet", "scene"], arguments].concat()));
    let train = |scene: &str, output: &str, seed: &str| {
        in_scene(&[&["train", scene, "-o", output, "--seed", seed], &TRAINED[..]].concat())
    };
    say(&format!("Fusing {name} by three models, and training on it five times (minutes)"));
    let (original, floor) = (path("original.ply"), path("seed_1.ply"));
    train(scene, &original, "0")?;
    train(scene, &floor, "1")?;
    let mut compare = vec!["scene".to_owned(), "compare".into(), scene.to_owned()];
    compare.extend(MODELS.map(&path));
    for model in MODELS {
        let fused = path(model);
        in_scene(&["fuse", scene, water, "-o", &fused, "--model", model])?;
        train(&fused, &(fused.clone() + ".ply"), "0")?;
        compare.extend(["--fused".into(), fused + ".ply"]);
    }
    compare.extend(["--original".into(), original, "--floor".into(), floor]);
    compare.extend(["--longest", "200", "--hold", "8", "-o"].map(str::to_owned));
    compare.push(path("compared"));
    let compare: Vec<&str> = compare.iter().map(String::as_str).collect();
    let text = output(command(aquafuse, &compare))?;
    println!("{text}");
    // The paper's own figures follow once for all, and the name of the report last.
    let ours = text.split("published, other machine").next().unwrap_or_default();
    write_section(RESULTS, section, ours)
}
