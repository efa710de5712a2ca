//! Scenes in 3D, from a folder of images with cameras to views of them.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

mod run;

use std::ffi::OsString;

use aquafuse::metrics::psnr;
use aquafuse_data::image_file::ImageFile;
use aquafuse_data::pipeline::PixelEncoding;
use aquafuse_data::water_file::WaterFile;
use run::{Run, reef, scene};
use serde_json::Value;

/// Trains a scene, every eighth image held out.
fn train(run: &Run, scene: &str, output: &str, more: &[&str]) -> String {
    let all = [&["scene", "train", scene, "-o", output, "--iterations", "120", "--hold", "8"], more].concat();
    run.ok(&all).stdout
}

/// A scene in blue water, and `reef.ply` trained on it with its water.
fn trained() -> Run {
    let run = Run::new();
    reef(&run);
    train(&run, "reef", "reef.ply", &["--water", "learn"]);
    run
}

/// Renders `reef.ply` at 64 pixels into a folder.
fn render(run: &Run, output: &str, more: &[&str]) {
    let all = ["scene", "render", "reef.ply", "reef", "-o", output, "--longest", "64"];
    run.ok(&[&all[..], more].concat());
}

/// PSNR between two images, dB.
fn score(run: &Run, a: &str, b: &str) -> f64 {
    let [a, b] = [a, b].map(|name| ImageFile::read(&run.path(name)).unwrap());
    psnr(&*a.bytes(), &*b.bytes()).unwrap()
}

#[test]
fn training_learns_the_water_and_scores_images_it_was_not_shown() {
    let run = Run::new();
    reef(&run);
    let said = train(&run, "reef", "reef.ply", &["--water", "learn"]);
    assert!(
        said.contains("splats") && said.contains("B∞") && said.contains("2 images held out: PSNR"),
        "{said}"
    );
    let water = WaterFile::read(&run.path("reef.water.json"), PixelEncoding::Encoded).unwrap();
    assert!(water.estimate.veiling_light_as_seen()[2] > 0.3);
    assert!(!run.path("reef.ply.checkpoint").exists());
}

#[test]
fn a_scene_trained_again_without_water_loses_the_old_water() {
    let run = trained();
    run.fails(2, &["scene", "train", "reef", "-o", "reef.ply"]);
    assert!(run.path("reef.water.json").exists());
    train(&run, "reef", "reef.ply", &["--overwrite"]);
    assert!(!run.path("reef.water.json").exists(), "it would be taken for the water of the new splats");
}

#[test]
fn a_trained_scene_is_rendered_through_its_water_through_none_and_through_another() {
    let run = trained();
    render(&run, "wet", &[]);
    render(&run, "dry", &["--water", "none", "--depth"]);
    render(&run, "coast", &["--water", "preset:jerlov-3C"]);
    assert!(score(&run, "wet/view_003.png", "reef/images/view_003.png") > 22.0);
    assert!(score(&run, "wet/view_003.png", "dry/view_003.png") < 20.0);
    assert!(run.path("dry/view_003.depth.tiff").is_file() && run.path("coast/view_008.png").is_file());
}

#[test]
fn a_rendering_that_takes_more_memory_than_is_allowed_is_refused() {
    let run = trained();
    let tight =
        ["scene", "render", "reef.ply", "reef", "-o", "no", "--longest", "4096", "--max-memory", "64MiB"];
    let said = run.fails(1, &tight).stderr;
    assert!(said.contains("bytes to render, more than the 67108864 of --max-memory"), "{said}");
}

#[test]
fn an_orbit_is_a_row_of_frames_that_differ() {
    let run = trained();
    render(&run, "orbit", &["--orbit", "5"]);
    let mut names: Vec<_> =
        std::fs::read_dir(run.path("orbit")).unwrap().map(|one| one.unwrap().file_name()).collect();
    names.sort();
    // The record comes first, the cameras last.
    let mut expected = [0, 1, 2, 3, 4].map(|i| OsString::from(format!("orbit_00{i}.png"))).to_vec();
    expected.push("transforms.json".into());
    assert_eq!(names[1..], expected);
    assert!(score(&run, "orbit/orbit_001.png", "orbit/orbit_003.png") < 30.0);
}

