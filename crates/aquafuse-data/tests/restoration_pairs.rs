//! Enhancement and restoration beside references that people chose, and beside the simplest rival.
//!
//! Needs the folder `AQUAFUSE_TEST_DATA`. The whole table is `cargo lab pairs`.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

use std::path::{Path, PathBuf};

use aquafuse::formation::RestoreOptions;
use aquafuse::image::Image;
use aquafuse::levels::LevelsOptions;
use aquafuse::metrics::psnr;
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
