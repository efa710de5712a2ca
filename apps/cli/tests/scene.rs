//! Scenes in 3D, from a folder of pictures with cameras to views of them.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

mod run;

use std::fmt::Write;

use aquafuse::metrics::psnr;
use aquafuse::truth::{Size, waters};
use aquafuse_data::picture::{Picture, WriteOptions};
use aquafuse_data::water_file::WaterFile;
use aquafuse_scene::truth::{points, views};
use run::{Run, scene};
use serde_json::Value;

const VIEWS: usize = 9;

/// A truth scene in blue water as a folder of COLMAP: `reef/images` and `reef/sparse/0`.
fn reef(run: &Run) {
    let (views, blue) = (views(1, Size { width: 64, height: 48 }, VIEWS, 1), waters()[0].water);
    let pictures: Vec<_> = views.iter().map(|view| view.seen_through(&blue)).collect();
    let [images, model] = ["reef/images", "reef/sparse/0"].map(|name| run.path(name));
    std::fs::create_dir_all(&images).unwrap();
    std::fs::create_dir_all(&model).unwrap();
    let camera = &views[0].camera;
    let cameras =
        format!("1 SIMPLE_PINHOLE 64 48 {} {} {}\n", camera.focal[0], camera.centre[0], camera.centre[1]);
    let (mut poses, mut things) = (String::new(), String::new());
    for (i, (view, picture)) in views.iter().zip(&pictures).enumerate() {
        let name = format!("view_{i}.5.png");
        Picture::new(picture.to_samples::<u8>())
            .write(&images.join(&name), &WriteOptions::default())
            .unwrap();
        let ([a, b, c], [x, y, z]) = (view.camera.rotation, view.camera.translation);
        let w = 0.5 * (1.0 + a[0] + b[1] + c[2]).sqrt();
        let q = [w, (c[1] - b[2]) / (4.0 * w), (a[2] - c[0]) / (4.0 * w), (b[0] - a[1]) / (4.0 * w)];
        writeln!(poses, "{i} {} {} {} {} {x} {y} {z} 1 {name}\n", q[0], q[1], q[2], q[3]).unwrap();
    }
    for (i, point) in points(&views, &pictures, 16).iter().enumerate() {
        let ([x, y, z], [r, g, b]) = (point.position, point.colour.map(|v| (255.0 * v).round() as u8));
        writeln!(things, "{i} {x} {y} {z} {r} {g} {b} 0.5").unwrap();
    }
    for (name, text) in [("cameras.txt", cameras), ("images.txt", poses), ("points3D.txt", things)] {
        std::fs::write(model.join(name), text).unwrap();
    }
}

