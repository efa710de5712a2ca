//! The commands that make the paper's figures: restore, enhance, crossover, water, simulate, sweeps and maps.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

mod run;

use aquafuse::image::{Encoding, Linear};
use aquafuse::metrics::psnr;
use aquafuse::truth::{Gaze, Scene, Site, Size, View, waters};
use aquafuse_data::depth_file;
use aquafuse_data::image_file::{ImageFile, WriteOptions};
use run::{Run, scene, scenes_folder};
use serde_json::Value;

fn read(run: &Run, name: &str) -> ImageFile {
    ImageFile::read(&run.path(name)).unwrap()
}

/// A truth scene's clear image, the image in a water, and its depth in metres, as files.
fn truth(run: &Run) -> (Scene, aquafuse::waterbody::Waterbody) {
    let scene = Scene::new(4, Size { width: 96, height: 64 });
    let water = waters()[1].water;
    let write = |name: &str, image: aquafuse::image::Image<f32>| {
        ImageFile::new(image.convert::<u8>()).write(&run.path(name), &WriteOptions::default()).unwrap();
    };
    write("seen.png", scene.seen_through(&water));
    write("clear.png", scene.clear.clone());
    depth_file::write(&run.path("z.tiff"), &scene.depth, &WriteOptions::default()).unwrap();
    (scene, water)
}

#[test]
fn restore_comes_nearer_to_the_clear_image() {
    let run = Run::new();
    truth(&run);
    let restore = ["restore", "seen.png", "--depth", "z.tiff", "--depth-kind", "metres", "--max-gain", "8"];
    let alone = ["-o", "air.png", "--white", "none", "--exposure", "none"];
    let said = run.ok(&[&restore[..], &alone].concat());
    assert!(said.stdout.contains("air.png: written"), "{}", said.stdout);
    let (clear, seen, air) = (read(&run, "clear.png"), read(&run, "seen.png"), read(&run, "air.png"));
    let to_clear = |image_file: &ImageFile| psnr(&clear.bytes(), &image_file.bytes()).unwrap();
    assert!(to_clear(&air) > to_clear(&seen) + 1.0, "{} against {}", to_clear(&air), to_clear(&seen));
    // At no strength it is the image as it was, and by default its levels are set besides.
    run.ok(&[&restore[..], &["-o", "none.png", "--strength", "0"]].concat());
    assert_eq!(read(&run, "none.png").bytes(), seen.bytes());
    let json = run.ok(&[&restore[..], &["-o", "levelled.png", "--json"]].concat()).stdout;
    let record: Value = serde_json::from_str(&json).unwrap();
    assert!(record["levels"]["gain"][0].as_f64().unwrap() > 0.0, "{json}");
    assert_ne!(read(&run, "levelled.png").bytes(), air.bytes());
}

#[test]
fn a_folder_is_restored_and_goes_on_where_it_was() {
    let run = Run::new();
    scenes_folder(&run.path("photos"));
    run.ok(&["restore", "photos", "-o", "air"]);
    let again = run.ok(&["restore", "photos", "-o", "air"]).stdout;
    assert!(again.contains("3 images skipped"), "{again}");
    let other = run.fails(2, &["restore", "photos", "-o", "air", "--max-gain", "3"]).stderr;
    assert!(other.contains("air") && other.contains("settings"), "{other}");
    run.fails(2, &["restore", "photos", "-o", "air", "--max-gain", "0.5"]);
}

#[test]
fn enhance_scores_before_and_after() {
    let run = Run::new();
    scene(&run.path("reef.png"), 1, "green");
    let said = run.ok(&["enhance", "reef.png", "-o", "clearer.png"]).stdout;
    for word in ["UCIQE", "UIQM", "contrast", "sharpness", "before"] {
        assert!(said.contains(word), "{word} in {said}");
    }
    assert!(!said.contains("estimate"), "nothing is estimated: {said}");
    let json = run.ok(&["enhance", "reef.png", "-o", "b.png", "--json"]).stdout;
    let record: Value = serde_json::from_str(&json).unwrap();
    let score = |when: &str| record["scores"][when]["contrast"].as_f64().unwrap();
    assert!(score("after") > score("before"), "{json}");
}