#[test]
fn a_rendering_that_was_stopped_goes_on() {
    let run = trained();
    let all = ["scene", "render", "reef.ply", "reef", "-o", "views", "--longest", "64", "--depth"];
    run.ok(&all);
    let whole = run.bytes("views/view_003.png");
    std::fs::remove_file(run.path("views/view_003.png")).unwrap();
    let record = std::fs::read_to_string(run.path("views/aquafuse-job.jsonl")).unwrap();
    let last = record.trim_end().rfind('\n').unwrap();
    std::fs::write(run.path("views/aquafuse-job.jsonl"), &record[..=last]).unwrap();
    std::fs::remove_file(run.path("views/view_003.depth.tiff")).unwrap();
    let said = run.ok(&all).stdout;
    assert!(said.contains("; 7 were rendered by an earlier run"), "{said}");
    assert_eq!(run.bytes("views/view_003.png"), whole);
    let other = run.fails(2, &[&all[..], &["--water", "none"]].concat());
    assert!(other.stderr.contains("made with other settings"), "{}", other.stderr);
    std::fs::write(run.path("views/view_004.png"), "mine").unwrap();
    run.fails(2, &all);
    assert_eq!(run.bytes("views/view_004.png"), b"mine");
}

#[test]
fn of_several_models_the_one_with_the_most_images_is_used_and_said() {
    let run = Run::new();
    reef(&run);
    // What a mapper could not join: four of the nine images.
    std::fs::create_dir(run.path("reef/sparse/1")).unwrap();
    for name in ["cameras.txt", "points3D.txt", "images.txt"] {
        std::fs::copy(run.path("reef/sparse/0").join(name), run.path("reef/sparse/1").join(name)).unwrap();
    }
    let images = std::fs::read_to_string(run.path("reef/sparse/0/images.txt")).unwrap();
    let lines: Vec<&str> = images.lines().filter(|line| !line.starts_with('#')).take(8).collect();
    std::fs::write(run.path("reef/sparse/0/images.txt"), lines.join("\n") + "\n").unwrap();
    let train = ["scene", "train", "reef", "-o", "reef.ply", "--iterations", "1", "--longest", "32"];
    let said = run.ok(&train).stderr;
    assert!(said.contains("reef: sparse/1 is used, with 9 images; 1 other models have no more"), "{said}");
    run.ok(&["scene", "render", "reef.ply", "reef", "-o", "views", "--longest", "32"]);
    assert!(run.path("views/view_008.png").exists());
}

#[test]
fn images_that_are_missing_are_counted_and_left_out_on_request() {
    let run = Run::new();
    reef(&run);
    scene(&run.path("green.png"), 3, "green");
    std::fs::remove_file(run.path("reef/images/view_003.png")).unwrap();
    let fuse = ["scene", "fuse", "reef", "green.png", "-o", "fused"];
    let said = run.fails(2, &fuse).stderr;
    assert!(said.contains("lacks 1 of the 9 images of the scene, first view_003.png"), "{said}");
    let said = run.ok(&[&fuse[..], &["--skip-missing"]].concat()).stdout;
    assert!(said.contains("8 images in green.png's water (images left out, because missing: 1)"), "{said}");
}

#[test]
fn a_fused_scene_has_the_cameras_of_the_original() {
    let run = Run::new();
    reef(&run);
    scene(&run.path("green.png"), 3, "green");
    let said = run.ok(&["scene", "fuse", "reef", "green.png", "-o", "fused", "--model", "physical"]).stdout;
    assert!(said.contains("9 images") && said.contains("units of the scene"), "{said}");
    for name in ["sparse/0/cameras.txt", "sparse/0/images.txt", "sparse/0/points3D.txt"] {
        assert_eq!(run.bytes(&format!("fused/{name}")), run.bytes(&format!("reef/{name}")));
    }
}

