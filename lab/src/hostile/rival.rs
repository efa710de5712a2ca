//! The rival of the table of bad files in `docs/results.md`: what most people would write around the `image` crate.
//!
//! It reads an image, shifts its colours by a constant as a veil of water would, and saves it. Its errors name the file,
//! which is more than many do.

use std::path::Path;

use anyhow::{Context, Result};

/// The veil, in steps of 255.
const SHIFT: [u8; 3] = [5, 20, 25];

/// `lab rival INPUT OUTPUT`, a process of its own for each file.
pub(crate) fn run(input: &Path, output: &Path) -> Result<()> {
    shift(input, output).with_context(|| input.display().to_string())
}

fn shift(input: &Path, output: &Path) -> image::ImageResult<()> {
    let mut image = image::open(input)?.into_rgb8();
    for pixel in image.pixels_mut() {
        for (value, shift) in pixel.0.iter_mut().zip(SHIFT) {
            *value = value.saturating_add(shift);
        }
    }
    image.save(output)
}
