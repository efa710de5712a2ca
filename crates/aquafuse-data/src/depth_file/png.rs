//! Grey PNG of 8 or 16 bits.

use std::io::{BufRead, Seek};

use ::image::codecs::png::PngDecoder;
use ::image::{ColorType, DynamicImage, ImageDecoder, ImageError, Limits};

use super::{Fault, Raster, Wanted, check_size};

pub(super) fn decode(reader: impl BufRead + Seek, wanted: Wanted) -> Result<Raster, Fault> {
    let decoder = PngDecoder::with_limits(reader, Limits::default())?;
    let (width, height) = decoder.dimensions();
    let (width, height) = check_size(wanted, width.into(), height.into(), 4)?;
    if !matches!(decoder.color_type(), ColorType::L8 | ColorType::L16) {
        return Err(Fault::Unsupported(
            format!("{:?} pixels", decoder.color_type()),
            "Save it as grey, one channel without transparency; if it was coloured for the eye, the numbers are lost",
        ));
    }
    let (values, most) = match DynamicImage::from_decoder(decoder)? {
        DynamicImage::ImageLuma8(grey) => (grey.into_raw().into_iter().map(f32::from).collect(), 255.0),
        other => (other.into_luma16().into_raw().into_iter().map(f32::from).collect(), 65535.0),
    };
    Ok(Raster { width, height, values, full_range: Some(most) })
}

impl From<ImageError> for Fault {
    fn from(error: ImageError) -> Self {
        match error {
            ImageError::IoError(error) => error.into(),
            ImageError::Limits(limit) => Self::TooLarge(limit.to_string()),
            other => Self::Damaged(other.to_string()),
        }
    }
}
