//! What surrounds a scene: every command leaves it as it is, and the scene comes out as without it.

use aquafuse::image::{Image, Sample};
use aquafuse::scene_area::{Border, Margins, SceneArea};
use aquafuse::truth::{Scene, Size, waters};
use aquafuse_data::image_file::{ImageFile, Pixels, WriteOptions};
use serde_json::Value;

use super::run::{Run, scene};

const MARGINS: Margins = Margins { top: 9, right: 0, bottom: 12, left: 5 };

/// An image in bars of one value.
fn in_bars<T: Sample>(scene: &Image<T>, value: T) -> (Image<T>, SceneArea) {
    let (width, height) = (scene.width() + MARGINS.left, scene.height() + MARGINS.top + MARGINS.bottom);
    let mut image = Image::from_raw(width, height, vec![value; 3 * width * height]).unwrap();
    let area = SceneArea::of(&image, Border::Given(MARGINS)).unwrap();
    area.put_back(scene, &mut image).unwrap();
    (image, area)
}

fn content() -> Image<u16> {
    Scene::new(1, Size { width: 96, height: 64 }).seen_through(&waters()[0].water).convert()
}

fn write(run: &Run, name: &str, pixels: impl Into<Pixels>) {
    ImageFile::new(pixels).write(&run.path(name), &WriteOptions::default()).unwrap();
}

fn read(run: &Run, name: &str) -> Image<u16> {
    match ImageFile::read(&run.path(name)).unwrap().pixels {
        Pixels::Words(layers) => layers.image,
        other => other.into_bytes().convert(),
    }
}

/// A bare image and the same in bars, of 16 bits or of 8, and a water.
fn images(run: &Run, is_fine: bool) -> SceneArea {
    let bare = content();
    let (bars, area) = in_bars(&bare, 16 * 257);
    match is_fine {
        true => {
            write(run, "bare.png", bare);
            write(run, "bars.png", bars);
        }
        false => {
            write(run, "bare.png", bare.convert::<u8>());
            write(run, "bars.png", bars.convert::<u8>());
        }
    }
    scene(&run.path("water.png"), 2, "green");
    area
}

#[test]
fn a_scene_in_bars_comes_out_as_the_bare_one_and_the_bars_as_they_were() {
    for is_fine in [false, true] {
        let run = Run::new();
        let area = images(&run, is_fine);
        for words in [
            "fuse IN water.png --model physical",
            "fuse IN water.png --model exchange --smooth bilateral",
            "fuse IN water.png --model physical --linear",
            "restore IN",
            "enhance IN",
        ] {
            let made = |name: &str| {
                let mut words: Vec<&str> = words.split(' ').collect();
                words[1] = name;
                run.ok(&[&words[..], &["-o", "out.png", "--overwrite"]].concat());
                read(&run, "out.png")
            };
            let (bare, bars) = (made("bare.png"), made("bars.png"));
            let mut expected = read(&run, "bars.png");
            area.put_back(&bare, &mut expected).unwrap();
            assert!(bars == expected, "{words}");
        }
    }
}

