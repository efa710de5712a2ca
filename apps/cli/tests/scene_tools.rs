//! Programs of others that scenes are made with: pycolmap, COLMAP, Brush. Stand-ins show what is asked of them and what is
//! said when they fail; pycolmap itself is tried where it is installed.

#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

mod run;

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use aquafuse::truth::Size;
use aquafuse_data::image_file::{ImageFile, ReadOptions, WriteOptions};
use aquafuse_scene::camera::Camera;
use aquafuse_scene::files::{read_cameras, read_splats};
use aquafuse_scene::truth::views;
use run::{Run, program, reef};

/// Cameras that a stand-in "finds": those of the reef, as COLMAP's binary files.
fn model(run: &Run) {
    let folder = run.path("model");
    std::fs::create_dir(&folder).unwrap();
    let mut cameras = 1_u64.to_le_bytes().to_vec();
    cameras.extend([1_u32, 0].map(u32::to_le_bytes).concat());
    cameras.extend([64_u64, 48].map(u64::to_le_bytes).concat());
    cameras.extend([32.0_f64, 32.0, 24.0].map(f64::to_le_bytes).concat());
    let mut images = 2_u64.to_le_bytes().to_vec();
    for (id, name) in [(1_u32, "view_000.png"), (2, "view_003.png")] {
        images.extend(id.to_le_bytes());
        images.extend([1.0_f64, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0].map(f64::to_le_bytes).concat());
        images.extend(1_u32.to_le_bytes());
        images.extend(name.as_bytes());
        images.push(0);
        images.extend(0_u64.to_le_bytes());
    }
    for (name, bytes) in
        [("cameras.bin", cameras), ("images.bin", images), ("points3D.bin", 0_u64.to_le_bytes().to_vec())]
    {
        std::fs::write(folder.join(name), bytes).unwrap();
    }
}

/// A COLMAP that writes down what it is asked, and finds the model.
const COLMAP: &str = r#"
case "$1 $2" in
  "help "*) echo "feature_extractor mapper"; exit 0 ;;
  "feature_extractor -h") echo "--SiftExtraction.use_gpu"; exit 0 ;;
