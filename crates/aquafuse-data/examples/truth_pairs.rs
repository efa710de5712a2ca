//! Images with known depth that anyone can make: synthetic places in synthetic waters, to fit a model to.
//!
//! cargo run --release -p aquafuse-data --example truth_pairs -- FOLDER
//! cargo run --release -- fit FOLDER -o MODEL.toml --depth-kind millimetres
//!
//! Open water has no depth here, as it has none where depth is measured.

use std::path::PathBuf;

use aquafuse::depth::{DepthKind, DepthMap};
use aquafuse::truth::{OPEN_WATER, Scene, Size, waters};
use aquafuse_data::depth_file;
use aquafuse_data::image_file::{ImageFile, WriteOptions};

/// Seeds of the places; the tables of `docs/results.md` use others.
const SEEDS: std::ops::Range<u64> = 200..240;
const SIZE: Size = Size { width: 240, height: 160 };

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = PathBuf::from(std::env::args_os().nth(1).ok_or("give the folder to write to")?);
    let (rgb, depth) = (folder.join("rgb"), folder.join("depth"));
    std::fs::create_dir_all(&rgb)?;
    std::fs::create_dir_all(&depth)?;
    for (seed, water) in SEEDS.zip(waters().iter().cycle()) {
        let scene = Scene::new(seed, SIZE);
        let name = format!("{seed}_{}.png", water.name);
        let image = ImageFile::new(scene.seen_through(&water.water).convert::<u8>());
        image.write(&rgb.join(&name), &WriteOptions::default())?;
        // 0 is unknown depth.
        let seen = |z: f32| if z < OPEN_WATER { z } else { 0.0 };
        let metres = scene.depth.distances().into_iter().map(seen).collect();
        let metres = DepthMap::from_distances(SIZE.width, SIZE.height, DepthKind::Metres, metres)?;
        depth_file::write(&depth.join(&name), &metres, &WriteOptions::default())?;
    }
    println!("{} pairs in {}", SEEDS.count(), folder.display());
    Ok(())
}
