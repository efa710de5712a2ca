//! Depth by a network, as a user runs the command.

#![cfg(feature = "onnx")]
#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

#[path = "../../../crates/aquafuse-data/tests/onnx/mod.rs"]
mod onnx;
mod run;

use std::io::Write;
use std::process::Stdio;

use aquafuse::depth::{DepthKind, DepthMap, SuppliedKind};
use aquafuse::image::{Image, TopEdge};
use aquafuse_data::depth_file;
use aquafuse_data::image_file::{ImageFile, WriteOptions};
use onnx::Network;
use run::{Run, reef, scene, scenes_folder};

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
fn a_photograph_is_fused_with_the_depth_of_a_network() {
    let data = std::env::var_os("AQUAFUSE_TEST_DATA").map(std::path::PathBuf::from);
    let photos = data.and_then(|data| std::fs::read_dir(data.join("scenes")).ok());
    let mut photos: Vec<_> = photos.into_iter().flatten().flatten().map(|entry| entry.path()).collect();
    photos.retain(|path| path.extension().is_some_and(|kind| kind == "jpg" || kind == "png"));
    photos.sort();
    let [content, water, ..] = photos.as_slice() else {
        eprintln!("skipped: AQUAFUSE_TEST_DATA names no folder with scenes");
        return;
    };
    let run = Run::new();
    network(&run);
    let [content, water] = [content, water].map(|path| path.to_str().unwrap());
    run.ok(&[
        "fuse",
        content,
        water,
        "-o",
        "fused.png",
        "--depth-model",
        "net.onnx",
        "--depth-model-size",
        "140",
        "--model",
        "exchange",
        "--maps",
        "maps",
    ]);
    let [before, after] = [content.into(), run.path("fused.png")]
        .map(|path: std::path::PathBuf| ImageFile::read(&path).unwrap());
    assert_eq!(before.pixels.size(), after.pixels.size());
    assert_ne!(*before.bytes(), *after.bytes());
    let depth = std::path::Path::new(content).with_extension("depth.png");
    let depth = run.path("maps").join(depth.file_name().unwrap());
    let depth = depth_file::read(&depth, SuppliedKind::Relative).unwrap();
    assert_eq!(depth.size(), before.pixels.size());
    let depth = depth.labels(&*before.bytes()).unwrap();
    // The network calls bright things near, and the map follows the image at its full size.
    let light = |pixel: &[u8; 3]| pixel.iter().map(|value| f32::from(*value)).sum::<f32>();
    let bytes = before.bytes();
    let mean = |values: &[f32]| values.iter().sum::<f32>() / values.len() as f32;
    let middle = mean(&bytes.pixels().iter().map(light).collect::<Vec<_>>());
    let (bright, dark): (Vec<_>, Vec<_>) =
        bytes.pixels().iter().zip(depth).partition(|(pixel, _)| light(pixel) > middle);
    let [bright, dark] = [bright, dark].map(|half| mean(&half.iter().map(|(_, z)| *z).collect::<Vec<_>>()));
    assert!(bright + 0.1 < dark, "bright things lie at {bright}, dark ones at {dark}");
}

#[test]
fn a_variant_is_made_again_with_the_same_network_alone() {
    let run = Run::new();
    network(&run);
    std::fs::create_dir(run.path("photos")).unwrap();
    scene(&run.path("photos/a.png"), 1, "blue");
    let model = ["--depth-model", "net.onnx", "--depth-model-size", SIDE];
    let made = ["augment", "photos", "preset:jerlov-3C", "-o", "more", "--keep-share", "0"];
    run.ok(&[&made[..], &model].concat());
    assert!(run.ok(&["replay", "more", "-o", "again"]).stdout.starts_with("1 variants"));
    run.ok(&["replay", "more", "-o", "in_time", "--depth-model-seconds", "600"]);
    let said = run.fails(2, &["replay", "more", "-o", "never", "--depth-model-seconds", "0"]).stderr;
    assert!(said.contains("--depth-model-seconds"), "{said}");

    // The same numbers by another file: its name alone is not enough.
    let other = Network {
        outputs: &["disparity"],
        nodes: &[("ReduceMean", &["image", "channels"], "disparity", &[("keepdims", 0)])],
        ..Network::MEAN
    };
    std::fs::write(run.path("net.onnx"), other.file()).unwrap();
    let said = run.fails(1, &["replay", "more", "-o", "third"]).stderr;
    assert!(said.contains("net.onnx") && !run.path("third/images").exists(), "{said}");
}

#[test]
fn a_network_is_scored_beside_the_models_of_colour() {
    let run = Run::new();
    network(&run);
    for folder in ["pairs", "pairs/rgb", "pairs/depth"] {
        std::fs::create_dir(run.path(folder)).unwrap();
    }
    scene(&run.path("pairs/rgb/a.png"), 1, "blue");
    let model = ["--depth-model", "net.onnx", "--depth-model-size", SIDE];
    // What the network itself says of the image is known depth here: it must agree with itself.
    run.ok(&[&["depth", "pairs/rgb/a.png", "-o", "pairs/depth/a.npy"][..], &model].concat());
    let ask = ["evaluate", "depth", "pairs", "--depth-kind", "relative", "-o", "scores.json"];
    run.ok(&[&ask[..], &model].concat());
    let report: serde_json::Value = serde_json::from_slice(&run.bytes("scores.json")).unwrap();
    let text = report.to_string();
    assert!(text.contains("net.onnx"), "{text}");
    let rows = report["items"].as_array().unwrap();
    let own = rows.iter().find(|row| row["depth"] == "net.onnx").unwrap();
    assert!(own["spearman"].as_f64().unwrap() > 0.999, "{own}");
    let said = run.fails(2, &[&ask[..5], &["--depth-model-size", SIDE]].concat()).stderr;
    assert!(said.contains("--depth-model FILE.onnx"), "{said}");
}

