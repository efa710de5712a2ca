//! `cargo xtask scene`: splats trained on a truth scene, with the water inside; and the paper's table of view synthesis, on
//! that scene and on real images of a pool.

use std::path::Path;

use anyhow::{Context, Result};

use crate::results::{RESULTS, real_images, sections, write_section};
use crate::shell::{cargo, output, root, run, say};

const RUN: [&str; 6] = ["run", "--release", "--quiet", "--package", "aquafuse-cli", "--"];
const MODELS: [&str; 3] = ["aquafuse", "physical", "exchange"];
/// Small images and short runs: five of them on either scene take minutes.
const TRAINED: [&str; 8] = ["--longest", "200", "--iterations", "700", "--splats", "24000", "--hold", "8"];

pub(crate) fn run_all() -> Result<()> {
    say("Training on a truth scene (some minutes)");
    let example = ["run", "--release", "--quiet", "--package", "aquafuse-scene", "--example", "scene_table"];
    let text = output(cargo(&example))?;
    println!("{text}");
    for (name, table) in sections(&text)? {
        write_section(RESULTS, name, table)?;
    }

    let work = root().join("target/scenes");
    if work.exists() {
        std::fs::remove_dir_all(&work).with_context(|| format!("cannot empty {}", work.display()))?;
    }
    let path = |name: &str| work.join(name).to_string_lossy().into_owned();
    let example =
        ["run", "--release", "--quiet", "--package", "aquafuse-scene", "--example", "truth_scene", "--"];
    run(cargo(&[&example[..], &[&path("reef")]].concat()))?;
    compared("scene-fused-truth", &path("reef"), &path("reef.water.png"), &work)?;
    match real_images() {
        Ok(data) => compared(
            "scene-fused-pool",
            &format!("{data}/sequence_subvo_pool"),
            &format!("{data}/scenes/blueish_01.jpg"),
            &work,
        ),
        Err(error) => {
            println!("skipped: the pool: {error}");
            Ok(())
        }
    }
}

/// Fuses a scene by each model, trains on all, and writes the comparison into a section.
fn compared(section: &str, scene: &str, water: &str, work: &Path) -> Result<()> {
    let name = Path::new(scene).file_name().unwrap_or_default().to_string_lossy().into_owned();
    let path = |what: &str| work.join(format!("{name}_{what}")).to_string_lossy().into_owned();
    let aquafuse = |arguments: &[&str]| run(cargo(&[&RUN[..], &["--quiet", "scene"], arguments].concat()));
    let train = |scene: &str, output: &str, seed: &str| {
        aquafuse(&[&["train", scene, "-o", output, "--seed", seed], &TRAINED[..]].concat())
    };
    say(&format!("Fusing {name} by three models, and training on it five times (minutes)"));
    let (original, floor) = (path("original.ply"), path("seed_1.ply"));
    train(scene, &original, "0")?;
    train(scene, &floor, "1")?;
    let mut compare = vec!["scene".to_owned(), "compare".into(), scene.to_owned()];
    compare.extend(MODELS.map(&path));
    for model in MODELS {
        let fused = path(model);
        aquafuse(&["fuse", scene, water, "-o", &fused, "--model", model])?;
        train(&fused, &(fused.clone() + ".ply"), "0")?;
        compare.extend(["--fused".into(), fused + ".ply"]);
    }
    compare.extend(["--original".into(), original, "--floor".into(), floor]);
    compare.extend(["--longest", "200", "--hold", "8", "-o"].map(str::to_owned));
    compare.push(path("compared"));
    let compare: Vec<&str> = compare.iter().map(String::as_str).collect();
    let text = output(cargo(&[&RUN[..], &compare].concat()))?;
    println!("{text}");
    // The paper's own figures follow once for all, and the name of the report last.
    let ours = text.split("published, other machine").next().unwrap_or_default();
    write_section(RESULTS, section, ours)
}
