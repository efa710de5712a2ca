//! From picture to file.

use std::io::Write;
use std::path::Path;

use ::image::codecs::jpeg::JpegEncoder;
use ::image::codecs::png::PngEncoder;
use ::image::{ExtendedColorType, ImageEncoder, ImageError, ImageResult};

use super::{FileError, Format, Metadata, Picture, WriteOptions, write_atomically};

/// The most EXIF that a JPEG segment holds beside its length and its name.
const JPEG_EXIF: usize = 65535 - 2 - 6;

pub(super) fn write(picture: &Picture, path: &Path, options: &WriteOptions) -> Result<(), FileError> {
    let Some(format) = Format::of(path) else {
        return Err(FileError::UnknownExtension { path: path.to_owned(), expected: ".png, .jpg or .jpeg" });
    };
    if let (Format::Jpeg, Some(exif)) = (format, &picture.metadata.exif)
        && exif.len() > JPEG_EXIF
    {
        let cause = format!("its EXIF block of {} bytes is too large for JPEG; write .png", exif.len());
        return Err(FileError::Write { path: path.to_owned(), cause });
    }
    write_atomically(path, options.overwrite, |out| match format {
        Format::Png => encode(PngEncoder::new(out), picture),
        Format::Jpeg => encode(JpegEncoder::new_with_quality(out, options.quality.clamp(1, 100)), picture),
    })
}

fn encode(mut encoder: impl ImageEncoder, picture: &Picture) -> ImageResult<()> {
    let Metadata { icc_profile, exif, .. } = &picture.metadata;
    if let Some(profile) = icc_profile {
        encoder.set_icc_profile(profile.clone()).map_err(ImageError::Unsupported)?;
    }
    if let Some(exif) = exif {
        encoder.set_exif_metadata(exif.clone()).map_err(ImageError::Unsupported)?;
    }
    let side = |length: usize| u32::try_from(length).unwrap_or(u32::MAX);
    let image = &picture.image;
    encoder.write_image(image.as_raw(), side(image.width()), side(image.height()), ExtendedColorType::Rgb8)
}

/// Encodes one grey channel of 16 bits as PNG.
pub(crate) fn encode_grey16(
    out: &mut dyn Write,
    width: usize,
    height: usize,
    values: &[u16],
) -> ImageResult<()> {
    let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_ne_bytes()).collect();
    let side = |length: usize| u32::try_from(length).unwrap_or(u32::MAX);
    PngEncoder::new(out).write_image(&bytes, side(width), side(height), ExtendedColorType::L16)
}
