//! WebP: lossy and lossless, one frame.

use std::io::{BufRead, Cursor, Seek};

use ::image::codecs::webp::WebPDecoder;

use super::super::limits::Size;
use super::{Decoded, Fault, by_image, size_of};

pub(super) fn header(reader: &mut (impl BufRead + Seek)) -> Result<Size, Fault> {
    let decoder = WebPDecoder::new(reader)?;
    if decoder.has_animation() {
        return Err(Fault::Unsupported(
            "an animation".into(),
            "Save the frame you mean as a picture of its own",
        ));
    }
    // Lossless is decoded to four samples first.
    let size = size_of(&decoder);
    Ok(Size { beside: size.beside.saturating_add(4), ..size })
}

pub(super) fn decode(bytes: &[u8], lenient: bool) -> Result<Decoded, Fault> {
    let missing = missing(bytes);
    let cause = || format!("{missing} bytes are missing");
    if missing > 0 && !lenient {
        return Err(Fault::CutShort(cause()));
    }
    let mut decoded = by_image(WebPDecoder::new(Cursor::new(bytes))?)?;
    decoded.damage = (missing > 0).then(cause);
    Ok(decoded)
}

/// How many bytes fewer there are than the file, or one of its chunks, says.
fn missing(bytes: &[u8]) -> usize {
    let Some((length, content)) = chunk(bytes) else { return 0 };
    let mut missing = length.saturating_sub(content.len());
    // What kind of file it is, then chunks.
    let mut rest = content.get(4..).unwrap_or_default();
    while let Some((length, content)) = chunk(rest) {
        missing = missing.max(length.saturating_sub(content.len()));
        // An odd length is padded, but the padding of the last chunk is often left out.
        let padded = length.checked_next_multiple_of(2);
        rest = padded.and_then(|padded| content.get(padded..)).unwrap_or_default();
    }
    missing
}

/// How many bytes a chunk says that it holds, and whatever comes after that.
fn chunk(bytes: &[u8]) -> Option<(usize, &[u8])> {
    let (_name, rest) = bytes.split_first_chunk::<4>()?;
    let (length, rest) = rest.split_first_chunk()?;
    Some((usize::try_from(u32::from_le_bytes(*length)).ok()?, rest))
}