#[test]
fn with_clear_water_enhance_keeps_the_lightness() {
    let run = Run::new();
    scene(&run.path("reef.png"), 1, "green");
    let said = run.ok(&["enhance", "reef.png", "preset:jerlov-I", "-o", "clearer.png"]).stdout;
    assert!(said.contains("preset:jerlov-I") && said.contains("estimate"), "{said}");
    let light = |name: &str| aquafuse::levels::lightness(&*read(&run, name).bytes());
    assert!((light("clearer.png") - light("reef.png")).abs() < 0.02, "{}", light("clearer.png"));
    // What only one of the two ways reads is refused by the other.
    for more in [&["--linear"][..], &["--theta", "20"], &["--maps", "m"], &["--depth-model", "ratio"]] {
        let refused = run.fails(2, &[&["enhance", "reef.png", "-o", "b.png"], more].concat()).stderr;
        assert!(refused.contains("CLEAR"), "{refused}");
    }
    let clear = ["enhance", "reef.png", "preset:jerlov-I", "-o", "b.png"];
    let refused = run.fails(2, &[&clear[..], &["--strength", "0.5"]].concat()).stderr;
    assert!(refused.contains("--strength"), "{refused}");
}

#[test]
fn crossover_makes_one_of_each() {
    let run = Run::new();
    scene(&run.path("a.png"), 1, "blue");
    scene(&run.path("b.png"), 2, "green");
    run.ok(&["crossover", "a.png", "b.png", "-o", "x", "--model", "physical"]);
    run.ok(&["fuse", "a.png", "b.png", "-o", "fused.png", "--model", "physical"]);
    assert_eq!(read(&run, "x/a__b.png").bytes(), read(&run, "fused.png").bytes());
    assert!(run.path("x/b__a.png").exists());
    let refused = run.fails(2, &["crossover", "a.png", "b.png", "-o", "x"]).stderr;
    assert!(refused.contains("a__b.png") && refused.contains("--overwrite"), "{refused}");
    run.fails(2, &["crossover", "a.png", "x/../a.png", "-o", "y"]);
}

#[test]
fn a_water_in_a_file_fuses_as_its_image_does() {
    let run = Run::new();
    scene(&run.path("a.png"), 1, "blue");
    scene(&run.path("b.png"), 2, "green");
    for more in [&["--model", "exchange"][..], &["--model", "physical", "--linear"]] {
        let linear = if more.contains(&"--linear") { &["--linear", "--overwrite"][..] } else { &[] };
        run.ok(&[&["water", "extract", "b.png", "-o", "b.water.json"], linear].concat());
        run.ok(&[&["fuse", "a.png", "b.png", "-o", "picture.png", "--overwrite"], more].concat());
        run.ok(&[&["fuse", "a.png", "b.water.json", "-o", "file.png", "--overwrite"], more].concat());
        assert_eq!(run.bytes("picture.png"), run.bytes("file.png"), "{more:?}");
    }
    let other = run.fails(2, &["fuse", "a.png", "b.water.json", "-o", "c.png"]).stderr;
    assert!(other.contains("b.water.json") && other.contains("--linear"), "{other}");
    std::fs::write(run.path("bad.water.json"), "{\"schema\": 1}").unwrap();
    let bad = run.fails(1, &["fuse", "a.png", "bad.water.json", "-o", "c.png"]).stderr;
    assert!(bad.contains("bad.water.json is no water") && bad.contains("water extract"), "{bad}");
}

#[test]
fn several_images_tell_one_water() {
    let run = Run::new();
    for (seed, name) in ["a.png", "b.png", "c.png"].iter().enumerate() {
        scene(&run.path(name), seed as u64, "green");
    }
    run.ok(&["water", "extract", "a.png", "b.png", "c.png", "-o", "w.water.json"]);
    let shown = run.ok(&["water", "show", "w.water.json"]).stdout;
    assert!(shown.contains("a.png, b.png, c.png") && shown.contains("relative"), "{shown}");
    let refused = run.fails(2, &["water", "extract", "a.png", "-o", "w.json"]).stderr;
    assert!(refused.contains(".water.json"), "{refused}");
}

