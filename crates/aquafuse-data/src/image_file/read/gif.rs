//! GIF: its first frame.

use std::io::{BufRead, Cursor, Seek};

use ::image::codecs::gif::GifDecoder;

use super::super::limits::Size;
use super::{Decoded, Fault, Pixels, by_image, size_of};

pub(super) fn header(reader: &mut (impl BufRead + Seek)) -> Result<Size, Fault> {
    // A frame is an image of its own within the screen.
    let size = size_of(&GifDecoder::new(reader)?);
    Ok(Size { beside: size.beside.saturating_add(4), ..size })
}

pub(super) fn decode(bytes: &[u8], lenient: bool) -> Result<Decoded, Fault> {
    let blocks = Blocks::count(bytes);
    let cause = || "its end is missing".to_owned();
    if !blocks.ended && !lenient {
        return Err(Fault::CutShort(cause()));
    }
    if blocks.is_larger_than_screen {
        return Err(Fault::Damaged("its first frame has more pixels than its screen".into()));
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
    /// Whether the first frame has more pixels than the screen, which is what memory was counted for.
    is_larger_than_screen: bool,
}

impl Blocks {
    fn count(bytes: &[u8]) -> Self {
        let mut found = Self::default();
        let _ = found.walk(bytes);
        found
    }

    fn walk(&mut self, bytes: &[u8]) -> Option<()> {
        let (&[_, _, _, _, _, _, w0, w1, h0, h1, flags, _background, _aspect], mut rest) =
            bytes.split_first_chunk::<13>()?;
        let screen = pixels([w0, w1, h0, h1]);
        pass_palette(&mut rest, flags)?;
        loop {
            match rest.split_off_first()? {
                0x21 => {
                    let _label = rest.split_off_first()?;
                }
                0x2c => {
                    self.frames = self.frames.saturating_add(1);
                    let &[_, _, _, _, w0, w1, h0, h1, flags] = rest.split_off(..9)? else { return None };
                    self.is_larger_than_screen |= self.frames == 1 && pixels([w0, w1, h0, h1]) > screen;
                    pass_palette(&mut rest, flags)?;
                    let _code_size = rest.split_off_first()?;
                }
                0x3b => {
                    self.ended = true;
                    return Some(());
                }
                _ => return None,
            }
            pass_sub_blocks(&mut rest)?;
        }
    }
}

/// Pixels of a screen or a frame, from its width and height in the file.
fn pixels([w0, w1, h0, h1]: [u8; 4]) -> u64 {
    u64::from(u16::from_le_bytes([w0, w1])).saturating_mul(u16::from_le_bytes([h0, h1]).into())
}

/// Bytes of a palette, by the last three bits of the flags that announce it.
const PALETTES: [usize; 8] = [6, 12, 24, 48, 96, 192, 384, 768];

fn pass_palette(rest: &mut &[u8], flags: u8) -> Option<()> {
    if flags & 0x80 != 0 {
        rest.split_off(..*PALETTES.get(usize::from(flags & 7))?)?;
    }
    Some(())
}

fn pass_sub_blocks(rest: &mut &[u8]) -> Option<()> {
    loop {
        match *rest.split_off_first()? {
            0 => return Some(()),
            length => rest.split_off(..usize::from(length))?,
        };
    }
}
