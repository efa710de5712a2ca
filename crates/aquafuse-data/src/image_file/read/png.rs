//! PNG: every colour type and depth, palettes and interlacing.

use std::io::{BufRead, Cursor, Seek};

use ::png::{BitDepth, ColorType, Decoder, DecodingError, Limits, Reader, Transformations, Unit};
use aquafuse::image::{Image, ImageError, Sample};

use super::super::limits::Size;
use super::super::metadata::{Metadata, Resolution, ResolutionUnit};
use super::super::pixels::Layers;
use super::{Decoded, Fault, Pixels};

/// What the decoder may take beside the pixels: rows, and a colour profile once it is inflated.
const BESIDE: usize = 24 << 20;

pub(super) fn header(reader: &mut (impl BufRead + Seek)) -> Result<Size, Fault> {
    let mut head = [0; 26];
    reader.read_exact(&mut head)?;
    let [.., b'I', b'H', b'D', b'R', x3, x2, x1, x0, y3, y2, y1, y0, bits, _colour] = head else {
        return Err(Fault::Damaged("its header is missing".into()));
    };
    let side = |bytes| u64::from(u32::from_be_bytes(bytes));
    let (width, height) = (side([x3, x2, x1, x0]), side([y3, y2, y1, y0]));
    let (sample, beside) = if bits == 16 { (2, 8) } else { (1, 4) };
    // Whatever it says here, it may turn out to be transparent.
    Ok(Size { width, height, channels: 4, sample, beside, tables: 0 })
}

pub(super) fn decode(bytes: &[u8], lenient: bool) -> Result<Decoded, Fault> {
    let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), Limits { bytes: BESIDE });
    decoder.set_transformations(Transformations::EXPAND);
    decoder.set_ignore_text_chunk(true);
    let mut reader = decoder.read_info()?;
    if reader.info().animation_control().is_some() {
        return Err(Fault::Unsupported(
            "an animation".into(),
            "Save the frame you mean as an image of its own",
        ));
    }
    let size =
        reader.output_buffer_size().ok_or_else(|| Fault::TooLarge("it does not fit into memory".into()))?;
    let mut samples = vec![0; size];
    let read = reader.next_frame(&mut samples).map(|_| ()).and_then(|()| reader.finish());
    let damage = match read.map_err(Fault::from) {
        Ok(()) => None,
        // Rows that are missing stay black.
        Err(Fault::CutShort(cause)) if lenient => Some(cause),
        Err(fault) => return Err(fault),
    };
    let mut metadata = metadata(&reader);
    metadata.leave_out(has_texts(bytes), "its text chunks");
    let (width, height) = reader.info().size();
    let (width, height) = (width as usize, height as usize);
    let (colour, depth) = reader.output_color_type();
    let pixels = match depth {
        BitDepth::Sixteen => {
            let words: Vec<u16> =
                samples.as_chunks().0.iter().map(|&word| u16::from_be_bytes(word)).collect();
            drop(samples);
            layers(colour, width, height, words).map(Pixels::Words)
        }
        _ => layers(colour, width, height, samples).map(Pixels::Bytes),
    };
    Ok(Decoded { pixels: pixels.map_err(|size| Fault::Damaged(size.to_string()))?, metadata, damage })
}

/// Whether there are chunks of text, XMP among them.
fn has_texts(bytes: &[u8]) -> bool {
    let mut rest = bytes.get(8..).unwrap_or_default();
    while let Some((length, after)) = rest.split_first_chunk() {
        let length = u32::from_be_bytes(*length) as usize;
        if matches!(after.get(..4), Some(b"tEXt" | b"zTXt" | b"iTXt")) {
            return true;
        }
        // The name before, the check sum after what the length counts.
        rest = length.checked_add(8).and_then(|end| after.get(end..)).unwrap_or_default();
    }
    false
}

fn layers<T: Sample>(
    colour: ColorType,
    width: usize,
    height: usize,
    all: Vec<T>,
) -> Result<Layers<T>, ImageError> {
    match colour {
        ColorType::Rgb => Image::from_raw(width, height, all).map(|image| Layers { image, alpha: None }),
        ColorType::Rgba => Layers::of_rgba(width, height, &all),
        ColorType::GrayscaleAlpha => Layers::of_grey_alpha(width, height, &all),
        ColorType::Grayscale | ColorType::Indexed => Layers::of_grey(width, height, &all),
    }
}

fn metadata<R: BufRead + Seek>(reader: &Reader<R>) -> Metadata {
    let info = reader.info();
    let mut metadata =
        Metadata { exif: info.exif_metadata.as_deref().map(<[u8]>::to_vec), ..Metadata::default() };
    metadata.set_profile(info.icc_profile.as_deref().map(<[u8]>::to_vec));
    metadata.resolution = info.pixel_dims.map(|pixels| Resolution {
        density: (pixels.xppu.into(), pixels.yppu.into()),
        unit: match pixels.unit {
            Unit::Meter => ResolutionUnit::Metre,
            Unit::Unspecified => ResolutionUnit::Unknown,
        },
    });
    metadata
}

impl From<DecodingError> for Fault {
    fn from(error: DecodingError) -> Self {
        match error {
            DecodingError::IoError(error) => error.into(),
            DecodingError::LimitsExceeded => Self::TooLarge("its metadata is too large".into()),
            other => Self::Damaged(other.to_string()),
        }
    }
}