#[test]
fn presets_are_listed_shown_and_fused_with() {
    let run = Run::new();
    let list = run.ok(&["water", "list"]).stdout;
    assert_eq!(list.lines().filter(|line| line.starts_with("preset:jerlov-")).count(), 10, "{list}");
    let shown = run.ok(&["water", "show", "preset:jerlov-3C"]).stdout;
    assert!(shown.contains("absorption a") && shown.contains("metre"), "{shown}");
    let json: Value =
        serde_json::from_str(&run.ok(&["water", "show", "preset:jerlov-3C", "--json"]).stdout).unwrap();
    assert!(json["assumptions"]["spectra"][0]["source"].is_string());
    scene(&run.path("a.png"), 1, "blue");
    run.ok(&["fuse", "a.png", "preset:jerlov-3c", "-o", "coast.png", "--model", "physical"]);
    let no_such = run.fails(2, &["fuse", "a.png", "preset:bath", "-o", "b.png"]).stderr;
    assert!(no_such.contains("bath") && no_such.contains("jerlov-IA"), "{no_such}");
}

#[test]
fn simulate_is_the_formation_model() {
    let run = Run::new();
    let (scene, _) = truth(&run);
    let dive =
        ["simulate", "clear.png", "z.tiff", "preset:jerlov-II", "-o", "dived.png", "--depth-kind", "metres"];
    run.ok(&[&dive[..], &["--keep-light"]].concat());
    let water = aquafuse::waterbody::presets::Preset::II.water(&Default::default());
    let clear = read(&run, "clear.png");
    let expected = aquafuse::formation::form(&clear.bytes(), &scene.depth, &water).unwrap().convert::<u8>();
    assert_eq!(read(&run, "dived.png").bytes().pixels(), expected.pixels());
    let refused = run.fails(2, &dive).stderr;
    assert!(refused.contains("dived.png") && refused.contains("--overwrite"), "{refused}");
    run.ok(&[&dive[..], &["--overwrite", "--linear", "--below-surface", "12"]].concat());
    assert_ne!(read(&run, "dived.png").bytes().pixels(), expected.pixels());
}

#[test]
fn a_sweep_is_one_strip() {
    let run = Run::new();
    scene(&run.path("a.png"), 1, "blue");
    scene(&run.path("b.png"), 2, "green");
    run.ok(&["fuse", "a.png", "b.png", "-o", "strip.png", "--sweep", "theta=0,45,90"]);
    let (width, height) = read(&run, "strip.png").pixels.size();
    assert!(width > 4 * 400 && height < 400, "{width}x{height}");
    run.fails(2, &["fuse", "a.png", "b.png", "-o", "t.png", "--sweep", "theta=0,100"]);
    run.fails(2, &["fuse", "a.png", "b.png", "-o", "t.png", "--sweep", "gain=1"]);
}

#[test]
fn maps_and_a_report_come_with_a_folder() {
    let run = Run::new();
    scenes_folder(&run.path("photos"));
    scene(&run.path("w.png"), 2, "green");
    let fuse = ["fuse", "photos", "w.png", "-o", "out", "--maps", "maps", "--report", "out/report.json"];
    run.ok(&fuse);
    for stem in ["a", "b", "c"] {
        for map in ["depth.png", "backscatter.png", "illumination.png", "change.png", "factor.npy"] {
            assert!(run.path(&format!("maps/{stem}.{map}")).exists());
        }
    }
    let report: Value = serde_json::from_slice(&run.bytes("out/report.json")).unwrap();
    assert_eq!(report["settings"]["model"], "physical");
    assert_eq!(report["pictures"].as_array().unwrap().len(), 3);
    assert!(report["pictures"][0]["waterbody"]["veiling_light"][2].as_f64().unwrap() > 0.0);
    let refused = run.fails(2, &["fuse", "photos", "w.png", "-o", "new", "--maps", "maps"]).stderr;
    assert!(refused.contains("a.depth.png"), "{refused}");
    let refused = run.fails(2, &fuse).stderr;
    assert!(refused.contains("report.json"), "{refused}");
    run.ok(&["restore", "photos", "-o", "air", "--maps", "air_maps"]);
    assert!(run.path("air_maps/a.change.png").exists() && !run.path("air_maps/a.factor.npy").exists());
}

/// The values of an array of 32-bit floats of this shape, as NumPy would load them.
fn array(run: &Run, name: &str, shape: &str) -> Vec<[f32; 3]> {
    let bytes = run.bytes(name);
    let header = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({shape}), }}");
    assert_eq!((&bytes[..8], &bytes[8..10]), (&b"\x93NUMPY\x01\0"[..], &118_u16.to_le_bytes()[..]), "{name}");
    assert_eq!(String::from_utf8_lossy(&bytes[10..128]).trim_end(), header, "{name}");
    let values: Vec<f32> =
        bytes[128..].as_chunks().0.iter().map(|&value| f32::from_le_bytes(value)).collect();
    values.as_chunks().0.to_vec()
}

