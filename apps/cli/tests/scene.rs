//! Scenes in 3D, from a folder of images with cameras to views of them.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

mod run;

use aquafuse::metrics::psnr;
use aquafuse_data::image_file::ImageFile;
use aquafuse_data::water_file::WaterFile;
use run::{Run, reef, scene};
use serde_json::Value;

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
        said.contains("splats") && said.contains("B_inf") && said.contains("2 images held back: PSNR"),
        "{said}"
    );
    let water = WaterFile::<aquafuse::image::Encoded>::read(&run.path("reef.water.json")).unwrap();
    assert!(water.estimate.water.veiling_light.rgb()[2] > 0.3);
    assert!(!run.path("reef.ply.checkpoint").exists());

    // Seen again through the water it was trained in, and without.
    run.ok(&["scene", "render", "reef.ply", "reef", "-o", "wet", "--longest", "64"]);
    let tight =
        ["scene", "render", "reef.ply", "reef", "-o", "no", "--longest", "4096", "--max-memory", "64MiB"];
    let said = run.fails(1, &tight).stderr;
    assert!(said.contains("bytes to draw, more than the 67108864 of --max-memory"), "{said}");
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
        let [drawn, truth] = [drawn, truth].map(|name| ImageFile::read(&run.path(name)).unwrap());
        psnr(&*drawn.bytes(), &*truth.bytes()).unwrap()
    };
    assert!(score("wet/view_003.png", "reef/images/view_003.png") > 22.0);
    assert!(score("wet/view_003.png", "dry/view_003.png") < 20.0);
    assert!(run.path("dry/view_003.depth.tiff").is_file() && run.path("coast/view_008.png").is_file());

    // Trained again without a water, the old one goes: it would be taken for that of the new splats.
    run.fails(2, &["scene", "train", "reef", "-o", "reef.ply"]);
    std::fs::copy(run.path("reef.ply"), run.path("old.ply")).unwrap();
    std::fs::copy(run.path("reef.water.json"), run.path("old.water.json")).unwrap();
    train("reef", "old.ply", &["--overwrite"]);
    assert!(!run.path("old.water.json").exists());

    // Fused, the cameras go along, and it can be trained as the original was.
    scene(&run.path("green.png"), 3, "green");
    let said = run.ok(&["scene", "fuse", "reef", "green.png", "-o", "fused", "--model", "physical"]).stdout;
    assert!(said.contains("9 images") && said.contains("units of the scene"), "{said}");
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
        text.contains("| reef | original |")
            && text.contains("| reef | original, another seed |")
            && text.contains("| reef | fused: fused |")
            && text.contains("Table 2 of the paper"),
        "{text}"
    );
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
    let twice = [&compare[..3], &["fused", "fused"], &compare[4..]].concat();
    assert!(run.fails(2, &twice).stderr.contains("--fused is given 1 times"));

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

    run.ok(&["scene", "render", "reef.ply", "reef", "-o", "orbit", "--longest", "64", "--orbit", "5"]);
    let mut names: Vec<_> =
        std::fs::read_dir(run.path("orbit")).unwrap().map(|one| one.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, [0, 1, 2, 3, 4].map(|i| std::ffi::OsString::from(format!("orbit_00{i}.png"))));
    // They differ, and look at what the cameras looked at.
    assert!(score("orbit/orbit_001.png", "orbit/orbit_003.png") < 30.0);
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
