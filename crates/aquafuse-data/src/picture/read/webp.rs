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
    Ok(Size { beside: size.beside + 4, ..size })
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
fn missing(bytes: &[u8]) -> u64 {
    let length = |at: usize| {
        let length = bytes.get(at..).and_then(|rest| rest.first_chunk()).copied();
        length.map(|length| u64::from(u32::from_le_bytes(length)))
    };
    let there = bytes.len() as u64;
    let end = length(4).map_or(0, |length| length + 8);
    let (mut furthest, mut at) = (end, 12);
    while let (true, Some(length)) = (at + 8 <= there, usize::try_from(at + 4).ok().and_then(length)) {
        // An odd length is padded, but the padding of the last chunk is often left out.
        furthest = furthest.max(at + 8 + length);
        at += 8 + length + length % 2;
    }
    furthest.saturating_sub(there)
}
