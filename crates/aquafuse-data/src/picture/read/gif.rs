//! GIF: its first frame.

use std::io::{BufRead, Cursor, Seek};

use ::image::codecs::gif::GifDecoder;

use super::super::limits::Size;
use super::{Decoded, Fault, Pixels, by_image, size_of};

pub(super) fn header(reader: &mut (impl BufRead + Seek)) -> Result<Size, Fault> {
    // A frame is a picture of its own within the screen.
    let size = size_of(&GifDecoder::new(reader)?);
    Ok(Size { beside: size.beside + 4, ..size })
}

pub(super) fn decode(bytes: &[u8], lenient: bool) -> Result<Decoded, Fault> {
    let blocks = Blocks::count(bytes);
    let cause = || "its end is missing".to_owned();
    if !blocks.ended && !lenient {
        return Err(Fault::CutShort(cause()));
    }
    let mut decoded = by_image(GifDecoder::new(Cursor::new(bytes))?)?;
    decoded.damage = (!blocks.ended).then(cause);
    decoded.metadata.leave_out(blocks.frames > 1, "the frames after the first");
    // Every GIF is decoded as if it were transparent somewhere.
    if let Pixels::Bytes(layers) = &mut decoded.pixels
        && layers.alpha.as_ref().is_some_and(|alpha| alpha.iter().all(|&opacity| opacity == u8::MAX))
    {
        layers.alpha = None;
    }
    Ok(decoded)
}

/// The blocks of a file: how many of them are frames, and whether the trailer was found.
#[derive(Default)]
struct Blocks {
    frames: usize,
    ended: bool,
}

impl Blocks {
    fn count(bytes: &[u8]) -> Self {
        let mut found = Self::default();
        let _ = found.walk(bytes);
        found
    }

    fn walk(&mut self, bytes: &[u8]) -> Option<()> {
        let mut at = 13 + palette(*bytes.get(10)?);
        loop {
            match bytes.get(at)? {
                0x21 => at = after_sub_blocks(bytes, at + 2)?,
                0x2c => {
                    self.frames += 1;
                    at = after_sub_blocks(bytes, at + 11 + palette(*bytes.get(at + 9)?))?;
                }
                0x3b => {
                    self.ended = true;
                    return Some(());
                }
                _ => return None,
            }
        }
    }
}

/// Bytes of the palette that a flag byte announces.
fn palette(flags: u8) -> usize {
    if flags & 0x80 == 0 { 0 } else { 3 << ((flags & 7) + 1) }
}

fn after_sub_blocks(bytes: &[u8], mut at: usize) -> Option<usize> {
    loop {
        match usize::from(*bytes.get(at)?) {
            0 => return Some(at + 1),
            length => at += 1 + length,
        }
    }
}
