//! Real photographs: enhancement and restoration beside references that people chose, and edges that fusion must not make.
//!
//! Needs the folder `AQUAFUSE_TEST_DATA`. The whole table of pairs is `cargo lab pairs`.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

use std::path::{Path, PathBuf};

use aquafuse::formation::RestoreOptions;
use aquafuse::fusion::{Model, Options};
use aquafuse::image::Image;
use aquafuse::levels::LevelsOptions;
use aquafuse::metrics::{Flicker, psnr};
use aquafuse_data::evaluate::Alone;
use aquafuse_data::image_file::{ImageFile, ReadOptions};
use aquafuse_data::pipeline::{DepthSource, Operation, PixelEncoding, analyse_in};

/// Of one set each so many-th pair, so that it takes seconds.
const SETS: [(&str, usize); 2] = [("uieb", 2), ("lsui", 5)];

fn folder(set: &str) -> Option<PathBuf> {
    let data = std::env::var_os("AQUAFUSE_TEST_DATA").map(PathBuf::from);
    let folder = data.map(|data| data.join("restoration_pairs").join(set)).filter(|folder| folder.is_dir());
    if folder.is_none() {
        eprintln!("skipped: AQUAFUSE_TEST_DATA names no folder with restoration_pairs/{set}");
    }
    folder
}

fn read(path: &Path) -> ImageFile {
    ImageFile::open(path, &ReadOptions::default()).unwrap().decode().unwrap()
}

fn changed(image: &ImageFile, operation: &Operation) -> Image<u8> {
    let analyse = || analyse_in(PixelEncoding::Encoded, image, &DepthSource::default()).unwrap();
    let found = operation.needs_analysis().then(analyse);
    let mut pixels = image.pixels.clone();
    operation.apply(&mut pixels, found.as_ref()).unwrap();
    pixels.into_bytes()
}

/// How steep the lightness is at each pixel after a 3x3 mean, by differences over two pixels.
fn slopes(image: &Image<u8>) -> Vec<f32> {
    let (width, height) = image.size();
    let grey: Vec<f32> = image
        .pixels()
        .iter()
        .map(|&[r, g, b]| 0.299 * f32::from(r) + 0.587 * f32::from(g) + 0.114 * f32::from(b))
        .collect();
    let at = |values: &[f32], x: usize, y: usize| values[y.min(height - 1) * width + x.min(width - 1)];
    let around = |place: usize| [place.saturating_sub(1), place, place + 1];
    let mean = |i: usize| {
        let near = around(i / width).into_iter().flat_map(|y| around(i % width).map(|x| at(&grey, x, y)));
        near.sum::<f32>() / 9.0
    };
    let smooth: Vec<f32> = (0..grey.len()).map(mean).collect();
    let slope = |i: usize| {
        let ([left, x, right], [above, y, below]) = (around(i % width), around(i / width));
        let across = at(&smooth, right, y) - at(&smooth, left, y);
        let down = at(&smooth, x, below) - at(&smooth, x, above);
        0.5 * across.hypot(down)
    };
    (0..grey.len()).map(slope).collect()
}

/// The share of pixels at which there is an edge that the content has not.
fn new_edges(content: &[f32], fused: &[f32]) -> f64 {
    let new =
        content.iter().zip(fused).filter(|(before, after)| **after > 6.0 && **after > 4.0 * **before + 1.5);
    new.count() as f64 / content.len() as f64
}

/// Waters that differ much from most contents.
const WATERS: [&str; 2] = ["greenish_01.jpg", "clear_05.jpg"];

#[test]
fn fusion_makes_no_edges_that_the_content_has_not() {
    let data = std::env::var_os("AQUAFUSE_TEST_DATA").map(|data| PathBuf::from(data).join("scenes"));
    let Some(folder) = data.filter(|folder| folder.is_dir()) else {
        eprintln!("skipped: AQUAFUSE_TEST_DATA names no folder with scenes");
        return;
    };
    let waters = WATERS.map(|name| {
        let image = read(&folder.join(name));
        analyse_in(PixelEncoding::Encoded, &image, &DepthSource::default()).unwrap().estimate
    });
    let mut scenes: Vec<PathBuf> = folder.read_dir().unwrap().map(|entry| entry.unwrap().path()).collect();
    scenes.sort();
    let (mut sum, mut count) = (0.0, 0.0);
    for path in scenes.iter().step_by(2) {
        let image = read(path);
        let found = analyse_in(PixelEncoding::Encoded, &image, &DepthSource::default()).unwrap();
        let before = slopes(&image.bytes());
        for &reference in &waters {
            for model in [Model::Physical, Model::Exchange] {
                let operation = Operation::Fuse { reference, options: Options::for_model(model) };
                let mut pixels = image.pixels.clone();
                operation.apply(&mut pixels, Some(&found)).unwrap();
                let share = new_edges(&before, &slopes(&pixels.into_bytes()));
                assert!(share <= 2e-3, "{}, {model}: new edges in {:.3} %", path.display(), 100.0 * share);
                sum += share;
                count += 1.0;
            }
        }
    }
    println!("new edges in {:.4} % of the pixels, {count} fusions", 100.0 * sum / count);
    assert!(sum / count <= 2e-4, "new edges in {:.4} % of the pixels", 100.0 * sum / count);
}

