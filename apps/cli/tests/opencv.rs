//! The whole way against an independent version of it, written with OpenCV (`benches/opencv_pipeline.py`).

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

mod run;

use std::path::Path;
use std::process::Command;

use run::{Run, scene};

#[test]
fn fusion_and_depth_equal_the_same_algorithm_in_opencv() {
    let Some(python) = std::env::var_os("AQUAFUSE_PYTHON") else {
        eprintln!("skipped: AQUAFUSE_PYTHON names no Python with OpenCV; `cargo xtask test` sets one up");
        return;
    };
    let run = Run::new();
    for (content, reference) in [("blue", "green"), ("turbid", "clear"), ("clear", "deep")] {
        scene(&run.path(content).with_extension("png"), 1, content);
        scene(&run.path(reference).with_extension("jpg"), 2, reference);
        for model in ["aquafuse", "physical"] {
            for depth_model in ["eq3", "eq3-median"] {
                let [content, reference] = [format!("{content}.png"), format!("{reference}.jpg")];
                compare(&run, Path::new(&python), [&content, &reference], [model, depth_model]);
            }
        }
    }
    // No open water in sight: the lower half of a place, so near that the far end is rock and sand.
    for content in ["blue", "turbid", "clear"] {
        lower_half(&run.path(content).with_extension("png"), &run.path("floor.png"));
        compare(&run, Path::new(&python), ["floor.png", "green.jpg"], ["physical", "eq3-median"]);
        // The darkest things cut off at black.
        crushed(&run.path("floor.png"), &run.path("crushed.png"));
        compare(&run, Path::new(&python), ["crushed.png", "green.jpg"], ["physical", "eq3-median"]);
    }
}

#[test]
fn smoothing_equals_the_bilateral_filter_of_opencv() {
    let Some(python) = std::env::var_os("AQUAFUSE_PYTHON") else {
        eprintln!("skipped: AQUAFUSE_PYTHON names no Python with OpenCV; `cargo xtask test` sets one up");
        return;
    };
    let run = Run::new();
    scene(&run.path("scene.png"), 1, "turbid");
    // Colours without order: every difference of colour occurs, and every border pixel has its own window.
    let mut state = 1_u32;
    let mut noise = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 24) as u8
    };
    let colours = image::RgbImage::from_fn(61, 43, |_, _| image::Rgb([noise(), noise(), noise()]));
    colours.save(run.path("noise.png")).unwrap();
    image::imageops::crop_imm(&colours, 0, 0, 2, 1).to_image().save(run.path("tiny.png")).unwrap();
    let script =
        "import cv2, sys; cv2.imwrite(sys.argv[2], cv2.bilateralFilter(cv2.imread(sys.argv[1]), 5, 75, 75))";
    for name in ["scene.png", "noise.png", "tiny.png"] {
        let mut command = Command::new(&python);
        command.current_dir(run.path("")).args(["-c", script, name, "theirs.png"]);
        let ended = command.output().unwrap();
        assert!(ended.status.success(), "{}", String::from_utf8_lossy(&ended.stderr));
        // In its own water the image itself is what is smoothed.
        run.ok(&["fuse", name, name, "-o", "ours.png", "--smooth", "bilateral", "--overwrite"]);
        let pixels = |name: &str| image::open(run.path(name)).unwrap().into_rgb8().into_raw();
        let off = pixels("ours.png").iter().zip(&pixels("theirs.png")).map(|(a, b)| a.abs_diff(*b)).max();
        // One step: halves are rounded another way, and its weights are floats.
        assert!(off <= Some(1), "{name}: off by {off:?}");
    }
}

fn compare(run: &Run, python: &Path, [content, reference]: [&str; 2], [model, depth_model]: [&str; 2]) {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../benches/opencv_pipeline.py");
    let fused = |output: &str, more: &[&str]| {
        let mut command = Command::new(python);
        command.current_dir(run.path("")).arg(&script).args(["fuse", content, reference, output]);
        let ended =
            command.args(["--model", model, "--depth-model", depth_model]).args(more).output().unwrap();
        assert!(ended.status.success(), "{}", String::from_utf8_lossy(&ended.stderr));
    };
    fused("theirs.png", &["--depth", "their_z.png"]);
    fused("fast.png", &["--fast"]);
    let by = ["--depth-model", depth_model, "--overwrite"];
    let fuse = ["fuse", content, reference, "-o", "ours.png", "--model", model, "--water-map", "rules"];
    run.ok(&[&fuse, &by[..]].concat());
    run.ok(&[&["depth", content, "-o", "our_z.png"], &by[..]].concat());

    let said = format!("{content} in the water of {reference}, {model} by {depth_model}");
    let depth = |name: &str| image::open(run.path(name)).unwrap().into_luma16().into_raw();
    let (ours, theirs) = (depth("our_z.png"), depth("their_z.png"));
    // One of 2040 steps, and of few pixels: sums of floats are rounded in another order. The median is whole numbers.
    let most = if depth_model == "eq3" { 33 } else { 0 };
    let apart = ours.iter().zip(&theirs).map(|(a, b)| a.abs_diff(*b));
    assert!(apart.clone().all(|apart| apart <= most), "{said}: depth is off by {:?}", apart.max());
    assert!(
        apart.filter(|&apart| apart > 0).count() * 100 <= ours.len(),
        "{said}: depth is off in many pixels"
    );

    // One step of 255, for the same reason.
    let off = |name: &str| {
        let pixels = |name: &str| image::open(run.path(name)).unwrap().into_rgb8().into_raw();
        pixels("ours.png").iter().zip(&pixels(name)).map(|(a, b)| a.abs_diff(*b)).max()
    };
    assert!(off("theirs.png") <= Some(1), "{said}: off by {:?}", off("theirs.png"));
    // What is timed, `aquafuse`, rounds depth in another place: a level here and there, and so the estimates by a trifle.
    if model == "aquafuse" {
        assert!(off("fast.png") <= Some(3), "{said}: the timed path is off by {:?}", off("fast.png"));
    }
}

fn lower_half(whole: &Path, half: &Path) {
    let image = image::open(whole).unwrap();
    let (width, height) = (image.width(), image.height());
    image.crop_imm(0, height / 2, width, height / 2).save(half).unwrap();
}

fn crushed(whole: &Path, crushed: &Path) {
    let mut image = image::open(whole).unwrap().into_rgb8();
    image.iter_mut().for_each(|value| *value = value.saturating_sub(70));
    image.save(crushed).unwrap();
}
