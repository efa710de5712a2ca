//! TIFF: 8 and 16 bits, floats from 0 to 1; its first page.

mod jpeg_pieces;

use std::io::{BufRead, Cursor, Read, Seek, SeekFrom};

use ::image::ExtendedColorType;
use ::image::ImageDecoder as _;
use ::image::codecs::tiff::TiffDecoder;
use ::tiff::TiffError;
use ::tiff::decoder::ChunkType;
use ::tiff::tags::Tag;

use super::super::exif::{self, Exif};
use super::super::limits::Size;
use super::super::metadata::Metadata;
use super::{Decoded, Fault, Pixels, XMP, by_image, size_of};

/// JPEG within TIFF as it was before 1995: what it means was never settled.
const OLD_JPEG: u16 = 6;

/// Strips or tiles of a page: more than those of 16 x 16 in 64 megapixels. Each takes the decoder some microseconds, be it
/// of one pixel, and all may be one piece of the file.
const MOST_PIECES: u32 = 1 << 18;
/// What to do about more.
pub(crate) const LARGER_PIECES: &str = "Save it with strips or tiles of more pixels";

/// What is said where a page is cut into too many strips or tiles.
pub(crate) fn too_many_pieces(page: &mut ::tiff::decoder::Decoder<impl Read + Seek>) -> Option<String> {
    let pieces = match page.get_chunk_type() {
        ChunkType::Strip => page.strip_count(),
        ChunkType::Tile => page.tile_count(),
    };
    let pieces = pieces.ok().filter(|pieces| *pieces > MOST_PIECES)?;
    Some(format!("a TIFF of {pieces} strips or tiles ({MOST_PIECES} are allowed)"))
}

pub(super) fn header(reader: &mut (impl BufRead + Seek)) -> Result<Size, Fault> {
    let mut fields = ::tiff::decoder::Decoder::new(&mut *reader)?;
    if is_preview(&mut fields) {
        return Err(Fault::Unsupported(
            "a camera's raw file, or another TIFF whose first image is a preview".into(),
            "Develop it first, for example with darktable or RawTherapee, and save it as TIFF, PNG or JPEG",
        ));
    }
    if fields.find_tag_unsigned::<u16>(Tag::Compression).is_ok_and(|way| way == Some(OLD_JPEG)) {
        return Err(Fault::Unsupported(
            "a TIFF compressed as JPEG in the old way".into(),
            "Save it with LZW, deflate or no compression, or as a JPEG",
        ));
    }
    if let Some(found) = too_many_pieces(&mut fields) {
        return Err(Fault::Unsupported(found, LARGER_PIECES));
    }
    if jpeg_pieces::is_jpeg(&mut fields) {
        return jpeg_pieces::header(&mut fields);
    }
    reader.seek(SeekFrom::Start(0))?;
    let decoder = TiffDecoder::new(reader)?;
    let cmyk = matches!(decoder.original_color_type(), ExtendedColorType::Cmyk8 | ExtendedColorType::Cmyk16);
    let size = size_of(&decoder);
    // It decodes into a buffer of its own first.
    let own = if cmyk { 4 } else { size.channels };
    Ok(Size { beside: size.beside.saturating_add(size.sample.saturating_mul(own)), ..size })
}

impl From<TiffError> for Fault {
    fn from(error: TiffError) -> Self {
        match error {
            TiffError::UnsupportedError(form) => Self::Unsupported(
                format!("a TIFF in a form that is not read ({form})"),
                "Save it as PNG, or as TIFF in RGB; develop a camera's raw file first",
            ),
            TiffError::IoError(error) => error.into(),
            other => Self::Damaged(other.to_string()),
        }
    }
}

/// Whether the first image of a file is not its image: it says so, or the file has the version of DNG.
fn is_preview(page: &mut ::tiff::decoder::Decoder<impl Read + Seek>) -> bool {
    const DNG_VERSION: Tag = Tag::Unknown(50706);
    let says = page.find_tag_unsigned::<u32>(Tag::NewSubfileType).ok().flatten();
    says.is_some_and(|kind| kind & 1 == 1) || matches!(page.find_tag(DNG_VERSION), Ok(Some(_)))
}

pub(super) fn decode(bytes: &[u8]) -> Result<Decoded, Fault> {
    let is_jpeg = jpeg_pieces::is_jpeg(&mut ::tiff::decoder::Decoder::new(Cursor::new(bytes))?);
    let mut decoded = if is_jpeg {
        Decoded { pixels: jpeg_pieces::decode(bytes)?, metadata: Metadata::default(), damage: None }
    } else {
        by_image(TiffDecoder::new(Cursor::new(bytes))?)?
    };
    check_floats(&decoded.pixels)?;
    let metadata = &mut decoded.metadata;
    // XMP is a field as any other, and travels with them.
    metadata.left_out.retain(|what| *what != XMP);
    // `image` finds only profiles of a type that the specification does not name.
    if metadata.icc_profile.is_none() {
        metadata.set_profile(exif::profile(bytes));
    }
    match Exif::read(bytes) {
        Some(exif) if !exif.is_empty() => {
            metadata.resolution = exif.resolution();
            metadata.exif = Some(exif.to_block().map_err(|error| Fault::Damaged(error.to_string()))?);
        }
        Some(_) => {}
        None => metadata.leave_out(true, "its EXIF and resolution (a BigTIFF, or too much of it)"),
    }
    metadata.leave_out(has_further_pages(bytes), "the pages after the first");
    Ok(decoded)
}

fn has_further_pages(bytes: &[u8]) -> bool {
    ::tiff::decoder::Decoder::new(Cursor::new(bytes)).is_ok_and(|decoder| decoder.more_images())
}

/// Floats outside the range are light, or numbers of another scale, and not what a camera encodes.
fn check_floats(pixels: &Pixels) -> Result<(), Fault> {
    let Pixels::Floats(layers) = pixels else { return Ok(()) };
    let all = || layers.image.as_raw().iter().chain(layers.alpha.iter().flatten());
    if all().all(|value| (0.0..=1.0).contains(value)) {
        return Ok(());
    }
    let (low, high) =
        all().fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), &v| (low.min(v), high.max(v)));
    let missing = if all().any(|value| value.is_nan()) { ", some are no numbers" } else { "" };
    Err(Fault::Unsupported(
        format!("floats from {low} to {high}{missing}, not from 0 to 1"),
        "Scale it to 0 to 1 and encode it as sRGB first",
    ))
}