esac
echo "$1" >> asked.txt
[ "$1" = mapper ] && mkdir -p reef3d/.aquafuse-sfm/models/0 && cp model/* reef3d/.aquafuse-sfm/models/0/
exit 0"#;

#[test]
fn a_scene_is_made_of_what_colmap_finds() {
    let run = Run::new();
    reef(&run);
    model(&run);
    let colmap = program(&run, "colmap", COLMAP);
    let sfm = ["scene", "sfm", "reef/images", "-o", "reef3d", "--colmap", &colmap];
    let said = run.ok(&sfm).stdout;
    assert!(said.starts_with("reef3d: 2 of 9 images have a camera, 0 points; by colmap\n"), "{said}");
    assert!(said.contains("no camera was found for view_001.png, view_002.png, view_004.png"), "{said}");
    let asked = std::fs::read_to_string(run.path("asked.txt")).unwrap();
    assert_eq!(asked, "feature_extractor\nexhaustive_matcher\nmapper\n");
    assert_eq!(read_cameras(&run.path("reef3d"), &ReadOptions::default()).unwrap().images.len(), 2);
    assert_eq!(run.bytes("reef3d/images/view_004.png"), run.bytes("reef/images/view_004.png"));
    assert!(!run.path("reef3d/.aquafuse-sfm").exists());
    // It is a scene now, and not written over unasked.
    assert!(run.fails(2, &sfm).stderr.contains("is not empty"));
    run.ok(&[&sfm[..], &["--overwrite", "--in-order"]].concat());
    assert!(std::fs::read_to_string(run.path("asked.txt")).unwrap().contains("sequential_matcher"));
}

#[test]
fn no_python_of_the_current_folder_is_run() {
    let run = Run::new();
    reef(&run);
    for module in ["pycolmap.py", "sqlite3.py", "pathlib.py", "site.py"] {
        std::fs::write(run.path(module), "open('was_run', 'w')\n").unwrap();
    }
    let sfm = ["scene", "sfm", "reef/images", "-o", "reef3d"];
    let _ = run.command(&sfm).env("PYTHONPATH", ".").output().unwrap();
    assert!(!run.path("was_run").exists());
}

#[test]
fn a_tool_that_fails_is_quoted_and_one_that_is_missing_is_named() {
    let run = Run::new();
    reef(&run);
    let sfm = ["scene", "sfm", "reef/images", "-o", "reef3d"];
    let python = program(
        &run,
        "python",
        "case \"$*\" in *'import pycolmap') exit 0;; esac\necho 'no two images see the same' >&2\nexit 3",
    );
    let said = run.fails(1, &[&sfm[..], &["--python", &python]].concat()).stderr;
    assert!(said.contains("finding features: ") && said.contains("no two images see the same"), "{said}");
    assert!(said.contains("exit status: 3") && said.contains("log.txt"), "{said}");
    // What it left does not stand in the way.
    let quiet = program(&run, "quiet", "exit 0");
    let said = run.fails(1, &[&sfm[..], &["--python", &quiet]].concat()).stderr;
    assert!(said.contains("no cameras were found"), "{said}");

    let none = program(&run, "none", "exit 1");
    let said = run.fails(2, &[&sfm[..], &["--python", &none]].concat()).stderr;
    assert!(said.contains("has no pycolmap") && said.contains("-m pip install pycolmap"), "{said}");
    let mut command = run.command(&sfm);
    let ended = command.env("PATH", run.path("reef")).output().unwrap();
    let said = String::from_utf8(ended.stderr).unwrap();
    assert_eq!(ended.status.code(), Some(2), "{said}");
    assert!(
        said.contains("python3 -m pip install pycolmap") && said.contains("apt install colmap"),
        "{said}"
    );
    assert!(run.fails(2, &["scene", "sfm", "reef", "-o", "x"]).stderr.contains("takes three at least"));
}

#[test]
fn a_tool_ends_when_we_are_told_to() {
    let run = Run::new();
    reef(&run);
    let slow = program(
        &run,
        "colmap",
        "[ \"$1\" = help ] || [ \"$2\" = -h ] && { echo mapper; exit 0; }\necho $$ > pid.txt\nexec sleep 60",
    );
    let mut child =
        run.command(&["scene", "sfm", "reef/images", "-o", "x", "--colmap", &slow]).spawn().unwrap();
    let began = Instant::now();
    let tool = loop {
        let text = std::fs::read_to_string(run.path("pid.txt")).unwrap_or_default();
        if text.ends_with('\n') {
            break text.trim().to_owned();
        }
        assert!(began.elapsed() < Duration::from_secs(30), "the tool was not started");
        std::thread::sleep(Duration::from_millis(10));
    };
    let kill = |signal: &str, process: &str| {
        Command::new("kill").args([signal, process]).stderr(Stdio::null()).status().unwrap().success()
    };
    assert!(kill("-TERM", &child.id().to_string()));
    assert_eq!(child.wait().unwrap().code(), Some(143));
    // The system takes a moment to clear it away.
    let ended = Instant::now();
    while kill("-0", &tool) {
        assert!(ended.elapsed() < Duration::from_secs(10), "the tool still runs");
        std::thread::sleep(Duration::from_millis(10));
    }
}

#[test]
fn pycolmap_finds_the_cameras_of_a_place_that_is_known() {
    let python = std::env::var("AQUAFUSE_PYTHON").unwrap_or_else(|_| "python3".into());
    let has = Command::new(&python).args(["-c", "import pycolmap"]).output();
    if !has.is_ok_and(|ended| ended.status.success()) {
        println!("skipped: {python} has no pycolmap");
        return;
    }
    let run = Run::new();
    let known = views(1, Size { width: 200, height: 150 }, 8, 2);
    std::fs::create_dir(run.path("photos")).unwrap();
    for (i, view) in known.iter().enumerate() {
        let image_file = ImageFile::new(view.clear().convert::<u8>());
        image_file.write(&run.path(&format!("photos/{i:02}.png")), &WriteOptions::default()).unwrap();
    }
    let said = run.ok(&["scene", "sfm", "photos", "-o", "place", "--python", &python]).stdout;
    println!("{said}");
    let found = read_cameras(&run.path("place"), &ReadOptions::default()).unwrap();
    assert!(found.images.len() >= 7 && found.points.len() > 100, "{said}");
    // How far cameras are apart is right up to one scale.
    let number = |name: &Path| name.file_stem().unwrap().to_str().unwrap().parse::<usize>().unwrap();
    let apart = |a: &Camera, b: &Camera| {
        let (a, b) = (a.position(), b.position());
        (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()
    };
    let mut ratios = Vec::new();
    for (i, a) in found.images.iter().enumerate() {
        for b in &found.images[..i] {
            let truth = apart(&known[number(&a.name)].camera, &known[number(&b.name)].camera);
            ratios.push(apart(&a.lens.camera, &b.lens.camera) / truth);
        }
    }
    ratios.sort_by(f64::total_cmp);
    let at = |share: f64| ratios[(share * (ratios.len() - 1) as f64) as usize];
    assert!(at(0.9) / at(0.1) < 1.15, "{ratios:?}");
}

/// A Brush that "trains" by handing out splats that lie ready, and writes down what it was asked.
const BRUSH: &str = r#"
[ "$1" = --help ] && { echo "  --total-train-iters <N>"; exit 0; }
echo "$@" > asked.txt
ls "$1/images" > pictures.txt
cp "$1/sparse/0/cameras.txt" lens.txt
while [ $# -gt 0 ]; do [ "$1" = --export-path ] && out="$2"; shift; done
cp ready.ply "$out/splats.ply""#;

#[test]
fn brush_trains_on_the_images_that_we_would_train_on() {
    let run = Run::new();
    reef(&run);
    let train = ["scene", "train", "reef", "--hold", "8", "--longest", "32", "--iterations", "30"];
    run.ok(&[&train[..], &["-o", "ready.ply"]].concat());
    let brush = program(&run, "brush", BRUSH);
    let with = ["-o", "brush.ply", "--engine", "brush", "--brush", &brush, "--seed", "5"];
    let said = run.ok(&[&train[..], &with].concat()).stdout;
    assert!(said.contains("2 images held out: PSNR"), "{said}");
    let asked = std::fs::read_to_string(run.path("asked.txt")).unwrap();
    for words in
        ["--total-train-iters 30 --export-every 30", "--seed 5", "--sh-degree 0", "--max-splats 100000"]
    {
        assert!(asked.contains(words), "{asked}");
    }
    assert_eq!(std::fs::read_to_string(run.path("pictures.txt")).unwrap().lines().count(), 7);
    assert!(std::fs::read_to_string(run.path("lens.txt")).unwrap().starts_with("1 PINHOLE 32 24 "));
    assert_eq!(
        read_splats(&run.path("brush.ply"), &ReadOptions::default()).unwrap(),
        read_splats(&run.path("ready.ply"), &ReadOptions::default()).unwrap()
    );
    assert!(!run.path("brush.ply.brush").exists());

    let said = |arguments: &[&str], code| run.fails(code, &[&train[..], arguments].concat()).stderr;
    let broken =
        program(&run, "broken", "[ \"$1\" = --help ] && echo --total-steps || { echo 'no GPU'; exit 1; }");
    let failed = said(&["-o", "x.ply", "--engine", "brush", "--brush", &broken], 1);
    assert!(failed.contains("Brush did not train") && failed.contains("no GPU"), "{failed}");
    let missing = said(&["-o", "y.ply", "--engine", "brush", "--brush", "no/such/brush"], 2);
    assert!(missing.contains("no/such/brush") && missing.contains("--engine cpu"), "{missing}");
    assert!(
        said(&["-o", "z.ply", "--engine", "brush", "--water", "learn"], 2).contains("cannot learn a water")
    );
}
