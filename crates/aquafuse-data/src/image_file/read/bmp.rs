//! BMP.

use std::io::{BufRead, Cursor, Seek};

use ::image::codecs::bmp::BmpDecoder;

use super::super::limits::Size;
use super::{Decoded, Fault, by_image, size_of};

pub(super) fn header(reader: &mut (impl BufRead + Seek)) -> Result<Size, Fault> {
    Ok(size_of(&BmpDecoder::new(reader)?))
}

pub(super) fn decode(bytes: &[u8], lenient: bool) -> Result<Decoded, Fault> {
    // The decoder reads on past the end of run-length coded pixels.
    let length = bytes.get(2..6).and_then(|length| length.try_into().ok()).map_or(0, u32::from_le_bytes);
    let whole = bytes.len() as u64 >= u64::from(length);
    let cause = || format!("it declares {length} bytes");
    if !whole && !lenient {
        return Err(Fault::CutShort(cause()));
    }
    let mut decoded = by_image(BmpDecoder::new(Cursor::new(bytes))?)?;
    decoded.damage = (!whole).then(cause);
    Ok(decoded)
}
