//! From file to picture.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use ::image::{ColorType, DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader};
use aquafuse::image::Image;

use super::{FileError, Metadata, Picture};

pub(super) fn read(path: &Path) -> Result<Picture, FileError> {
    let cannot_read = |source| FileError::Read { path: path.to_owned(), source };
    let file = File::open(path).map_err(cannot_read)?;
    let reader = ImageReader::new(BufReader::new(file)).with_guessed_format().map_err(cannot_read)?;
    if !matches!(reader.format(), Some(ImageFormat::Png | ImageFormat::Jpeg)) {
        return Err(FileError::UnknownFormat { path: path.to_owned() });
    }
    let failed = |error| decoding_error(path, error);
    let mut decoder = reader.into_decoder().map_err(failed)?;
    check_pixels(path, decoder.color_type())?;
    let metadata = Metadata {
        icc_profile: decoder.icc_profile().map_err(failed)?,
        exif: decoder.exif_metadata().map_err(failed)?,
        orientation: decoder.orientation().map_err(failed)?.to_exif(),
    };
    let pixels = DynamicImage::from_decoder(decoder).map_err(failed)?.into_rgb8();
    let (width, height) = (pixels.width() as usize, pixels.height() as usize);
    let image = Image::from_raw(width, height, pixels.into_raw())
        .map_err(|size| FileError::Damaged { path: path.to_owned(), cause: size.to_string() })?;
    Ok(Picture { image, metadata })
}

fn check_pixels(path: &Path, colour: ColorType) -> Result<(), FileError> {
    let unsupported = |found: &str, remedy| FileError::UnsupportedPixels {
        path: path.to_owned(),
        found: found.to_owned(),
        remedy,
    };
    match colour {
        ColorType::L8 | ColorType::Rgb8 => Ok(()),
        ColorType::La8 | ColorType::Rgba8 => {
            Err(unsupported("8-bit with transparency", "Flatten the picture onto a background first"))
        }
        other => Err(unsupported(&format!("{other:?}"), "Convert the picture to 8 bits a channel first")),
    }
}

fn decoding_error(path: &Path, error: ImageError) -> FileError {
    let path = path.to_owned();
    match error {
        ImageError::IoError(source) if source.kind() != std::io::ErrorKind::UnexpectedEof => {
            FileError::Read { path, source }
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