#[test]
fn a_fused_scene_is_trained_and_compared_with_the_original() {
    let run = Run::new();
    reef(&run);
    scene(&run.path("green.png"), 3, "green");
    run.ok(&["scene", "fuse", "reef", "green.png", "-o", "fused", "--model", "physical"]);
    train(&run, "reef", "original.ply", &[]);
    train(&run, "reef", "again.ply", &["--seed", "1"]);
    train(&run, "fused", "fused.ply", &[]);
    let scenes = ["scene", "compare", "reef", "fused"];
    let models = ["--original", "original.ply", "--fused", "fused.ply", "--floor", "again.ply"];
    let compare = [&scenes[..], &models].concat();
    let text = run.ok(&compare).stdout;
    let rows = ["| reef | original |", "| reef | original, another seed |", "| reef | fused: fused |"];
    assert!(rows.iter().all(|row| text.contains(row)) && text.contains("Table 2 of the paper"), "{text}");

    run.ok(&[&compare[..], &["-o", "report"]].concat());
    let page = String::from_utf8(run.bytes("report/report.html")).unwrap();
    assert!(page.contains("from above") && page.contains("<img src=\"data:image/jpeg;base64,"));
    assert!(!page.contains("http"), "a page needs nothing else");
    let report: Value = serde_json::from_slice(&run.bytes("report/report.json")).unwrap();
    let rows = &report["tables"][0]["rows"];
    let [floor, deviation] =
        [1, 2].map(|row: usize| rows[row]["normal_deviation_percent"]["mean"].as_f64().unwrap());
    assert!(deviation < 50.0 && floor > 0.0 && floor < 50.0, "{report}");
    assert_eq!(rows[0]["normal_deviation_percent"], Value::Null);
    // Three rows of two views.
    assert_eq!(String::from_utf8(run.bytes("report/items.csv")).unwrap().lines().count(), 1 + 3 * 2);

    let twice = [&scenes[..], &["fused"], &models].concat();
    assert!(run.fails(2, &twice).stderr.contains("--fused is given 1 times"));
}

#[test]
fn a_trained_scene_is_exported_for_other_programs() {
    let run = trained();
    run.ok(&["scene", "export", "reef.ply", "-o", "reef.splat"]);
    assert_eq!(run.bytes("reef.splat").len() % 32, 0);
    run.ok(&["scene", "export", "reef.ply", "-o", "copy.ply"]);
    assert_eq!(run.bytes("copy.ply"), run.bytes("reef.ply"));
    let said = run.ok(&["scene", "export", "reef.ply", "-o", "cloud.ply", "--points"]).stdout;
    assert!(said.ends_with(" points\n"), "{said}");
    assert!(run.bytes("cloud.ply").starts_with(b"ply\n"));
    run.fails(2, &["scene", "export", "reef.ply", "-o", "cloud.splat", "--points"]);
    match std::env::var_os("AQUAFUSE_PYTHON") {
        Some(python) => {
            read_by_others(&python, &run.path("reef.ply"), "x y z nx ny nz f_dc_0 f_dc_1 f_dc_2 ");
            read_by_others(&python, &run.path("cloud.ply"), "x y z red green blue");
        }
        None => println!("AQUAFUSE_PYTHON names no Python with plyfile: no other reader was tried"),
    }
}

/// Has a PLY read by a program that is not ours.
fn read_by_others(python: &std::ffi::OsStr, path: &std::path::Path, begins: &str) {
    const READ: &str = "import sys, plyfile; points = plyfile.PlyData.read(sys.argv[1])['vertex']; \
                        print(points.count, *(part.name for part in points.properties))";
    let output = std::process::Command::new(python).args(["-c", READ]).arg(path).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let said = String::from_utf8_lossy(&output.stdout);
    let (count, names) = said.split_once(' ').unwrap();
    assert!(count.parse::<usize>().unwrap() > 100 && names.starts_with(begins), "{said}");
}

#[test]
fn what_cannot_be_done_is_refused_before_work_begins() {
    let run = Run::new();
    reef(&run);
    let said = |code, arguments: &[&str]| run.fails(code, arguments).stderr;
    assert!(said(2, &["scene", "train", "reef", "-o", "reef.splat"]).contains("must end in .ply"));
    assert!(said(2, &["scene", "train", "reef/images", "-o", "a.ply"]).contains("holds no cameras"));
    std::fs::write(run.path("a.ply"), "mine").unwrap();
    assert!(said(2, &["scene", "train", "reef", "-o", "a.ply"]).contains("was not changed"));
    assert!(said(1, &["scene", "export", "a.ply", "-o", "a.splat"]).contains("it is no PLY file"));
    std::fs::write(run.path("reef/images/view_002.png"), "").unwrap();
    assert!(said(1, &["scene", "train", "reef", "-o", "b.ply"]).contains("view_002.png: the file is empty"));
    let model = run.path("reef/sparse/0/images.txt");
    let text = std::fs::read_to_string(&model).unwrap().replace("view_001.png", "../../secret.png");
    std::fs::write(&model, text).unwrap();
    let said = said(1, &["scene", "train", "reef", "-o", "b.ply"]);
    assert!(said.contains("images.txt, line 3: ") && said.contains("leads out of its folder"), "{said}");
    assert!(!run.path("b.ply").exists());
}
