//! Writes a truth scene as a folder that `aquafuse scene` takes: 28 images taken in blue water, their cameras, and points;
//! beside it the water of another place, FOLDER.water.png, for `aquafuse scene fuse`.
//!
//!     cargo run --release -p aquafuse-scene --example truth_scene -- FOLDER

use std::path::PathBuf;

use aquafuse::truth::{Scene, Size, waters};
use aquafuse_data::image_file::{ImageFile, WriteOptions};
use aquafuse_scene::truth::{points, views, write};

/// As in `scene_table`.
const VIEWS: usize = 28;
const SIZE: Size = Size { width: 200, height: 152 };
const FINER: usize = 2;
/// A point in so many pixels.
const EVERY: usize = 24;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args().nth(1).map(PathBuf::from).ok_or("name a folder to write to")?;
    let [blue, green, ..] = waters();
    let views = views(1, SIZE, VIEWS, FINER);
    let images: Vec<_> = views.iter().map(|view| view.seen_through(&blue.water)).collect();
    let points = points(&views, &images, EVERY);
    write(&folder, &views, &images, points)?;
    let elsewhere = Scene::new(3, Size { width: 400, height: 304 }).seen_through(&green.water);
    let path = folder.with_extension("water.png");
    ImageFile::new(elsewhere.convert::<u8>()).write(&path, &WriteOptions::default())?;
    Ok(())
}
