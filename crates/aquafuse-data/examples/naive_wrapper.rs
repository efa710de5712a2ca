//! The rival of the table of bad files in `docs/results.md`: what most people would write around the `image` crate.
//!
//! cargo run --release -p aquafuse-data --example naive_wrapper -- INPUT OUTPUT
//!
//! Reads an image, shifts its colours by a constant as a veil of water would, saves it. Its errors name the file,
//! which is more than many do.

use std::path::Path;
use std::process::ExitCode;

/// The veil, in steps of 255.
const SHIFT: [u8; 3] = [5, 20, 25];

fn main() -> ExitCode {
    let paths: Vec<_> = std::env::args_os().skip(1).collect();
    let [input, output] = &paths[..] else {
        eprintln!("give an input and an output");
        return ExitCode::from(2);
    };
    match shift(input.as_ref(), output.as_ref()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{}: {error}", Path::new(input).display());
            ExitCode::FAILURE
        }
    }
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
