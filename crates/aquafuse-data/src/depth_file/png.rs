//! PNG of 8 or 16 bits: grey, or in colours that are grey all the same, as tools without grey write it.

use std::io::{BufRead, Seek};

use ::image::codecs::png::PngDecoder;
use ::image::{ColorType, DynamicImage, ImageDecoder, ImageError, Limits};

use super::{Fault, Raster, Wanted, check_size};

pub(super) fn decode(reader: impl BufRead + Seek, wanted: Wanted) -> Result<Raster, Fault> {
    let decoder = PngDecoder::with_limits(reader, Limits::default())?;
    let (width, height) = decoder.dimensions();
    let colour = decoder.color_type();
    let bytes = u64::from(colour.bytes_per_pixel()).saturating_add(4);
    let (width, height) = check_size(wanted, width.into(), height.into(), bytes)?;
    let channels = usize::from(colour.channel_count());
    let values = match DynamicImage::from_decoder(decoder)? {
        DynamicImage::ImageLuma8(image) => greys(&image.into_raw(), channels),
        DynamicImage::ImageLumaA8(image) => greys(&image.into_raw(), channels),
        DynamicImage::ImageRgb8(image) => greys(&image.into_raw(), channels),
        DynamicImage::ImageRgba8(image) => greys(&image.into_raw(), channels),
        other => {
            let values = match other {
                DynamicImage::ImageLuma16(image) => greys(&image.into_raw(), channels),
                DynamicImage::ImageLumaA16(image) => greys(&image.into_raw(), channels),
                DynamicImage::ImageRgb16(image) => greys(&image.into_raw(), channels),
                DynamicImage::ImageRgba16(image) => greys(&image.into_raw(), channels),
                _ => None,
            };
            return raster(width, height, values, 65535.0, colour);
        }
    };
    raster(width, height, values, 255.0, colour)
}

fn raster(
    width: usize,
    height: usize,
    values: Option<Vec<f32>>,
    most: f32,
    colour: ColorType,
) -> Result<Raster, Fault> {
    let values = values.ok_or_else(|| {
        Fault::Unsupported(
            format!("{colour:?} pixels whose channels differ"),
            "Save it as grey, one channel without transparency; if it was coloured for the eye, the numbers are lost",
        )
    })?;
    Ok(Raster { width, height, values, full_range: Some(most) })
}

/// The values of pixels of which every channel but opacity is the same, and each is opaque; none otherwise.
fn greys<T: Sample>(samples: &[T], channels: usize) -> Option<Vec<f32>> {
    let colours = if channels.is_multiple_of(2) { channels.saturating_sub(1) } else { channels };
    let grey = |pixel: &[T]| {
        let (colour, opacity) = pixel.split_at_checked(colours)?;
        let (first, rest) = colour.split_first()?;
        let is_grey =
            rest.iter().all(|other| other == first) && opacity.iter().all(|value| *value == T::MOST);
        is_grey.then(|| (*first).into())
    };
    samples.chunks_exact(channels).map(grey).collect()
}

/// A sample of 8 or 16 bits.
trait Sample: Copy + PartialEq + Into<f32> {
    const MOST: Self;
}

impl Sample for u8 {
    const MOST: Self = Self::MAX;
}

impl Sample for u16 {
    const MOST: Self = Self::MAX;
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
