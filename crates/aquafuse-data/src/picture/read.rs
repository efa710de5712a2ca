//! From file to picture.

use std::fs::File;
use std::io::BufReader;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use ::image::{
    ColorType, DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader, ImageResult, Limits,
};
use aquafuse::image::Image;

use super::{FileError, Metadata, Picture};

pub(super) fn read(path: &Path) -> Result<Picture, FileError> {
    let cannot_read = |error| FileError::Read { path: path.to_owned(), error };
    let damaged = |cause: String| FileError::Damaged { path: path.to_owned(), cause };
    let file = File::open(path).map_err(cannot_read)?;
    if file.metadata().is_ok_and(|about| about.is_file() && about.len() == 0) {
        return Err(FileError::Empty { path: path.to_owned() });
    }
    let reader = ImageReader::new(BufReader::new(file)).with_guessed_format().map_err(cannot_read)?;
    if !matches!(reader.format(), Some(ImageFormat::Png | ImageFormat::Jpeg)) {
        return Err(FileError::UnknownFormat { path: path.to_owned() });
    }
    // A decoder that panics is a bug of its own, but it must not take a folder of pictures with it.
    let decoded = catch_unwind(AssertUnwindSafe(|| decode(path, reader)))
        .unwrap_or_else(|_| Err(damaged("the decoder gave up on it".into())))?;
    let (metadata, pixels) = decoded;
    let (width, height) = (pixels.width() as usize, pixels.height() as usize);
    let image = Image::from_raw(width, height, pixels.into_rgb8().into_raw())
        .map_err(|size| damaged(size.to_string()))?;
    Ok(Picture { image, metadata })
}

fn decode(path: &Path, reader: ImageReader<BufReader<File>>) -> Result<(Metadata, DynamicImage), FileError> {
    let failed = |error| decoding_error(path, error);
    let mut decoder = reader.into_decoder().map_err(failed)?;
    check_pixels(path, decoder.color_type())?;
    reserve(&decoder).map_err(failed)?;
    let metadata = Metadata {
        icc_profile: decoder.icc_profile().map_err(failed)?.filter(|profile| is_for_rgb(profile)),
        exif: decoder.exif_metadata().map_err(failed)?,
        orientation: decoder.orientation().map_err(failed)?.to_exif(),
    };
    Ok((metadata, DynamicImage::from_decoder(decoder).map_err(failed)?))
}

/// Refuses from the header what would not fit into the decoder's limit of memory.
fn reserve(decoder: &impl ImageDecoder) -> ImageResult<()> {
    // Grey grows threefold on its way to RGB.
    let (width, height) = decoder.dimensions();
    Limits::default().reserve(u64::from(width) * u64::from(height) * 3)
}

/// Whether an ICC profile describes RGB values: its header says so at byte 16.
fn is_for_rgb(profile: &[u8]) -> bool {
    profile.get(16..20) == Some(b"RGB ")
}

fn check_pixels(path: &Path, colour: ColorType) -> Result<(), FileError> {
    let unsupported =
        |found: String, remedy| FileError::UnsupportedPixels { path: path.to_owned(), found, remedy };
    match colour {
        ColorType::L8 | ColorType::Rgb8 => Ok(()),
        ColorType::La8 | ColorType::Rgba8 => {
            Err(unsupported("8-bit with transparency".into(), "Flatten the picture onto a background first"))
        }
        other => {
            let bits = u32::from(other.bytes_per_pixel()) * 8 / u32::from(other.channel_count().max(1));
            Err(unsupported(
                format!("of {bits} bits a channel"),
                "Convert the picture to 8 bits a channel first",
            ))
        }
    }
}

fn decoding_error(path: &Path, error: ImageError) -> FileError {
    let path = path.to_owned();
    match error {
        ImageError::IoError(error) if error.kind() != std::io::ErrorKind::UnexpectedEof => {
            FileError::Read { path, error }
        }
        ImageError::Limits(limit) => FileError::TooLarge { path, cause: limit.to_string() },
        ImageError::Unsupported(found) => FileError::UnsupportedPixels {
            path,
            found: found.to_string(),
            remedy: "Save the picture as plain 8-bit RGB first",
        },
        other => FileError::Damaged { path, cause: other.to_string() },
    }
}