#[test]
fn a_scene_is_trained_drawn_fused_compared_and_exported() {
    let run = Run::new();
    reef(&run);
    let train = |scene: &str, output: &str, more: &[&str]| {
        let all =
            [&["scene", "train", scene, "-o", output, "--iterations", "120", "--hold", "8"], more].concat();
        run.ok(&all).stdout
    };
    let said = train("reef", "reef.ply", &["--water", "learn"]);
    assert!(
        said.contains("splats") && said.contains("B_inf") && said.contains("2 pictures held back: PSNR"),
        "{said}"
    );
    let water = WaterFile::<aquafuse::image::Encoded>::read(&run.path("reef.water.json")).unwrap();
    assert!(water.estimate.water.veiling_light.rgb()[2] > 0.3);
    assert!(!run.path("reef.ply.checkpoint").exists());

    // Seen again through the water it was trained in, and without.
    run.ok(&["scene", "render", "reef.ply", "reef", "-o", "wet", "--longest", "64"]);
    run.ok(&[
        "scene",
        "render",
        "reef.ply",
        "reef",
        "-o",
        "dry",
        "--longest",
        "64",
        "--water",
        "none",
        "--depth",
    ]);
    run.ok(&[
        "scene",
        "render",
        "reef.ply",
        "reef",
        "-o",
        "coast",
        "--longest",
        "64",
        "--water",
        "preset:jerlov-3C",
    ]);
    let score = |drawn: &str, truth: &str| {
        let [drawn, truth] = [drawn, truth].map(|name| Picture::read(&run.path(name)).unwrap());
        psnr(&*drawn.bytes(), &*truth.bytes()).unwrap()
    };
    assert!(score("wet/view_3.5.png", "reef/images/view_3.5.png") > 22.0);
    assert!(score("wet/view_3.5.png", "dry/view_3.5.png") < 20.0);
    assert!(run.path("dry/view_3.5.depth.tiff").is_file() && run.path("coast/view_8.5.png").is_file());

    // Trained anew without a water, the old one goes: it would be taken for that of the new splats.
    run.fails(2, &["scene", "train", "reef", "-o", "reef.ply"]);
    std::fs::copy(run.path("reef.ply"), run.path("old.ply")).unwrap();
    std::fs::copy(run.path("reef.water.json"), run.path("old.water.json")).unwrap();
    train("reef", "old.ply", &["--overwrite"]);
    assert!(!run.path("old.water.json").exists());

    // Fused, the cameras go along, and it can be trained as the original was.
    scene(&run.path("green.png"), 3, "green");
    let said = run.ok(&["scene", "fuse", "reef", "green.png", "-o", "fused", "--model", "physical"]).stdout;
    assert!(said.contains("9 pictures") && said.contains("units of the scene"), "{said}");
    for name in ["sparse/0/cameras.txt", "sparse/0/images.txt", "sparse/0/points3D.txt"] {
        assert_eq!(run.bytes(&format!("fused/{name}")), run.bytes(&format!("reef/{name}")));
    }
    train("reef", "original.ply", &[]);
    train("reef", "again.ply", &["--seed", "1"]);
    train("fused", "fused.ply", &[]);
    let compare = [
        "scene",
        "compare",
        "reef",
        "fused",
        "--original",
        "original.ply",
        "--fused",
        "fused.ply",
        "--floor",
        "again.ply",
    ];
    let text = run.ok(&compare).stdout;
    assert!(
        text.starts_with("Means over 2 views.") && text.contains("| floor: original, two seeds |"),
        "{text}"
    );
    let report: Value = serde_json::from_str(&run.ok(&[&compare[..], &["--json"]].concat()).stdout).unwrap();
    let [deviation, floor] =
        ["normal_deviation", "floor"].map(|name| report[name]["angle"].as_f64().unwrap());
    assert!(deviation < 0.5 && floor > 0.0 && floor < 0.5, "{report}");

    run.ok(&["scene", "export", "reef.ply", "-o", "reef.splat"]);
    assert_eq!(run.bytes("reef.splat").len() % 32, 0);
    run.ok(&["scene", "export", "reef.ply", "-o", "copy.ply"]);
    assert_eq!(run.bytes("copy.ply"), run.bytes("reef.ply"));
}

#[test]
fn what_cannot_be_done_is_refused_before_work_begins() {
    let run = Run::new();
    reef(&run);
    let said = |code, arguments: &[&str]| run.fails(code, arguments).stderr;
    assert!(said(2, &["scene", "train", "reef", "-o", "reef.splat"]).contains("must end in .ply"));
    assert!(said(2, &["scene", "train", "reef/images", "-o", "a.ply"]).contains("holds no cameras"));
    std::fs::write(run.path("a.ply"), "mine").unwrap();
    assert!(said(2, &["scene", "train", "reef", "-o", "a.ply"]).contains("was not touched"));
    assert!(said(1, &["scene", "export", "a.ply", "-o", "a.splat"]).contains("it is no PLY file"));
    std::fs::write(run.path("reef/images/view_2.5.png"), "").unwrap();
    assert!(said(1, &["scene", "train", "reef", "-o", "b.ply"]).contains("view_2.5.png: the file is empty"));
    let model = run.path("reef/sparse/0/images.txt");
    let text = std::fs::read_to_string(&model).unwrap().replace("view_1.5.png", "../../secret.png");
    std::fs::write(&model, text).unwrap();
    let said = said(1, &["scene", "train", "reef", "-o", "b.ply"]);
    assert!(said.contains("images.txt, line 3: ") && said.contains("leads out of its folder"), "{said}");
    assert!(!run.path("b.ply").exists());
}
