//! Depth files against NumPy, OpenCV, tifffile and OpenEXR: they read ours, we read theirs.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

use std::ffi::OsString;
use std::path::Path;
use std::process::Command;

use aquafuse::depth::{DepthKind, DepthMap, SuppliedKind};
use aquafuse::image::Image;
use aquafuse_data::depth_file;
use aquafuse_data::image_file::WriteOptions;

const SCRIPT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/independent_depth.py");
const SIZE: (usize, usize) = (7, 5);

/// Distances from 1 to 9 m, of which no row or column is like another.
fn truth() -> Vec<f32> {
    (0..35).map(|i| 1.0 + 8.0 * ((i * i) as f32 / 1156.0)).collect()
}

fn python() -> Option<OsString> {
    let python = std::env::var_os("AQUAFUSE_PYTHON");
    if python.is_none() {
        eprintln!("skipped: AQUAFUSE_PYTHON names no Python with OpenCV; `cargo xtask test` sets one up");
    }
    python
}

fn run(python: &OsString, what: &str, folder: &Path) {
    let bytes: Vec<u8> = truth().into_iter().flat_map(f32::to_le_bytes).collect();
    std::fs::write(folder.join("truth.f32"), bytes).unwrap();
    let ended = Command::new(python).args([SCRIPT, what]).arg(folder).output().unwrap();
    assert!(ended.status.success(), "{}", String::from_utf8_lossy(&ended.stderr));
}

#[test]
fn others_read_what_we_write() {
    let Some(python) = python() else { return };
    let folder = tempfile::tempdir().unwrap();
    let depth = DepthMap::from_distances(SIZE.0, SIZE.1, DepthKind::Metres, truth()).unwrap();
    for extension in ["png", "tiff", "exr", "npy", "pfm"] {
        let path = folder.path().join(format!("ours.{extension}"));
        depth_file::write(&path, &depth, &WriteOptions::default()).unwrap();
    }
    run(&python, "check", folder.path());
}

#[test]
fn we_read_what_others_write() {
    let Some(python) = python() else { return };
    let folder = tempfile::tempdir().unwrap();
    run(&python, "write", folder.path());
    let image = Image::from_raw(SIZE.0, SIZE.1, vec![90; 105]).unwrap();
    let mut count = 0;
    for entry in std::fs::read_dir(folder.path()).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap();
        // Half floats have 11 bits, millimetres their own rounding, the rest is exact.
        let (kind, tolerance) = match name.split(['_', '.']).next().unwrap() {
            "truth" => continue,
            "metres" => (SuppliedKind::Metres, 0.0),
            "half" => (SuppliedKind::Metres, 0.004),
            "millimetres" => (SuppliedKind::Millimetres, 0.000_501),
            _ => (SuppliedKind::Metres, 0.5),
        };
        let found = depth_file::read(&path, kind).unwrap().seen_with(&image, Default::default()).unwrap();
        for (theirs, truth) in found.depth.distances().iter().zip(truth()) {
            assert!((theirs - truth).abs() <= tolerance, "{name}: {theirs} {truth}");
        }
        count += 1;
    }
    assert_eq!(count, 27);
}