fn three(value: &Value) -> [f64; 3] {
    [0, 1, 2].map(|c| value[c].as_f64().unwrap())
}

#[test]
fn from_its_files_alone_a_fusion_is_its_closed_form() {
    let run = Run::new();
    scene(&run.path("blue.png"), 1, "blue");
    // In these red is held back: in the table of F, and in β_B.
    for (name, gaze) in [("harbour.png", Gaze::Ahead), ("mud.png", Gaze::Down)] {
        let harbour = Scene::of(View { site: Site::Harbour, gaze }, 2, Size { width: 96, height: 64 });
        let image = harbour.seen_through(&waters()[0].water).convert::<u8>();
        ImageFile::new(image).write(&run.path(name), &WriteOptions::default()).unwrap();
    }
    scene(&run.path("w.png"), 2, "green");
    depth_file::write(
        &run.path("z.tiff"),
        &Scene::new(1, Size { width: 96, height: 64 }).depth,
        &WriteOptions::default(),
    )
    .unwrap();
    let depth = ["--depth", "z.tiff", "--depth-kind", "metres"];
    let (theta, alpha) = (30.0_f64, 1.25);
    let (mut open_water, mut held_red) = (0, 0);
    for (content, model, more) in [
        ("blue.png", "physical", &[][..]),
        ("blue.png", "physical", &["--linear"]),
        ("blue.png", "physical", &depth),
        ("harbour.png", "physical", &[]),
        ("mud.png", "physical", &[]),
        ("blue.png", "aquafuse", &[]),
    ] {
        let fuse =
            ["fuse", content, "w.png", "-o", "out.png", "--overwrite", "--maps", "maps", "--model", model];
        let set = ["--theta", "30", "--alpha", "1.25", "--report", "report.json"];
        run.ok(&[&fuse[..], &set, more].concat());
        let report: Value = serde_json::from_slice(&run.bytes("report.json")).unwrap();
        let about = &report["pictures"][0];
        assert_eq!(about["held_back"]["glare"], false, "the veil of w.png is used as it is");
        held_red += usize::from(about["held_back"]["red"] == true);
        let own = three(&about["waterbody"]["veiling_light"]);
        let other = three(&report["settings"]["waterbody"]["veiling_light"]);
        let stem = content.trim_end_matches(".png");
        let factors = array(&run, &format!("maps/{stem}.factor.npy"), "64, 96, 3");
        open_water += factors.iter().filter(|factor| factor.iter().all(|&f| f < 0.05)).count();
        let [before, after] = [content, "out.png"].map(|name| read(&run, name).bytes().into_owned());
        let is_linear = more == ["--linear"];
        for (i, (before, after)) in before.pixels().iter().zip(after.pixels()).enumerate() {
            for c in 0..3 {
                let factor = f64::from(factors[i][c]);
                let weight = if model == "physical" { 1.0 - factor } else { factor * (1.0 - factor) };
                let shift = theta.to_radians().cos() * weight * (alpha * other[c] - own[c]);
                let value = f32::from(before[c]) / 255.0;
                let expected = if is_linear {
                    Linear::to_encoded((f64::from(Linear::from_encoded(value)) + shift).clamp(0.0, 1.0) as f32)
                } else {
                    (f64::from(value) + shift).clamp(0.0, 1.0) as f32
                };
                let off = (255.0 * expected - f32::from(after[c])).abs();
                assert!(off <= 1.0, "{content} {model} {more:?}: pixel {i}, channel {c} is {off} steps off");
            }
        }
    }
    assert!(held_red > 0, "a safety bound acts on F");
    assert!(open_water > 500, "open water is in view: {open_water} pixels");
}

#[test]
fn shells_and_man_are_told() {
    let run = Run::new();
    for shell in ["bash", "zsh", "fish"] {
        let script = run.ok(&["completions", shell]).stdout;
        assert!(script.contains("crossover") && script.contains("theta"), "{shell}");
    }
    run.ok(&["man", "-o", "man1"]);
    let page = String::from_utf8(run.bytes("man1/aquafuse-fuse.1")).unwrap();
    assert!(page.contains("theta") && page.contains(".TH aquafuse-fuse 1"), "{}", &page[..200]);
    assert!(run.path("man1/aquafuse-water-extract.1").exists());
    run.fails(2, &["man", "-o", "man1"]);
}
