//! Scenes of nerfstudio, and one of which an image is missing.

use super::run::{Run, reef, scene};

/// Nine images in `reef/images`, with cameras as nerfstudio has them, and a water.
fn nerfstudio(model: &str) -> Run {
    let run = Run::new();
    reef(&run);
    scene(&run.path("green.png"), 9, "green");
    std::fs::remove_dir_all(run.path("reef/sparse")).unwrap();
    let frame = |number: usize| {
        format!(
            "{{\"file_path\": \"images/view_00{number}.png\", \"transform_matrix\": [[1,0,0,{number}],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}}"
        )
    };
    let frames: Vec<String> = (0..9).map(frame).collect();
    let text = format!(
        "{{\"camera_model\": \"{model}\", \"fl_x\": 32, \"fl_y\": 32, \"cx\": 32, \"cy\": 24, \"w\": 64, \"h\": 48, \"k1\": 0, \"frames\": [{}]}}",
        frames.join(",")
    );
    std::fs::write(run.path("reef/transforms.json"), text).unwrap();
    run
}

const TRAIN: [&str; 8] = ["scene", "train", "reef", "-o", "reef.ply", "--iterations", "1", "--longest=32"];
const FUSE: [&str; 6] = ["scene", "fuse", "reef", "green.png", "-o", "out"];

#[test]
fn nerfstudio_images() {
    let run = nerfstudio("OPENCV");
    run.ok(&TRAIN);
    let said = run.ok(&FUSE).stdout;
    assert!(said.contains("9 images in green.png's water") && !said.contains("left out"), "{said}");
    assert!(run.path("out/images/view_008.png").exists() && run.path("out/transforms.json").exists());
}

#[test]
fn nerfstudio_fisheye() {
    let run = nerfstudio("OPENCV_FISHEYE");
    for command in [&TRAIN[..], &FUSE[..]] {
        let output = run.command(command).output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(matches!(output.status.code(), Some(1 | 2)), "{said}");
        assert!(said.contains("transforms.json") && said.contains("colmap image_undistorter"), "{said}");
    }
}

#[test]
fn scene_missing_picture() {
    let run = Run::new();
    reef(&run);
    std::fs::remove_file(run.path("reef/images/view_003.png")).unwrap();
    let said = run.fails(2, &TRAIN).stderr;
    assert!(said.contains("lacks 1 of the 9 images of the scene, first view_003.png"), "{said}");
    assert!(said.contains("--skip-missing"), "{said}");
    run.ok(&[&TRAIN[..], &["--skip-missing"]].concat());
}

/// The kin: images of the folder that no camera sees, as a mapper leaves them.
#[test]
fn scene_image_without_camera() {
    let run = nerfstudio("OPENCV");
    scene(&run.path("reef/images/view_9.png"), 5, "blue");
    let left = "(images left out, because without a camera: 1, first reef/images/view_9.png)";
    let said = run.ok(&TRAIN).stdout;
    assert!(said.contains(left), "{said}");
    let said = run.ok(&FUSE).stdout;
    assert!(said.contains("9 images in green.png's water") && said.contains(left), "{said}");
}
