//! The picture of a pair: what `picture` reads, and TIFF, in which depth data sets keep theirs.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use aquafuse::image::Image;
use tiff::ColorType;
use tiff::decoder::{Decoder, DecodingResult};

use crate::picture::{FileError, Picture};

/// Reads the picture of a pair: PNG, JPEG, or TIFF of 8-bit RGB.
///
/// # Errors
///
/// [`FileError`] when it cannot be read or is of another kind.
pub fn read_rgb(path: &Path) -> Result<Picture, FileError> {
    let extension = path.extension().unwrap_or_default();
    if !["tif", "tiff"].into_iter().any(|tiff| extension.eq_ignore_ascii_case(tiff)) {
        return Picture::read(path);
    }
    let file = File::open(path).map_err(|error| FileError::Read { path: path.to_owned(), error })?;
    let damaged = |cause: String| FileError::Damaged { path: path.to_owned(), cause };
    let decoded = Decoder::new(BufReader::new(file)).and_then(|mut decoder| {
        let ((width, height), colour) = (decoder.dimensions()?, decoder.colortype()?);
        Ok((width as usize, height as usize, colour, decoder.read_image()?))
    });
    match decoded.map_err(|error| damaged(error.to_string()))? {
        (width, height, ColorType::RGB(8), DecodingResult::U8(samples)) => {
            let image = Image::from_raw(width, height, samples).map_err(|size| damaged(size.to_string()))?;
            Ok(Picture::new(image))
        }
        (_, _, colour, _) => Err(FileError::UnsupportedPixels {
            path: path.to_owned(),
            found: format!("{colour:?}"),
            remedy: "Save it as 8-bit RGB first",
        }),
    }
}
