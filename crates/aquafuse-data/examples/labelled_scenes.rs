//! Truth scenes in each of the synthetic waters, in the layout image + mask: each pixel of a mask says what is there.
//!
//! cargo run --release -p aquafuse-data --example labelled_scenes -- FOLDER FIRST COUNT WIDTH HEIGHT
//!
//! Writes `FOLDER/WATER/images/SEED.png` and `FOLDER/WATER/masks/SEED.png`.

use std::error::Error;
use std::path::Path;

use aquafuse::image::Image;
use aquafuse::truth::{Kind, Scene, Size, waters};
use aquafuse_data::image_file::{ImageFile, WriteOptions};
use rayon::prelude::*;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [folder, first, count, width, height] = &arguments[..] else {
        return Err("usage: labelled_scenes FOLDER FIRST COUNT WIDTH HEIGHT".into());
    };
    let folder = Path::new(folder);
    let size = Size { width: width.parse()?, height: height.parse()? };
    for (water, kind) in waters().iter().flat_map(|water| [(water, "images"), (water, "masks")]) {
        std::fs::create_dir_all(folder.join(water.name).join(kind))?;
    }
    let (first, count): (u64, u64) = (first.parse()?, count.parse()?);
    (first..first + count).into_par_iter().try_for_each(|seed| -> Result<(), String> {
        let scene = Scene::new(seed, size);
        let mask = scene.kinds.iter().flat_map(|kind| [label(*kind); 3]).collect();
        let mask = Image::from_raw(size.width, size.height, mask).map_err(|error| error.to_string())?;
        let write = |image: Image<u8>, path: &Path| {
            let options = WriteOptions { overwrite: true, ..WriteOptions::default() };
            ImageFile::new(image).write(path, &options).map_err(|error| error.to_string())
        };
        waters().iter().try_for_each(|named| {
            let name = |kind: &str| folder.join(named.name).join(kind).join(format!("{seed:05}.png"));
            write(scene.seen_through(&named.water).convert(), &name("images"))?;
            write(mask.clone(), &name("masks"))
        })
    })?;
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
