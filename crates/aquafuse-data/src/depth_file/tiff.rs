//! Grey TIFF: whole numbers of 8 and 16 bits, floats of 32 and 64.

use std::io::{BufRead, Cursor, Seek};

use ::tiff::TiffError;
use ::tiff::decoder::{Decoder, DecodingResult, Limits};
use ::tiff::encoder::{TiffEncoder, colortype};
use ::tiff::tags::Tag;
use aquafuse::depth::DepthMap;

use crate::image_file::{LARGER_PIECES, too_many_pieces};

use super::{Fault, MOST_BYTES, Raster, Wanted, check_size, narrowed};

const REMEDY: &str = "Save it as grey, one channel of 32-bit float or 16-bit unsigned numbers";

/// Ways to pack black and white, bit by bit: of numbers they make nothing, slowly.
const FAX: std::ops::RangeInclusive<u16> = 2..=4;
const JPEG: std::ops::RangeInclusive<u16> = 6..=7;

pub(super) fn decode(reader: impl BufRead + Seek, wanted: Wanted) -> Result<Raster, Fault> {
    let most = usize::try_from(MOST_BYTES).unwrap_or(usize::MAX);
    let mut limits = Limits::default();
    (limits.decoding_buffer_size, limits.intermediate_buffer_size) = (most, most);
    // The limits hold from here on; until here only the first directory is read.
    let mut decoder = Decoder::new(reader)?.with_limits(limits);
    let (width, height) = decoder.dimensions()?;
    let colour = decoder.colortype()?;
    let (width, height) =
        check_size(wanted, width.into(), height.into(), u64::from(colour.bit_depth()).div_ceil(8))?;
    if !matches!(colour, ::tiff::ColorType::Gray(8 | 16 | 32 | 64)) {
        return Err(Fault::Unsupported(format!("{colour:?} pixels"), REMEDY));
    }
    let compression = decoder.find_tag_unsigned::<u16>(Tag::Compression)?;
    if compression.is_some_and(|way| FAX.contains(&way)) {
        return Err(Fault::Unsupported("fax compression".into(), REMEDY));
    }
    // Strips of JPEG have sizes of their own, and lose what depth is measured by.
    if compression.is_some_and(|way| JPEG.contains(&way)) {
        return Err(Fault::Unsupported("JPEG compression".into(), REMEDY));
    }
    if let Some(found) = too_many_pieces(&mut decoder) {
        return Err(Fault::Unsupported(found, LARGER_PIECES));
    }
    let (values, full_range) = match decoder.read_image()? {
        DecodingResult::F32(values) => (values, None),
        DecodingResult::F64(values) => (values.into_iter().map(narrowed).collect(), None),
        DecodingResult::U8(values) => (values.into_iter().map(f32::from).collect(), Some(255.0)),
        DecodingResult::U16(values) => (values.into_iter().map(f32::from).collect(), Some(65535.0)),
        _ => {
            let found = format!("signed or wide whole numbers of {} bits", colour.bit_depth());
            return Err(Fault::Unsupported(found, REMEDY));
        }
    };
    Ok(Raster { width, height, values, full_range })
}

pub(super) fn encode(depth: &DepthMap) -> Result<Vec<u8>, String> {
    let mut file = Cursor::new(Vec::new());
    let side = |length: usize| u32::try_from(length).map_err(|error| error.to_string());
    let (width, height) = (side(depth.width())?, side(depth.height())?);
    TiffEncoder::new(&mut file)
        .and_then(|mut encoder| {
            encoder.write_image::<colortype::Gray32Float>(width, height, &depth.distances())
        })
        .map_err(|error| error.to_string())?;
    Ok(file.into_inner())
}

impl From<TiffError> for Fault {
    fn from(error: TiffError) -> Self {
        match error {
            TiffError::IoError(error) => error.into(),
            TiffError::UnsupportedError(found) => Self::Unsupported(found.to_string(), REMEDY),
            TiffError::LimitsExceeded => Self::TooLarge(error.to_string()),
            other => Self::Damaged(other.to_string()),
        }
    }
}
