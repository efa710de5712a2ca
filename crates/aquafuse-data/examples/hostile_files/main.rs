//! Bad files of every kind, and some that are only unusual, with a list of what is right for each.
//!
//! cargo run --release -p aquafuse-data --example hostile_files -- FOLDER
//!
//! Writes `FOLDER/files/`, `FOLDER/good.png`, `FOLDER/water.png` and `FOLDER/list.tsv`; `cargo xtask hostile` gives
//! each file to the command. The same files come out every time.
//!
//! *Refuse* is claimed only where the format's own rules leave no whole image: data the pixels need are gone, or a
//! header says what the rules forbid. Where a reader may recover without loss, as from a lost end mark, *any* is
//! right, but no panic, no hang and no half output.

mod bmp;
mod bytes;
mod damage;
mod exr;
mod gif;
mod jpeg;
mod jpeg_bytes;
mod list;
mod metadata;
mod no_image;
mod npy;
mod pfm;
mod png;
mod png_bytes;
mod seeds;
mod tiff;
mod tiff_bytes;
mod unusual;
mod webp;

use std::error::Error;
use std::path::PathBuf;

use list::Files;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(std::env::args_os().nth(1).ok_or("give the folder to write to")?);
    let mut files = Files::default();
    damage::add(&mut files)?;
    png::add(&mut files);
    jpeg::add(&mut files);
    metadata::add(&mut files)?;
    webp::add(&mut files)?;
    gif::add(&mut files);
    bmp::add(&mut files);
    tiff::add(&mut files);
    exr::add(&mut files)?;
    npy::add(&mut files);
    pfm::add(&mut files);
    no_image::add(&mut files);
    unusual::add(&mut files)?;
    files.write(&folder)?;
    std::fs::write(folder.join("good.png"), seeds::image("png")?)?;
    std::fs::write(folder.join("water.png"), seeds::water()?)?;
    println!("{} files in {}", files.len(), folder.display());
    Ok(())
}
