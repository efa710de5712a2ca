//! Bad files of every kind, and some that are only unusual, with what is right for each. The same files come out every time.
//!
//! *Refuse* is claimed only where the format's own rules leave no whole image: data the pixels need are gone, or a
//! header says what the rules forbid. Where a reader may recover without loss, as from a lost end mark, *any* is
//! right, but no panic, no hang and no half output.

mod bmp;
mod bytes;
mod colmap;
mod damage;
mod exr;
mod gif;
mod jpeg;
mod jpeg_bytes;
mod labels;
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
mod tiff_jpeg;
mod unusual;
mod webp;

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

pub(crate) use bytes::crc32;
pub(crate) use labels::labels;
pub(crate) use list::{Files, Forged, Right, Role};

/// Every file there is.
pub(crate) fn files() -> Result<Files> {
    let mut files = Files::default();
    damage::add(&mut files)?;
    png::add(&mut files);
    jpeg::add(&mut files);
    metadata::add(&mut files)?;
    webp::add(&mut files)?;
    gif::add(&mut files);
    bmp::add(&mut files);
    tiff::add(&mut files);
    tiff_jpeg::add(&mut files)?;
    exr::add(&mut files)?;
    npy::add(&mut files);
    pfm::add(&mut files);
    colmap::add(&mut files);
    no_image::add(&mut files);
    unusual::add(&mut files)?;
    Ok(files)
}

/// Writes a good image, and one whose water can be estimated: their paths.
pub(crate) fn write_good(folder: &Path) -> Result<[PathBuf; 2]> {
    let write = |name: &str, bytes: Vec<u8>| -> Result<PathBuf> {
        let path = folder.join(name);
        fs::write(&path, bytes).with_context(|| format!("cannot write {}", path.display()))?;
        Ok(path)
    };
    Ok([write("good.png", seeds::image("png")?)?, write("water.png", seeds::water()?)?])
}
