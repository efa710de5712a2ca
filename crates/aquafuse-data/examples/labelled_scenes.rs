//! Truth scenes in waters by number, in the layout image + mask: each pixel of a mask says what is there.
//!
//! cargo run --release -p aquafuse-data --example labelled_scenes -- FOLDER WATERS WIDTH HEIGHT FIRST-LAST...
//!
//! WATERS is how many drawn waters there are, FIRST-LAST the seeds of scenes. Each scene is seen in each water `as-is` (white
//! light, PNG) and `lit` (lit by its own water, by a camera, JPEG): `FOLDER/KIND-WATER/images/SEED.png` (or `.jpg`) and
//! `FOLDER/KIND-WATER/masks/SEED.png`. Prints the numbers of the turbid waters.

use std::error::Error;
use std::path::{Path, PathBuf};

use aquafuse::image::Image;
use aquafuse::truth::{DrawnWater, Kind, Scene, Size};
use aquafuse_data::image_file::{ImageFile, WriteOptions};
use rayon::prelude::*;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [folder, waters, width, height, ranges @ ..] = &arguments[..] else {
        return Err("usage: labelled_scenes FOLDER WATERS WIDTH HEIGHT FIRST-LAST...".into());
    };
    let folder = Path::new(folder);
    let size = Size { width: width.parse()?, height: height.parse()? };
    let waters: Vec<DrawnWater> = (0..waters.parse()?).map(DrawnWater::new).collect();
    let mut seeds: Vec<u64> = Vec::new();
    for range in ranges {
        let (first, last) = range.split_once('-').ok_or("give FIRST-LAST")?;
        seeds.extend(first.parse::<u64>()?..=last.parse::<u64>()?);
    }
    let place = |kind: &str, number: usize| folder.join(format!("{kind}-{number:02}"));
    for (kind, number) in (0..waters.len()).flat_map(|number| [("as-is", number), ("lit", number)]) {
        std::fs::create_dir_all(place(kind, number).join("images"))?;
        std::fs::create_dir_all(place(kind, number).join("masks"))?;
    }
    seeds.into_par_iter().try_for_each(|seed| -> Result<(), String> {
        let scene = Scene::new(seed, size);
        let mask = scene.kinds.iter().flat_map(|kind| [label(*kind); 3]).collect();
        let mask = Image::from_raw(size.width, size.height, mask).map_err(|error| error.to_string())?;
        let write = |image: Image<u8>, path: PathBuf, quality: u8| {
            let options = WriteOptions { overwrite: true, quality };
            ImageFile::new(image).write(&path, &options).map_err(|error| error.to_string())
        };
        // The scene takes far longer than its images: it is made once for all waters.
        waters.iter().enumerate().try_for_each(|(number, water)| {
            let [as_is, lit] = ["as-is", "lit"].map(|kind| place(kind, number));
            write(mask.clone(), as_is.join(format!("masks/{seed:05}.png")), 95)?;
            write(mask.clone(), lit.join(format!("masks/{seed:05}.png")), 95)?;
            write(water.as_is(&scene, seed), as_is.join(format!("images/{seed:05}.png")), 95)?;
            let quality = water.jpeg_quality(seed);
            write(water.lit(&scene, seed), lit.join(format!("images/{seed:05}.jpg")), quality)
        })
    })?;
    for (number, _) in waters.iter().enumerate().filter(|(_, water)| water.is_turbid()) {
        println!("{number}");
    }
    Ok(())
}

/// A grey level for each kind.
fn label(kind: Kind) -> u8 {
    match kind {
        Kind::OpenWater => 0,
        Kind::Floor => 1,
        Kind::Rock => 2,
        Kind::Coral => 3,
        Kind::Plant => 4,
        Kind::Fish => 5,
        _ => 6,
    }
}
