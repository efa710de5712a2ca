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
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../benches/opencv_pipeline.py");
    let run = Run::new();
    for (content, reference) in [("blue", "green"), ("turbid", "clear"), ("clear", "deep")] {
        for model in ["aquafuse", "physical"] {
            scene(&run.path("content.png"), 1, content);
            scene(&run.path("reference.png"), 2, reference);
            let ended = Command::new(&python)
                .current_dir(run.path(""))
                .arg(&script)
                .args([
                    "fuse",
                    "content.png",
                    "reference.png",
                    "theirs.png",
                    "--model",
                    model,
                    "--depth",
                    "their_z.png",
                ])
                .output()
                .unwrap();
            assert!(ended.status.success(), "{}", String::from_utf8_lossy(&ended.stderr));
            run.ok(&[
                "fuse",
                "content.png",
                "reference.png",
                "-o",
                "ours.png",
                "--model",
                model,
                "--overwrite",
            ]);
            run.ok(&["depth", "content.png", "-o", "our_z.png", "--overwrite"]);

            let depth = |name: &str| image::open(run.path(name)).unwrap().into_luma16().into_raw();
            assert_eq!(depth("our_z.png"), depth("their_z.png"), "{content}: the depth differs");
            // One step of 255: sums of floats are rounded in another order.
            let pixels = |name: &str| image::open(run.path(name)).unwrap().into_rgb8().into_raw();
            let (ours, theirs) = (pixels("ours.png"), pixels("theirs.png"));
            let worst = ours.iter().zip(&theirs).map(|(a, b)| a.abs_diff(*b)).max();
            assert!(worst <= Some(1), "{content} in {reference} water, {model}: off by {worst:?}");
            for name in ["content.png", "reference.png"] {
                std::fs::remove_file(run.path(name)).unwrap();
            }
        }
    }
}
