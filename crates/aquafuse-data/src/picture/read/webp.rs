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
    let length = bytes.get(4..8).and_then(|length| length.try_into().ok()).map_or(0, u32::from_le_bytes);
    let whole = bytes.len() as u64 >= u64::from(length) + 8;
    let cause = || format!("it says that it has {} bytes", u64::from(length) + 8);
    if !whole && !lenient {
        return Err(Fault::CutShort(cause()));
    }
    let mut decoded = by_image(WebPDecoder::new(Cursor::new(bytes))?)?;
    decoded.damage = (!whole).then(cause);
    Ok(decoded)
}
