//! Inputs from other people's bug reports, made here: each was refused without a reason, or lost something without a word.
//! A test has the name of its case.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

mod coco;
mod labels;
mod masks;
mod pictures;
#[path = "../run/mod.rs"]
mod run;
mod scenes;

use std::collections::BTreeSet;
use std::path::Path;

use run::{Ended, Run, scene};

const LINE: &str = "0 0.5 0.5 0.25 0.25\n";
const AUGMENT: [&str; 6] = ["augment", "set", "green.png", "-o", "out", "--keep-originals"];

/// A dataset with these images, and a water.
fn with_images(paths: &[&str]) -> Run {
    let run = Run::new();
    scene(&run.path("green.png"), 9, "green");
    for (seed, path) in (1..).zip(paths) {
        let path = run.path("set").join(path);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        scene(&path, seed, "blue");
    }
    run
}

/// Writes a file of the dataset, with the folders above it.
fn write(run: &Run, name: &str, content: impl AsRef<[u8]>) {
    let path = run.path("set").join(name);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(path, content).unwrap();
}

/// Augments the dataset, all splits, and expects success.
fn augmented(run: &Run) -> Ended {
    run.ok(&[&AUGMENT[..], &["--splits", "all"]].concat())
}

/// Augments the dataset and expects a refusal, which says all of this.
fn refused(run: &Run, said: &[&str]) {
    let stderr = run.fails(2, &AUGMENT).stderr;
    for words in said {
        assert!(stderr.contains(words), "{words} is not in: {stderr}");
    }
    assert!(!run.path("out").exists());
}

/// What the output has beside its manifest and its preview.
fn made(run: &Run) -> BTreeSet<String> {
    fn enter(folder: &Path, root: &Path, found: &mut BTreeSet<String>) {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                enter(&path, root, found);
            } else {
                found.insert(path.strip_prefix(root).unwrap().to_str().unwrap().replace('\\', "/"));
            }
        }
    }
    let mut found = BTreeSet::new();
    enter(&run.path("out"), &run.path("out"), &mut found);
    found.retain(|path| path != "manifest.jsonl" && path != "preview.jpg");
    found
}

/// Expects these files in the output, and no others.
fn has(run: &Run, files: &[&str]) {
    assert_eq!(made(run), files.iter().map(|file| (*file).to_owned()).collect());
}