#[test]
fn single_frames_without_open_water_in_view_change_little_more_than_their_source() {
    let data = std::env::var_os("AQUAFUSE_TEST_DATA").map(PathBuf::from);
    let Some(data) = data.filter(|data| data.join("sequence_subvo_pool/images").is_dir()) else {
        eprintln!("skipped: AQUAFUSE_TEST_DATA names no folder with sequence_subvo_pool");
        return;
    };
    let folder = data.join("sequence_subvo_pool/images");
    let mut frames: Vec<PathBuf> = folder.read_dir().unwrap().map(|entry| entry.unwrap().path()).collect();
    frames.sort();
    let reference = read(&data.join("scenes").join(WATERS[0]));
    let reference = analyse_in(PixelEncoding::Encoded, &reference, &DepthSource::default()).unwrap().estimate;
    for model in [Model::Physical, Model::Relight, Model::Aquafuse] {
        let operation = Operation::Fuse { reference, options: Options::for_model(model) };
        let mut flicker = Flicker::default();
        for path in &frames {
            let image = read(path);
            flicker.add(&*image.bytes(), &changed(&image, &operation)).unwrap();
        }
        let ratio = flicker.ratio().unwrap();
        assert!(ratio <= 1.6, "{model}: {ratio:.2} times as much");
    }
}

/// The share of pixels in which red newly leads by more than 20 levels.
fn newly_red(before: &Image<u8>, after: &Image<u8>) -> f64 {
    let leads = |&[red, green, blue]: &[u8; 3]| i32::from(red) - i32::from(green.max(blue)) > 20;
    let both = before.pixels().iter().zip(after.pixels());
    let newly = both.filter(|(before, after)| leads(after) && !leads(before)).count();
    newly as f64 / before.pixels().len() as f64
}

#[test]
fn enhance_and_restore_come_nearer_to_what_people_chose_than_a_stretch() {
    let levels = LevelsOptions::default();
    let enhance = Operation::Enhance { levels };
    let restore =
        Operation::Restore { options: RestoreOptions::default(), levels, encoding: PixelEncoding::Encoded };
    for (set, each) in SETS {
        let Some(folder) = folder(set) else { return };
        let mut raw: Vec<PathBuf> =
            folder.join("raw").read_dir().unwrap().map(|entry| entry.unwrap().path()).collect();
        raw.sort();
        // The stretch, enhancement, restoration.
        let mut sums = [0.0; 3];
        let mut count = 0.0;
        for path in raw.iter().step_by(each) {
            let (image, reference) =
                (read(path), read(&folder.join("reference").join(path.file_name().unwrap())));
            let (before, reference) = (image.bytes(), reference.bytes());
            let made = [changed(&image, &enhance), changed(&image, &restore)];
            for made in &made {
                assert!(newly_red(&before, made) < 0.01, "{} is red", path.display());
            }
            let [enhanced, restored] = made;
            let all = [Alone::Stretch.image(&before), enhanced, restored];
            for (sum, image) in sums.iter_mut().zip(&all) {
                *sum += psnr(image, &*reference).unwrap();
            }
            count += 1.0;
        }
        let [stretch, enhanced, restored] = sums.map(|sum| sum / count);
        println!("{set}: stretch {stretch:.2} dB, enhance {enhanced:.2} dB, restore {restored:.2} dB");
        let more = if set == "lsui" { 1.2 } else { 0.0 };
        assert!(enhanced >= stretch + more, "{set}: {enhanced} against {stretch}");
        assert!(restored >= stretch - 0.2, "{set}: {restored} against {stretch}");
    }
}
