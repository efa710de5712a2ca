//! From file to picture and depth.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use ::image::{ColorType, ImageReader};
use aquafuse::image::Image;
use tiff::ColorType as TiffColour;
use tiff::decoder::{Decoder, DecodingResult};

use super::{LabelKind, Labels, PairError};
use crate::picture::{FileError, Picture};

/// Reads the picture of a pair: PNG, JPEG, or TIFF of 8-bit RGB.
///
/// # Errors
///
/// [`PairError`] when it cannot be read or is of another kind.
pub fn read_rgb(path: &Path) -> Result<Image<u8>, PairError> {
    if !is_tiff(path) {
        return Ok(Picture::read(path)?.image);
    }
    let (width, height, colour, samples) = read_tiff(path)?;
    match (colour, samples) {
        (TiffColour::RGB(8), DecodingResult::U8(samples)) => {
            Image::from_raw(width, height, samples).map_err(|size| damaged(path, size))
        }
        (colour, _) => Err(PairError::Kind {
            path: path.to_owned(),
            found: format!("its pixels are {colour:?}"),
            expected: "save the picture as 8-bit RGB first",
        }),
    }
}

/// Reads depth whose numbers are of `kind`: one-channel TIFF (float, 16 or 8 bit) or grey PNG or JPEG (16 or
/// 8 bit). Whole numbers of relative kind are shares of their range.
///
/// # Errors
///
/// [`PairError`] when it cannot be read or is of another kind.
pub fn read_depth(path: &Path, kind: LabelKind) -> Result<Labels, PairError> {
    let (width, height, stored) = if is_tiff(path) { stored_in_tiff(path) } else { stored_in_picture(path) }?;
    let scale = match (kind, stored.whole_range) {
        (LabelKind::Relative, Some(range)) => range,
        _ => 1.0,
    };
    let distances: Vec<f32> = stored.numbers.iter().map(|&number| kind.distance(number / scale)).collect();
    if distances.len() != width * height {
        return Err(damaged(path, "it holds another number of values than pixels"));
    }
    Ok(Labels { width, height, distances })
}

/// Numbers as stored.
struct Stored {
    numbers: Vec<f32>,
    /// The largest whole number of their type; none for floats.
    whole_range: Option<f32>,
}

impl Stored {
    fn words(words: &[u16]) -> Self {
        Self { numbers: words.iter().copied().map(f32::from).collect(), whole_range: Some(65535.0) }
    }

    fn bytes(bytes: &[u8]) -> Self {
        Self { numbers: bytes.iter().copied().map(f32::from).collect(), whole_range: Some(255.0) }
    }
}

fn stored_in_tiff(path: &Path) -> Result<(usize, usize, Stored), PairError> {
    let (width, height, colour, samples) = read_tiff(path)?;
    let stored = match (colour, samples) {
        (TiffColour::Gray(_), DecodingResult::F32(numbers)) => Stored { numbers, whole_range: None },
        (TiffColour::Gray(_), DecodingResult::U16(words)) => Stored::words(&words),
        (TiffColour::Gray(_), DecodingResult::U8(bytes)) => Stored::bytes(&bytes),
        (colour, _) => return Err(no_depth(path, format!("its pixels are {colour:?}"))),
    };
    Ok((width, height, stored))
}

fn stored_in_picture(path: &Path) -> Result<(usize, usize, Stored), PairError> {
    let failed = |error| FileError::Read { path: path.to_owned(), error };
    let reader = ImageReader::open(path).map_err(failed)?.with_guessed_format().map_err(failed)?;
    if reader.format().is_none() {
        return Err(no_depth(path, "it is neither TIFF nor PNG nor JPEG".into()));
    }
    let picture = reader.decode().map_err(|error| damaged(path, error))?;
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let stored = match picture.color() {
        ColorType::L16 => Stored::words(&picture.into_luma16().into_raw()),
        ColorType::L8 => Stored::bytes(&picture.into_luma8().into_raw()),
        colour => return Err(no_depth(path, format!("its pixels are {colour:?}"))),
    };
    Ok((width, height, stored))
}

fn read_tiff(path: &Path) -> Result<(usize, usize, TiffColour, DecodingResult), PairError> {
    let file = File::open(path).map_err(|error| FileError::Read { path: path.to_owned(), error })?;
    let decoded = Decoder::new(BufReader::new(file)).and_then(|mut decoder| {
        let ((width, height), colour) = (decoder.dimensions()?, decoder.colortype()?);
        Ok((width as usize, height as usize, colour, decoder.read_image()?))
    });
    decoded.map_err(|error| damaged(path, error))
}

fn is_tiff(path: &Path) -> bool {
    let extension = path.extension().unwrap_or_default();
    ["tif", "tiff"].into_iter().any(|tiff| extension.eq_ignore_ascii_case(tiff))
}

fn damaged(path: &Path, cause: impl std::fmt::Display) -> PairError {
    FileError::Damaged { path: path.to_owned(), cause: cause.to_string() }.into()
}

fn no_depth(path: &Path, found: String) -> PairError {
    PairError::Kind { path: path.to_owned(), found, expected: "depth is read from one channel, TIFF or PNG" }
}
