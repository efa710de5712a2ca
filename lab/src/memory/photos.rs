//! Images of 24 megapixels: waves of colour with grain, as large as those of today's cameras. What is in them does not
//! matter, for it is memory that is measured.

use std::path::Path;

use anyhow::Result;
use aquafuse::image::Image;
use aquafuse_data::image_file::{ImageFile, WriteOptions};

/// The sides of an image of 24 megapixels.
pub(super) const LARGE: [usize; 2] = [6000, 4000];

/// Writes one of this size; another seed makes another image.
pub(super) fn write(path: &Path, seed: u32, size: [usize; 2]) -> Result<()> {
    Ok(ImageFile::new(made(seed, size)).write(path, &WriteOptions { overwrite: true, quality: 90 })?)
}

fn made(seed: u32, [width, height]: [usize; 2]) -> Image<u8> {
    let mut grain = seed + 1;
    let wave = |place: usize, length: usize| ((place % length) as i32 * 2 - length as i32).unsigned_abs();
    let pixel = |i: usize| {
        let (x, y) = (i % width, i / width);
        grain = grain.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let shade = wave(x, 900 + 50 * seed as usize) / 20 + wave(y, 1300) / 30 + (grain >> 29);
        [shade / 3, 60 + shade, 90 + shade].map(|value| value.min(255) as u8)
    };
    let samples = (0..width * height).flat_map(pixel).collect();
    Image::from_raw(width, height, samples).expect("three samples a pixel")
}