#[test]
fn a_border_is_reported_and_can_be_given_or_refused() {
    let run = Run::new();
    images(&run, false);
    let inspect = |more: &[&str]| -> Value {
        let ended = run.ok(&[&["inspect", "bars.png", "--json"], more].concat());
        serde_json::from_str(&ended.stdout).unwrap()
    };
    let (auto, given) = (inspect(&[]), inspect(&["--border", "9,0,12,5"]));
    assert_eq!(auto, given);
    assert_eq!((auto["border"]["top"].as_u64(), auto["border"]["left"].as_u64()), (Some(9), Some(5)));
    assert_eq!(
        (auto["image"]["height"].as_u64(), auto["border"]["outline"].as_bool()),
        (Some(85), Some(false))
    );
    assert!(inspect(&["--border", "none"])["border"].is_null());
    assert!(run.ok(&["inspect", "bars.png"]).stdout.contains("9,0,12,5 pixels"));
    let fuse = ["fuse", "bars.png", "water.png", "-o", "out.png"];
    let json: Value = serde_json::from_str(&run.ok(&[&fuse[..], &["--json"]].concat()).stdout).unwrap();
    assert_eq!(json["border"]["bottom"].as_u64(), Some(12));

    let refused = run.fails(2, &[&fuse[..], &["--border", "9,0"]].concat());
    assert!(refused.stderr.contains("TOP,RIGHT,BOTTOM,LEFT"), "{}", refused.stderr);
    let refused = run.fails(1, &[&fuse[..], &["--border", "80,0,5,0", "--overwrite"]].concat());
    assert!(refused.stderr.contains("bars.png: a border of 80,0,5,0"), "{}", refused.stderr);
    let refused = run.fails(2, &[&fuse[..], &["--border", "none", "--as-published"]].concat());
    assert!(refused.stderr.contains("--as-published"), "{}", refused.stderr);
}

#[test]
fn supplied_depth_and_maps_are_those_of_the_whole_image() {
    let run = Run::new();
    let area = images(&run, false);
    let distances = Scene::new(1, Size { width: 96, height: 64 }).depth.distances();
    let pfm = |name: &str, (width, height): (usize, usize), values: &[f32]| {
        let rows: Vec<u8> = values.chunks(width).rev().flatten().flat_map(|z| z.to_le_bytes()).collect();
        let header = format!("Pf {width} {height} -1\n");
        std::fs::write(run.path(name), [header.as_bytes(), &rows].concat()).unwrap();
    };
    pfm("bare.pfm", (96, 64), &distances);
    pfm("bars.pfm", area.image_size(), &area.spread(&distances, &0.0));
    for (image, map, out) in
        [("bare.png", "bare.pfm", "bare_out.png"), ("bars.png", "bars.pfm", "bars_out.png")]
    {
        let depth = ["--depth", map, "--depth-kind", "metres", "--maps", "maps"];
        run.ok(&[&["fuse", image, "water.png", "-o", out, "--model", "physical"], &depth[..]].concat());
    }
    let mut expected = read(&run, "bars.png");
    area.put_back(&read(&run, "bare_out.png"), &mut expected).unwrap();
    assert!(read(&run, "bars_out.png") == expected);
    for (map, outside) in [("backscatter", 0), ("illumination", 0), ("change", 128)] {
        let mut expected = Image::<u16>::from_raw(101, 85, vec![outside * 257; 3 * 101 * 85]).unwrap();
        area.put_back(&read(&run, &format!("maps/bare.{map}.png")), &mut expected).unwrap();
        assert!(read(&run, &format!("maps/bars.{map}.png")) == expected, "{map}");
    }
    assert_eq!(image::image_dimensions(run.path("maps/bars.depth.png")).unwrap(), (101, 85));
}

#[test]
fn augment_leaves_borders_as_they_are_and_replays_them() {
    let run = Run::new();
    let area = images(&run, false);
    std::fs::create_dir(run.path("set")).unwrap();
    for name in ["bare.png", "bars.png"] {
        std::fs::rename(run.path(name), run.path("set").join(name)).unwrap();
    }
    run.ok(&["augment", "set", "water.png", "-o", "out", "--model", "physical"]);
    let variant = |stem: &str| {
        let named = |path: &std::path::PathBuf| {
            path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(stem))
        };
        let entries = std::fs::read_dir(run.path("out")).unwrap().map(|entry| entry.unwrap().path());
        let path =
            entries.filter(named).find(|path| path.extension().is_some_and(|end| end == "png")).unwrap();
        ImageFile::read(&path).unwrap().pixels.into_bytes()
    };
    let mut expected = read(&run, "set/bars.png").convert::<u8>();
    area.put_back(&variant("bare"), &mut expected).unwrap();
    assert!(variant("bars") == expected);
    run.ok(&["replay", "out/manifest.jsonl", "-o", "again"]);
}
