//! Depth that comes with an image, as a user runs the command.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

mod run;

use std::path::{Path, PathBuf};

use aquafuse::depth::{DepthKind, DepthMap, SuppliedKind};
use aquafuse::image::Image;
use aquafuse::truth::{Scene, Size};
use aquafuse_data::depth_file;
use aquafuse_data::image_file::{ImageFile, WriteOptions};
use aquafuse_data::pairs::list;
use aquafuse_data::water_file::Numbers;
use run::{Run, scene};
use serde_json::Value;

/// Measured depth of the image that `scene` makes of this seed, nothing beyond 30 m.
fn depth_of_scene(path: &Path, seed: u64) {
    let z = Scene::new(seed, Size { width: 96, height: 64 }).depth;
    let measured = z.distances().into_iter().map(|z| if z > 30.0 { 0.0 } else { z }).collect();
    let z = DepthMap::from_distances(96, 64, DepthKind::Metres, measured).unwrap();
    depth_file::write(path, &z, &WriteOptions::default()).unwrap();
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

#[test]
fn supplied_depth_is_used_and_reported() {
    let run = Run::new();
    scene(&run.path("content.png"), 1, "blue");
    scene(&run.path("water.png"), 2, "green");
    for (name, kind) in
        [("z.tiff", "metres"), ("z.png", "millimetres"), ("z.exr", "metres"), ("z.npy", "metres")]
    {
        depth_of_scene(&run.path(name), 1);
        let with = ["--depth", name, "--depth-kind", kind];
        let report = json(&run.ok(&[&["inspect", "content.png", "--json"][..], &with].concat()).stdout);
        let depth = &report["depth"];
        assert_eq!((&depth["source"], &depth["kind"]), (&"supplied".into(), &"metres".into()), "{name}");
        let supplied = &depth["supplied"];
        assert_eq!((&supplied["file"], &supplied["kind"]), (&name.into(), &kind.into()));
        assert!(
            supplied["invalid_share"].as_f64().unwrap() > 0.05
                && supplied["warnings"] == serde_json::json!([])
        );
        let fuse = ["fuse", "content.png", "water.png", "-o", "out.png", "--overwrite"];
        let said = run.ok(&[&fuse[..], &with, &["-v"]].concat()).stdout;
        assert!(said.contains("pixels without a valid depth"), "{said}");
        let with_depth = run.bytes("out.png");
        run.ok(&fuse);
        assert_ne!(with_depth, run.bytes("out.png"), "{name} made no difference");
    }
}

#[test]
fn a_map_of_another_size_is_scaled_on_request_if_it_shows_the_whole_image() {
    let run = Run::new();
    scene(&run.path("a.png"), 5, "green");
    let z = Scene::new(5, Size { width: 96, height: 64 }).depth;
    let half = |width: usize, height: usize| {
        let values = z.distances();
        let at = |x: usize, y: usize| values[2 * y * 96 + 2 * x];
        let known =
            (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| at(x, y)).collect();
        DepthMap::from_distances(width, height, DepthKind::Metres, known).unwrap()
    };
    depth_file::write(&run.path("half.npy"), &half(48, 32), &WriteOptions::default()).unwrap();
    depth_file::write(&run.path("part.npy"), &half(48, 24), &WriteOptions::default()).unwrap();
    let inspect = ["inspect", "a.png", "--json", "--depth-kind", "metres", "--depth"];
    let said = run.fails(1, &[&inspect[..], &["half.npy"]].concat()).stderr;
    assert!(said.contains("--depth-resize"), "{said}");
    let said = run.fails(1, &[&inspect[..], &["part.npy", "--depth-resize"]].concat()).stderr;
    assert!(said.contains("part.npy") && said.contains("48x24"), "{said}");
    let scaled = json(&run.ok(&[&inspect[..], &["half.npy", "--depth-resize"]].concat()).stdout);
    depth_file::write(&run.path("whole.npy"), &z, &WriteOptions::default()).unwrap();
    let whole = json(&run.ok(&[&inspect[..], &["whole.npy"]].concat()).stdout);
    let far = |report: &Value| report["depth"]["p95"].as_f64().unwrap();
    assert!((far(&scaled) - far(&whole)).abs() < 0.1 * far(&whole), "{} {}", far(&scaled), far(&whole));
    // A map of the image's own size is the same with it and without.
    assert_eq!(json(&run.ok(&[&inspect[..], &["whole.npy", "--depth-resize"]].concat()).stdout), whole);
}

#[test]
fn maps_of_colmap_belong_to_the_images_that_they_are_called_after() {
    let run = Run::new();
    for folder in ["photos", "depth_maps"] {
        std::fs::create_dir(run.path(folder)).unwrap();
    }
    scene(&run.path("photos/a.jpg"), 5, "green");
    let z = Scene::new(5, Size { width: 96, height: 64 }).depth;
    depth_file::write(&run.path("z.npy"), &z, &WriteOptions::default()).unwrap();
    let floats: Vec<u8> = z.distances().into_iter().flat_map(f32::to_le_bytes).collect();
    let map = [&b"96&64&1&"[..], &floats].concat();
    std::fs::write(run.path("depth_maps/a.jpg.geometric.bin"), &map).unwrap();
    std::fs::write(run.path("depth_maps/a.jpg.photometric.bin"), &map).unwrap();
    let kind = ["--depth-kind", "metres", "--depth"];
    run.ok(&[&["restore", "photos", "-o", "out"][..], &kind, &["depth_maps"]].concat());
    run.ok(&[&["restore", "photos/a.jpg", "-o", "one.jpg"][..], &kind, &["z.npy"]].concat());
    assert_eq!(run.bytes("out/a.jpg"), run.bytes("one.jpg"));
    for (bytes, cause) in [
        ([&b"96&64&3&"[..], &floats].concat(), "3 channels"),
        (map[..400].to_vec(), "it ends too early"),
        (b"99999999999&1&1&".to_vec(), "no depth map"),
        (b"96&x&1&".to_vec(), "header"),
        (b"96&64&".to_vec(), "header"),
    ] {
        std::fs::write(run.path("bad.bin"), bytes).unwrap();
        let restore = ["restore", "photos/a.jpg", "-o", "bad.jpg"];
        let said = run.fails(1, &[&restore[..], &kind, &["bad.bin"]].concat()).stderr;
        assert!(said.contains("bad.bin") && said.contains(cause), "{said}");
    }
}

#[test]
fn metres_taken_for_millimetres_are_doubted() {
    let run = Run::new();
    scene(&run.path("content.png"), 1, "blue");
    depth_of_scene(&run.path("z.tiff"), 1);
    let fuse = |kind: &str| {
        let depth = ["--depth", "z.tiff", "--depth-kind", kind, "--overwrite"];
        run.ok(&[&["fuse", "content.png", "preset:jerlov-3C", "-o", "out.png"][..], &depth].concat()).stdout
    };
    assert!(!fuse("metres").contains("thicker than any"));
    let said = fuse("millimetres");
    assert!(
        said.contains("WARNING: content.png: by its depth map the water is thicker than any; check that the values are millimetres"),
        "{said}"
    );
}

#[test]
fn a_folder_takes_its_depth_from_a_folder() {
    let run = Run::new();
    run::scenes_folder(&run.path("photos"));
    scene(&run.path("water.png"), 9, "turbid");
    std::fs::create_dir(run.path("depth")).unwrap();
    for (seed, name) in ["a.tiff", "b.npy", "c.png"].iter().enumerate() {
        depth_of_scene(&run.path("depth").join(name), seed as u64);
    }
    let fuse = ["fuse", "photos", "water.png", "-o", "out", "--depth", "depth", "--depth-kind", "metres"];
    run.ok(&fuse);
    std::fs::remove_file(run.path("depth/b.npy")).unwrap();
    let refused = run.fails(2, &[&fuse[..], &["--overwrite"]].concat()).stderr;
    assert!(
        refused.contains("holds 0 depth maps with the stem of") && refused.contains("b.png"),
        "{refused}"
    );
    let one =
        ["fuse", "photos", "water.png", "-o", "o2", "--depth", "depth/a.tiff", "--depth-kind", "metres"];
    assert!(run.fails(2, &one).stderr.contains("must be a folder too"));
}

#[test]
fn wrong_declarations_are_refused_with_what_to_do() {
    let run = Run::new();
    scene(&run.path("content.png"), 1, "blue");
    depth_of_scene(&run.path("z.tiff"), 1);
    let other = DepthMap::from_levels(64, 96, vec![9; 64 * 96]).unwrap();
    depth_file::write(&run.path("turned.npy"), &other, &WriteOptions::default()).unwrap();
    std::fs::write(run.path("text.pfm"), "no depth").unwrap();
    let inspect = |code, arguments: &[&str]| {
        run.fails(code, &[&["inspect", "content.png"][..], arguments].concat()).stderr
    };
    assert!(inspect(2, &["--depth", "z.tiff"]).contains("add --depth-kind metres"));
    assert!(inspect(2, &["--depth-kind", "metres"]).contains("add --depth FILE"));
    assert!(inspect(2, &["--depth", "z.tiff", "--depth-kind", "feet"]).contains("millimetres"));
    assert!(inspect(2, &["--depth", "no.tiff", "--depth-kind", "metres"]).contains("cannot read no.tiff"));
    let both = inspect(2, &["--depth", "z.tiff", "--depth-kind", "metres", "--depth-model", "ratio"]);
    assert!(both.contains("cannot be used with"), "{both}");
    let relative = inspect(1, &["--depth", "z.tiff", "--depth-kind", "relative"]);
    assert!(
        relative.contains("lies between 0 and 1") && relative.contains("declare another kind"),
        "{relative}"
    );
    let turned = inspect(1, &["--depth", "turned.npy", "--depth-kind", "relative"]);
    assert!(turned.contains("64x96, the image 96x64; turned by 90°"), "{turned}");
    assert!(inspect(1, &["--depth", "text.pfm", "--depth-kind", "metres"]).contains("is no depth map"));
    let over = ["fuse", "content.png", "content.png", "-o", "z.png", "--overwrite"];
    depth_of_scene(&run.path("z.png"), 1);
    let over = run.fails(2, &[&over[..], &["--depth", "z.png", "--depth-kind", "millimetres"]].concat());
    assert!(over.stderr.contains("is an input"), "{}", over.stderr);
}

#[test]
fn the_water_of_a_reference_is_estimated_with_its_depth_map() {
    let run = Run::new();
    scene(&run.path("content.png"), 1, "blue");
    scene(&run.path("water.png"), 2, "green");
    depth_of_scene(&run.path("z1.tiff"), 1);
    depth_of_scene(&run.path("z2.tiff"), 2);
    let fuse = ["fuse", "content.png", "water.png", "-o", "out.png", "--model", "exchange", "--overwrite"];
    let own = ["--depth", "z1.tiff", "--depth-kind", "metres"];
    let map = ["--water-depth", "z2.tiff", "--water-depth-kind", "metres"];
    let report = ["--report", "report.json"];
    let said = run.ok(&[&fuse[..], &own, &map, &report].concat()).stdout;
    assert!(!said.contains("WARNING"), "{said}");
    let with_both = run.bytes("out.png");
    let settings = json(&String::from_utf8(run.bytes("report.json")).unwrap())["settings"].clone();
    assert_eq!(settings["water_depth"], serde_json::json!({ "file": "z2.tiff", "kind": "metres" }));

    let extract = ["water", "extract", "water.png", "-o", "w.water.json"];
    run.ok(&[&extract[..], &["--depth", "z2.tiff", "--depth-kind", "metres"]].concat());
    let water = json(&String::from_utf8(run.bytes("w.water.json")).unwrap());
    let numbers = |water: &Value| serde_json::from_value::<Numbers>(water["waterbody"].clone()).unwrap();
    assert_eq!(numbers(&settings), numbers(&water), "per metre, as the content's depth is");
    run.ok(&[&["fuse", "content.png", "w.water.json"][..], &fuse[3..], &own].concat());
    assert_eq!(with_both, run.bytes("out.png"), "a water file of the same depth fuses alike");

    // Of a content in relative depth, the water is converted like any water per metre.
    run.ok(&[&fuse[..], &map, &["--metres-at-one", "20"]].concat());
    let twenty = run.bytes("out.png");
    run.ok(&[&["fuse", "content.png", "w.water.json"][..], &fuse[3..], &["--metres-at-one", "20"]].concat());
    assert_eq!(twenty, run.bytes("out.png"));

    let said =
        run.ok(&[&fuse[..], &["--water-depth", "z2.tiff", "--water-depth-kind", "disparity"]].concat());
    assert!(said.stdout.contains("z2.tiff looks inverted"), "{}", said.stdout);
    assert!(said.stdout.contains("use --water-depth-kind relative"), "{}", said.stdout);
}

#[test]
fn a_run_with_another_depth_of_the_reference_is_another_run() {
    let run = Run::new();
    run::scenes_folder(&run.path("photos"));
    scene(&run.path("water.png"), 2, "green");
    depth_of_scene(&run.path("z.tiff"), 2);
    let fuse = ["fuse", "photos", "water.png", "-o", "out"];
    let map = ["--water-depth", "z.tiff", "--water-depth-kind", "metres"];
    run.ok(&[&fuse[..], &map].concat());
    assert!(run.ok(&[&fuse[..], &map].concat()).stdout.contains("3 images skipped"));
    let refused = run.fails(2, &fuse).stderr;
    assert!(refused.contains("settings"), "{refused}");
}

#[test]
fn only_an_image_of_water_has_a_depth_map() {
    let run = Run::new();
    scene(&run.path("content.png"), 1, "blue");
    scene(&run.path("water.png"), 2, "green");
    depth_of_scene(&run.path("z.png"), 2);
    run.ok(&["water", "extract", "water.png", "-o", "w.water.json"]);
    let refused = |water: &str, output: &str, more: &[&str]| {
        run.fails(2, &[&["fuse", "content.png", water, "-o", output][..], more].concat()).stderr
    };
    let map = ["--water-depth", "z.png", "--water-depth-kind", "millimetres"];
    let said = refused("preset:jerlov-II", "out.png", &map);
    assert!(said.contains("preset:jerlov-II") && said.contains("leave it out"), "{said}");
    let said = refused("w.water.json", "out.png", &map);
    assert!(said.contains("as --depth to `aquafuse water extract`"), "{said}");
    assert!(refused("water.png", "out.png", &map[..2]).contains("add --water-depth-kind metres"));
    assert!(refused("water.png", "out.png", &map[2..]).contains("add --water-depth FILE"));
    let said = refused("water.png", "out.png", &["--water-depth", "no.png", "--water-depth-kind", "metres"]);
    assert!(said.contains("cannot read no.png"), "{said}");
    let said = refused("water.png", "z.png", &[&map[..], &["--overwrite"]].concat());
    assert!(said.contains("is an input"), "{said}");
    assert!(!run.path("out.png").exists());
}

#[test]
fn an_image_on_its_side_says_that_the_map_must_be_turned_back() {
    let run = Run::new();
    let mut image = ImageFile::new(Image::<u8>::from_raw(8, 4, vec![90; 96]).unwrap());
    // Little-endian EXIF of one entry: orientation 6.
    image.metadata.exif = Some(b"II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0\x06\0\0\0\0\0\0\0".to_vec());
    image.write(&run.path("side.jpg"), &WriteOptions::default()).unwrap();
    let map = DepthMap::from_levels(4, 8, vec![9; 32]).unwrap();
    depth_file::write(&run.path("z.npy"), &map, &WriteOptions::default()).unwrap();
    let said = run.fails(1, &["inspect", "side.jpg", "--depth", "z.npy", "--depth-kind", "relative"]).stderr;
    assert!(said.contains("rotated by its EXIF orientation"), "{said}");
}

/// Real pairs as the command reads them: image, map, what it is.
fn pairs(run: &Run) -> Option<Vec<(PathBuf, PathBuf, bool)>> {
    let Some(data) = std::env::var_os("AQUAFUSE_TEST_DATA").map(PathBuf::from) else {
        eprintln!("skipped: AQUAFUSE_TEST_DATA does not name the folder of real images");
        return None;
    };
    let mut pairs = Vec::new();
    for (folder, measured) in [("depth_pairs", true), ("depth_pairs_estimated", false)] {
        for pair in list(&data.join(folder)).unwrap().pairs {
            // Images in TIFF and maps in JPEG are not read: the same pixels in PNG.
            let mut png = pair.clone();
            if pair.rgb.extension().unwrap() == "tiff" {
                png.rgb = run.path(&format!("{}_rgb.png", pair.name));
                ImageFile::read(&pair.rgb).unwrap().write(&png.rgb, &WriteOptions::default()).unwrap();
            }
            if pair.depth.extension().unwrap() == "jpg" {
                png.depth = run.path(&format!("{}_depth.png", pair.name));
                image::open(&pair.depth).unwrap().into_luma8().save(&png.depth).unwrap();
            }
            pairs.push((png.rgb, png.depth, measured));
        }
    }
    Some(pairs)
}

#[test]
fn real_maps_are_quiet_when_declared_rightly_and_most_are_told_when_not() {
    let run = Run::new();
    let Some(pairs) = pairs(&run) else { return };
    let (mut told, mut falsely, mut agreements) = (0, 0, Vec::new());
    for (image, map, measured) in &pairs {
        let (right, wrong) = if *measured { ("metres", "disparity") } else { ("inverse", "relative") };
        let report = |kind| {
            let (image, map) = (image.to_str().unwrap(), map.to_str().unwrap());
            let said = run.ok(&["inspect", image, "--json", "--depth", map, "--depth-kind", kind]).stdout;
            json(&said)["depth"]["supplied"].clone()
        };
        let warned = |report: &Value| !report["warnings"].as_array().unwrap().is_empty();
        let right = report(right);
        agreements.push(right["agreement"].as_f64().unwrap());
        falsely += usize::from(warned(&right));
        let caught = warned(&report(wrong));
        told += usize::from(caught);
        assert!(caught || !measured, "{} inverted", map.display());
    }
    println!("{told} of {} turned maps told, {falsely} others; agreements {agreements:.2?}", pairs.len());
    assert_eq!((pairs.len(), falsely), (26, 0));
    assert!(told >= 24, "{told}");
}

#[test]
fn open_water_without_measured_depth_is_far_in_real_images() {
    let run = Run::new();
    let Some(pairs) = pairs(&run) else { return };
    for (image, map, measured) in pairs {
        // In the first image the holes are dark rock, and no open water is seen.
        if !measured || map.ends_with("flsea_0000.tif") {
            continue;
        }
        let arguments = ["--depth", map.to_str().unwrap(), "--depth-kind", "metres"];
        let inspect = [&["inspect", image.to_str().unwrap(), "--json"][..], &arguments].concat();
        let report = json(&run.ok(&inspect).stdout);
        let invalid = report["depth"]["supplied"]["invalid_share"].as_f64().unwrap();
        let file = std::io::BufReader::new(std::fs::File::open(&map).unwrap());
        let tiff::decoder::DecodingResult::F32(stored) =
            tiff::decoder::Decoder::new(file).unwrap().read_image().unwrap()
        else {
            panic!("{} is not of floats", map.display())
        };
        let holes = stored.iter().filter(|z| **z == 0.0).count();
        assert!((invalid - holes as f64 / stored.len() as f64).abs() < 1e-12, "{}", map.display());

        let image = ImageFile::read(&image).unwrap();
        let found = depth_file::read(&map, SuppliedKind::Metres).unwrap();
        let z = found.seen_with(&image.bytes(), image.top_edge()).unwrap().depth.distances();
        let mut measured: Vec<f32> = stored.iter().copied().filter(|z| *z > 0.0).collect();
        measured.sort_by(f32::total_cmp);
        let far_end = measured[measured.len() * 98 / 100];
        // The top tenth of these images is open water, with pillars in some.
        let top = &z[..z.len() / 10];
        let open: Vec<f32> = top.iter().zip(&stored).filter(|(_, z)| **z == 0.0).map(|(z, _)| *z).collect();
        let far = open.iter().filter(|z| **z >= far_end).count() as f64 / open.len() as f64;
        println!("{}: {:.1} % of the open water is as far as the far end", map.display(), 100.0 * far);
        assert!(far >= 0.9, "{}: {far}", map.display());
    }
}
