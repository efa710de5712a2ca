//! What strangers' files, other programs and odd systems may do to a user's labels, files and machine. Each test is a fault
//! that once got through, and its kin.

#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

mod labels;
mod numbers;
mod outputs;
mod programs;
#[path = "../run/mod.rs"]
mod run;
mod system;
mod words;

use run::{Run, scene};

/// A dataset of YOLO with two images and `classes.txt`, and a water.
fn fish() -> Run {
    let run = Run::new();
    for folder in ["fish/images", "fish/labels"] {
        std::fs::create_dir_all(run.path(folder)).unwrap();
    }
    for (seed, name) in [(1, "a"), (2, "b")] {
        scene(&run.path(&format!("fish/images/{name}.png")), seed, "blue");
        std::fs::write(run.path(&format!("fish/labels/{name}.txt")), "0 0.5 0.5 0.25 0.25\n").unwrap();
    }
    scene(&run.path("green.png"), 9, "green");
    run
}

/// A folder of two images, and a water.
fn photos() -> Run {
    let run = Run::new();
    std::fs::create_dir(run.path("photos")).unwrap();
    scene(&run.path("photos/a.png"), 1, "blue");
    scene(&run.path("photos/b.png"), 2, "blue");
    scene(&run.path("green.png"), 9, "green");
    run
}

/// Writes a file, with the folders above it.
fn write(run: &Run, name: &str, content: impl AsRef<[u8]>) {
    let path = run.path(name);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(path, content).unwrap();
}

const AUGMENT: [&str; 7] = ["augment", "fish", "green.png", "-o", "out", "--keep-share", "0"];
const FUSE: [&str; 5] = ["fuse", "photos", "green.png", "-o", "out"];
