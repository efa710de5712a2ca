//! Depth by a network, as a user runs the command.

#![cfg(feature = "onnx")]
#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

#[path = "../../../crates/aquafuse-data/tests/onnx/mod.rs"]
mod onnx;
mod run;

use aquafuse::depth::{DepthKind, DepthMap, SuppliedKind};
use aquafuse::image::TopEdge;
use aquafuse_data::depth_file;
use aquafuse_data::image_file::{ImageFile, WriteOptions};
use onnx::Network;
use run::{Run, scene};

/// Images of the tests are 96 x 64: the side at which 98 x 70 pixels are the nearest multiples of 14.
const SIDE: &str = "80";

fn network(run: &Run) {
    std::fs::write(run.path("net.onnx"), Network::MEAN.file()).unwrap();
}

#[test]
fn the_depth_of_a_network_is_that_of_the_same_map_supplied() {
    let run = Run::new();
    // Of the images' own size, so that nothing is scaled on the way.
    let fixed = Network { input: ("image", &[1, 3, 64, 96]), ..Network::MEAN };
    std::fs::write(run.path("net.onnx"), fixed.file()).unwrap();
    scene(&run.path("a.png"), 1, "blue");
    run.ok(&["depth", "a.png", "-o", "z.npy", "--depth-model", "net.onnx"]);
    let found = depth_file::read(&run.path("z.npy"), SuppliedKind::Relative).unwrap();
    let image = ImageFile::read(&run.path("a.png")).unwrap();
    let image = image.bytes();
    assert_eq!(found.size(), image.size());
    let found = found.labels(&image).unwrap();

    let (mean, deviation) = ([0.485, 0.456, 0.406], [0.229, 0.224, 0.225]);
    let of = |pixel: &[u8; 3]| {
        3.0 + (0..3)
            .map(|c| (f32::from(pixel[c]) / 255.0 - mean[c]) / deviation[c] / 3.0)
            .fold(0.0, |a, b| a + b)
    };
    let (width, height) = image.size();
    let values = image.pixels().iter().map(of).collect();
    let supplied = DepthMap::from_distances(width, height, DepthKind::Metres, values).unwrap();
    depth_file::write(&run.path("map.npy"), &supplied, &WriteOptions::default()).unwrap();
    let supplied = depth_file::read(&run.path("map.npy"), SuppliedKind::Inverse).unwrap();
    let expected = supplied.seen_with(&image, TopEdge::First).unwrap().depth.distances();
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() < 1e-4, "{found} is not {expected}");
    }
}

#[test]
fn commands_take_a_network_and_name_it() {
    let run = Run::new();
    network(&run);
    scene(&run.path("a.png"), 1, "blue");
    scene(&run.path("b.png"), 2, "green");
    let model = ["--depth-model", "net.onnx", "--depth-model-size", SIDE];
    let report = run.ok(&[&["inspect", "a.png", "--json"][..], &model].concat()).stdout;
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    assert!(report["depth"]["source"].as_str().unwrap().starts_with("net.onnx (sha256 "), "{report}");
    run.ok(&[&["fuse", "a.png", "b.png", "-o", "fused.png"][..], &model].concat());
    run.ok(&["fuse", "a.png", "b.png", "-o", "colour.png"]);
    assert_ne!(run.bytes("fused.png"), run.bytes("colour.png"));
    run.ok(&[&["restore", "a.png", "-o", "restored.png"][..], &model].concat());
    run.ok(&[&["water", "extract", "a.png", "-o", "a.water.json"][..], &model].concat());
}

#[test]
fn options_of_a_network_need_one() {
    let run = Run::new();
    scene(&run.path("a.png"), 1, "blue");
    let said = run.fails(2, &["depth", "a.png", "-o", "z.npy", "--depth-model-kind", "inverse"]).stderr;
    assert!(said.contains("--depth-model FILE.onnx"), "{said}");
    std::fs::write(run.path("bad.onnx"), b"no network").unwrap();
    let said = run.fails(2, &["depth", "a.png", "-o", "z.npy", "--depth-model", "bad.onnx"]).stderr;
    assert!(said.contains("bad.onnx") && said.contains("ONNX"), "{said}");
}