#[test]
fn a_scene_takes_a_network() {
    let run = Run::new();
    network(&run);
    reef(&run);
    let model = ["--depth-model", "net.onnx", "--depth-model-size", SIDE];
    let fuse = |output, more: &[&str]| {
        run.ok(&[&["scene", "fuse", "reef", "preset:jerlov-3C", "-o", output, "--model", "exchange"], more]
            .concat())
    };
    let said = fuse("by_network", &model).stdout;
    assert!(said.contains("units of the scene"), "{said}");
    fuse("by_colour", &[]);
    let image = |folder: &str| run.bytes(&format!("{folder}/images/view_003.png"));
    assert_ne!(image("by_network"), image("by_colour"));
}

#[test]
fn the_frames_of_a_video_take_a_network_as_images_do() {
    let run = Run::new();
    network(&run);
    scene(&run.path("a.png"), 1, "blue");
    let read = |name: &str| ImageFile::read(&run.path(name)).unwrap().bytes().as_raw().to_vec();
    let mut frame = read("a.png");
    let model = ["--depth-model", "net.onnx", "--depth-model-size", SIDE];
    let video_of = |frame: &[u8], ask: &[&str]| {
        let ask = [&["video", "-", "-o", "-", "--raw", "96x64"], ask].concat();
        let mut command = run.command(&ask);
        let mut running =
            command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let frames = [frame, frame].concat();
        running.stdin.take().unwrap().write_all(&frames).unwrap();
        let ended = running.wait_with_output().unwrap();
        let said = String::from_utf8_lossy(&ended.stderr).into_owned();
        assert!(ended.status.success(), "{said}");
        (ended.stdout, said)
    };
    let exchange = ["preset:jerlov-3C", "--model", "exchange"];
    let (by_network, said) = video_of(&frame, &[&exchange[..], &model].concat());
    assert!(said.contains("for the depth of the first frame"), "{said}");
    assert_ne!(by_network, video_of(&frame, &exchange).0);
    run.ok(&[&["fuse", "a.png"], &exchange[..], &["-o", "out.png"], &model].concat());
    assert!(read("out.png")[..] == by_network[..frame.len()]);

    // What surrounds the scene is not smoothed with it.
    let bar = 10 * 3 * 96;
    frame[..bar].iter_mut().enumerate().for_each(|(i, value)| *value = (i % 3) as u8);
    let image = Image::<u8>::from_raw(96, 64, frame.clone()).unwrap();
    ImageFile::new(image).write(&run.path("bar.png"), &WriteOptions::default()).unwrap();
    let smooth = [&exchange[..], &["--smooth", "bilateral", "--border", "10,0,0,0"], &model].concat();
    let (with_bar, _) = video_of(&frame, &smooth);
    run.ok(&[&["fuse", "bar.png"], &smooth[..], &["-o", "smooth.png"]].concat());
    assert!(with_bar[..bar] == frame[..bar] && read("smooth.png")[..] == with_bar[..frame.len()]);

    // Levels are set without depth.
    let (enhanced, said) = video_of(&frame, &[&["--enhance"], &model[..]].concat());
    assert!(enhanced == video_of(&frame, &["--enhance"]).0 && !said.contains("network"), "{said}");

    let ask = ["video", "in.y4m", "preset:jerlov-3C", "-o", "out.mp4", "--depth-model-seconds", "9"];
    assert!(run.fails(2, &ask).stderr.contains("--depth-model FILE.onnx"));
}

#[test]
fn one_water_is_refused_before_a_network_reads_the_reference() {
    let run = Run::new();
    network(&run);
    // No image: it would be refused first, if it were read.
    std::fs::write(run.path("water.png"), b"no image").unwrap();
    let ask =
        ["video", "-", "water.png", "-o", "-", "--raw", "96x64", "--one-water", "--depth-model", "net.onnx"];
    let said = run.fails(2, &ask).stderr;
    assert!(said.contains("--one-water pools waters at depth from colour"), "{said}");
    assert!(run.fails(1, &ask[..7]).stderr.contains("water.png"));
}

#[test]
fn the_memory_of_a_network_counts_in_a_video() {
    let run = Run::new();
    network(&run);
    let ask = ["video", "-", "preset:jerlov-3C", "-o", "-", "--raw", "96x64", "--max-memory", "64MiB"];
    let said = |more: &[&str]| run.fails(1, &[&ask[..], more].concat()).stderr;
    let (by_colour, by_network) = (said(&[]), said(&["--depth-model", "net.onnx"]));
    assert!(!by_colour.contains("--max-memory") && by_network.contains("--max-memory"), "{by_network}");
}

#[test]
fn the_images_of_a_sequence_take_a_network() {
    let run = Run::new();
    network(&run);
    scenes_folder(&run.path("frames"));
    let model = ["--depth-model", "net.onnx", "--depth-model-size", SIDE];
    run.ok(&[&["fuse", "frames", "preset:jerlov-3C", "-o", "out", "--sequence"][..], &model].concat());
    assert!(run.path("out/a.png").is_file());
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
