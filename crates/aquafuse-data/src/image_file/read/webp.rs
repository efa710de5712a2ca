//! WebP: lossy and lossless, one frame.

mod groups;

use std::io::{self, BufRead, Cursor, Read, Seek, SeekFrom};

use ::image::codecs::webp::WebPDecoder;

use super::super::limits::Size;
use super::{Decoded, Fault, by_image, size_of};

pub(super) fn header(reader: &mut (impl BufRead + Seek)) -> Result<Size, Fault> {
    let decoder = WebPDecoder::new(&mut *reader)?;
    if decoder.has_animation() {
        return Err(Fault::Unsupported(
            "an animation".into(),
            "Save the frame you mean as an image of its own",
        ));
    }
    // Lossless is decoded to four samples first.
    let size = size_of(&decoder);
    reader.seek(SeekFrom::Start(0))?;
    // What cannot be read here is none of the decoder's either, and its error is the better one.
    let tables = tables(reader, size.width, size.height).unwrap_or(0);
    Ok(Size { beside: size.beside.saturating_add(4), tables, ..size })
}

/// Bytes of the tables that decoding takes, of the image or of its opacity.
fn tables(reader: &mut (impl BufRead + Seek), width: u64, height: u64) -> io::Result<u64> {
    let mut head = [0; 12];
    reader.read_exact(&mut head)?;
    loop {
        let (mut name, mut length) = ([0; 4], [0; 4]);
        reader.read_exact(&mut name)?;
        reader.read_exact(&mut length)?;
        let length = u64::from(u32::from_le_bytes(length));
        match &name {
            // Before the stream: a letter, the size and what may be said of it.
            b"VP8L" => {
                let mut stream = reader.take(length);
                stream.read_exact(&mut [0; 5])?;
                return groups::memory(stream, width, height);
            }
            b"ALPH" => {
                let mut stream = reader.take(length);
                let mut way = [0];
                stream.read_exact(&mut way)?;
                return if way[0] & 3 == 1 { groups::memory(stream, width, height) } else { Ok(0) };
            }
            b"VP8 " => return Ok(0),
            _ => {
                reader.seek_relative(i64::try_from(length.saturating_add(length & 1)).unwrap_or(i64::MAX))?;
            }
        }
    }
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
