//! A data set of truth scenes in named waters, in the layout image + mask: each pixel of a mask says what is there.
//!
//! cargo run --release -p aquafuse-data --example labelled_scenes -- FOLDER FIRST COUNT WIDTH HEIGHT WATER...
//!
//! Scene after scene is seen through the next of the waters, or all of them through one.

use std::error::Error;
use std::path::Path;

use aquafuse::image::Image;
use aquafuse::truth::{Kind, Scene, Size, waters};
use aquafuse_data::picture::{Picture, WriteOptions};
use rayon::prelude::*;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [folder, first, count, width, height, names @ ..] = &arguments[..] else {
        return Err("usage: labelled_scenes FOLDER FIRST COUNT WIDTH HEIGHT WATER...".into());
    };
    let known = waters();
    let named = |name: &String| known.iter().find(|water| water.name == name).ok_or("no water of that name");
    let through = names.iter().map(named).collect::<Result<Vec<_>, _>>()?;
    if through.is_empty() {
        return Err("name a water".into());
    }
    let size = Size { width: width.parse()?, height: height.parse()? };
    let (images, masks) = (Path::new(folder).join("images"), Path::new(folder).join("masks"));
    for folder in [&images, &masks] {
        std::fs::create_dir_all(folder)?;
    }
    let (first, count): (u64, u64) = (first.parse()?, count.parse()?);
    (first..first + count).into_par_iter().try_for_each(|seed| -> Result<(), String> {
        let scene = Scene::new(seed, size);
        let water = through[(seed - first) as usize % through.len()];
        let name = format!("{seed:05}-{}.png", water.name);
        let mask = scene.kinds.iter().flat_map(|kind| [label(*kind); 3]).collect();
        let mask = Image::from_raw(size.width, size.height, mask).map_err(|error| error.to_string())?;
        let write = |image: Image<u8>, path: &Path| {
            let options = WriteOptions { overwrite: true, ..WriteOptions::default() };
            Picture::new(image).write(path, &options).map_err(|error| error.to_string())
        };
        write(scene.seen_through(&water.water).to_samples(), &images.join(&name))?;
        write(mask, &masks.join(&name))
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
