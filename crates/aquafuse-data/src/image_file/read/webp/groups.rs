//! How many groups of prefix codes a lossless image has: its decoder makes tables for each, of kilobytes for a few bytes.
//!
//! Each block of the image names its group in an image of its own, and whatever number is the largest there is how many
//! there are. What stands before it is read, and nothing is kept: copies and remembered colours repeat numbers that were seen.
//! RFC 9649, 3.4 to 3.7.

use std::io::{self, BufRead, ErrorKind, Read};

/// Bytes that the tables of a group take, and more for each colour that it may remember.
const GROUP: u64 = 32 << 10;
const REMEMBERED: u64 = 16;
/// Literals of green, then lengths of copies, then remembered colours.
const LITERALS: usize = 256;
const LENGTHS: u32 = 24;
const DISTANCES: usize = 40;
/// The order in which the lengths of the codes of lengths stand.
const ORDER: [usize; 19] = [17, 18, 0, 1, 2, 3, 4, 5, 16, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15];
const LONGEST: usize = 15;

/// Bytes of the tables of an image of this size, whose stream begins with its transforms.
///
/// # Errors
///
/// When the stream ends or holds what it must not: its decoder will say so too.
pub(super) fn memory(stream: impl BufRead, width: u64, height: u64) -> io::Result<u64> {
    let mut bits = Bits { from: stream.bytes(), held: 0, count: 0 };
    let mut width = width;
    let mut seen = [false; 4];
    while bits.take(1)? == 1 {
        let kind = usize::try_from(bits.take(2)?).unwrap_or(0);
        let before = seen.get_mut(kind).map(|seen| std::mem::replace(seen, true));
        if before == Some(true) {
            return Err(wrong());
        }
        match kind {
            0 | 1 => {
                let side = bits.take(3)?.saturating_add(2);
                largest(&mut bits, blocks(width, side), blocks(height, side))?;
            }
            2 => {}
            _ => {
                let colours = bits.take(8)?.saturating_add(1);
                largest(&mut bits, u64::from(colours), 1)?;
                width = blocks(
                    width,
                    [(2, 3), (4, 2), (16, 1)].iter().find(|of| colours <= of.0).map_or(0, |of| of.1),
                );
            }
        }
    }
    let remembered = remembered(&mut bits)?;
    let groups = match bits.take(1)? {
        0 => 1,
        _ => {
            let side = bits.take(3)?.saturating_add(2);
            u64::from(largest(&mut bits, blocks(width, side), blocks(height, side))?).saturating_add(1)
        }
    };
    let of_one = GROUP.saturating_add(REMEMBERED.saturating_mul(remembered as u64));
    Ok(groups.saturating_mul(of_one))
}

/// The largest number, red and green together, in an image that helps to decode the image.
fn largest<R: Read>(bits: &mut Bits<R>, width: u64, height: u64) -> io::Result<u32> {
    let green = LITERALS.saturating_add(LENGTHS as usize).saturating_add(remembered(bits)?);
    let [green, red, blue, alpha, distance] =
        [green, LITERALS, LITERALS, LITERALS, DISTANCES].map(|symbols| Code::read(bits, symbols));
    let [green, red, blue, alpha, distance] = [green?, red?, blue?, alpha?, distance?];
    let nothing_follows = [&green, &red, &blue, &alpha].iter().all(|code| code.only().is_some());
    let (mut left, mut largest) = (width.saturating_mul(height), 0);
    while left > 0 {
        let symbol = green.next(bits)?;
        let mut pixels = 1;
        if let Some(length) = symbol.checked_sub(256).filter(|length| *length < LENGTHS) {
            pixels = extended(bits, length)?;
            let distance = distance.next(bits)?;
            extended(bits, distance)?;
        } else if symbol < 256 {
            largest = largest.max(red.next(bits)? << 8 | symbol);
            blue.next(bits)?;
            alpha.next(bits)?;
            if nothing_follows {
                break;
            }
        }
        left = left.checked_sub(pixels).ok_or_else(wrong)?;
    }
    Ok(largest)
}

/// A length or distance: its prefix says how many bits follow.
fn extended<R: Read>(bits: &mut Bits<R>, prefix: u32) -> io::Result<u64> {
    if prefix < 4 {
        return Ok(u64::from(prefix).saturating_add(1));
    }
    let more = prefix.saturating_sub(2) >> 1;
    let from = u64::from(2 | prefix & 1) << more;
    Ok(from.saturating_add(u64::from(bits.take(more)?)).saturating_add(1))
}

/// How many colours are remembered.
fn remembered<R: Read>(bits: &mut Bits<R>) -> io::Result<usize> {
    match bits.take(1)? {
        0 => Ok(0),
        _ => Some(bits.take(4)?).filter(|of| (1..=11).contains(of)).map(|of| 1 << of).ok_or_else(wrong),
    }
}

fn blocks(length: u64, side: u32) -> u64 {
    length.div_ceil(1 << side)
}

/// A canonical prefix code.
struct Code {
    /// Codes of each length.
    counts: [u32; LONGEST + 1],
    /// By length, then in their order.
    symbols: Vec<u32>,
}

impl Code {
    fn read<R: Read>(bits: &mut Bits<R>, symbols: usize) -> io::Result<Self> {
        if bits.take(1)? == 1 {
            let two = bits.take(1)? == 1;
            let wide = bits.take(1)? == 1;
            let mut given = vec![bits.take(if wide { 8 } else { 1 })?];
            if two {
                given.push(bits.take(8)?);
            }
            let mut counts = [0; LONGEST + 1];
            counts[1] = if two { 2 } else { 1 };
            return Ok(Self { counts, symbols: given });
        }
        let mut of_lengths = [0; ORDER.len()];
        let given = bits.take(4)?.saturating_add(4) as usize;
        for place in ORDER.iter().take(given) {
            if let Some(length) = of_lengths.get_mut(*place) {
                *length = bits.take(3)?;
            }
        }
        let of_lengths = Self::of(&of_lengths)?;
        let mut codes = match bits.take(1)? {
            0 => symbols,
            _ => {
                let wide = bits.take(3)?.saturating_mul(2).saturating_add(2);
                (bits.take(wide)? as usize).saturating_add(2)
            }
        };
        let (mut lengths, mut before) = (Vec::with_capacity(symbols), 8);
        while lengths.len() < symbols && codes > 0 {
            codes = codes.saturating_sub(1);
            let (length, times) = match of_lengths.next(bits)? {
                16 => (before, bits.take(2)?.saturating_add(3)),
                17 => (0, bits.take(3)?.saturating_add(3)),
                18 => (0, bits.take(7)?.saturating_add(11)),
                length => (length, 1),
            };
            before = if length == 0 { before } else { length };
            lengths.extend(std::iter::repeat_n(length, times as usize));
        }
        if lengths.len() > symbols { Err(wrong()) } else { Self::of(&lengths) }
    }

    /// The code with these lengths, 0 for symbols that have none.
    fn of(lengths: &[u32]) -> io::Result<Self> {
        let mut counts = [0_u32; LONGEST + 1];
        let mut symbols = Vec::new();
        for (length, count) in counts.iter_mut().enumerate().skip(1) {
            for (symbol, _) in (0_u32..).zip(lengths).filter(|(_, of)| **of as usize == length) {
                symbols.push(symbol);
                *count = count.saturating_add(1);
            }
        }
        if symbols.is_empty() { Err(wrong()) } else { Ok(Self { counts, symbols }) }
    }

    /// Its symbol, if there is but one: that takes no bits.
    fn only(&self) -> Option<u32> {
        match self.symbols[..] {
            [only] => Some(only),
            _ => None,
        }
    }

    fn next<R: Read>(&self, bits: &mut Bits<R>) -> io::Result<u32> {
        if let Some(only) = self.only() {
            return Ok(only);
        }
        let (mut code, mut first, mut before) = (0_u32, 0_u32, 0_u32);
        for count in self.counts.iter().skip(1) {
            code |= bits.take(1)?;
            let at = code.wrapping_sub(first);
            if at < *count {
                let symbol = self.symbols.get(before.saturating_add(at) as usize);
                return symbol.copied().ok_or_else(wrong);
            }
            before = before.saturating_add(*count);
            first = first.saturating_add(*count) << 1;
            code <<= 1;
        }
        Err(wrong())
    }
}

/// Bits, the lowest of each byte first.
struct Bits<R> {
    from: io::Bytes<R>,
    held: u32,
    count: u32,
}

impl<R: Read> Bits<R> {
    /// At most 24 of them.
    fn take(&mut self, count: u32) -> io::Result<u32> {
        while self.count < count {
            let byte = self.from.next().ok_or_else(|| io::Error::from(ErrorKind::UnexpectedEof))??;
            self.held |= u32::from(byte) << self.count;
            self.count = self.count.saturating_add(8);
        }
        let taken = self.held & (1_u32 << count).wrapping_sub(1);
        self.held >>= count;
        self.count = self.count.saturating_sub(count);
        Ok(taken)
    }
}

fn wrong() -> io::Error {
    io::Error::new(ErrorKind::InvalidData, "this is no lossless WebP")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image_file::{ImageFile, ReadOptions, WriteOptions};
    use aquafuse::image::Image;

    /// Numbers in so many bits each, the lowest first.
    fn stream(numbers: &[(u32, u32)]) -> Vec<u8> {
        let bits = numbers.iter().flat_map(|&(number, count)| (0..count).map(move |bit| number >> bit & 1));
        let bits: Vec<u32> = bits.collect();
        bits.chunks(8).map(|byte| byte.iter().rev().fold(0, |sum, bit| sum << 1 | bit) as u8).collect()
    }

    /// A code of one symbol of eight bits.
    const fn only(symbol: u32) -> [(u32, u32); 4] {
        [(1, 1), (0, 1), (1, 1), (symbol, 8)]
    }

    /// No transforms, nothing remembered, groups by blocks of four, and one block that names this group.
    fn names(red: u32, green: u32) -> Vec<u8> {
        let codes = [green, red, 0, 0, 0].map(only).concat();
        stream(&[&[(0, 1), (0, 1), (1, 1), (0, 3), (0, 1)][..], &codes].concat())
    }

    #[test]
    fn groups_are_as_many_as_the_largest_that_is_named() {
        assert_eq!(memory(names(0, 4).as_slice(), 4, 4).unwrap(), 5 * GROUP);
        assert_eq!(memory(names(255, 255).as_slice(), 4, 4).unwrap(), 65_536 * GROUP);
        // Without blocks there is one, and tables for remembered colours are larger.
        assert_eq!(
            memory(stream(&[(0, 1), (1, 1), (2, 4), (0, 1)]).as_slice(), 4, 4).unwrap(),
            GROUP + 4 * REMEMBERED
        );
        let cut = names(255, 255);
        assert!(memory(&cut[..cut.len() - 2], 4, 4).is_err());
    }

    #[test]
    fn a_small_image_with_tables_of_gigabytes_is_refused_from_its_header() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.webp");
        let size = stream(&[(0x2f, 8), (3, 14), (3, 14), (0, 1), (0, 3)]);
        let chunk = [size, names(255, 255)].concat();
        let length = |bytes: usize| u32::try_from(bytes).unwrap().to_le_bytes();
        let body = [b"WEBPVP8L", &length(chunk.len())[..], &chunk].concat();
        std::fs::write(&path, [b"RIFF", &length(body.len())[..], &body].concat()).unwrap();
        let refused = ImageFile::open(&path, &ReadOptions::default()).err().unwrap().to_string();
        assert!(refused.contains("--max-memory"), "{refused}");
    }

    #[test]
    fn what_we_write_ourselves_is_read_to_its_one_group() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.webp");
        let image: Image<u8> = Image::from_raw(5, 3, (0..45).collect()).unwrap();
        ImageFile::new(image).write(&path, &WriteOptions::default()).unwrap();
        let written = std::fs::read(&path).unwrap();
        let chunk = written.windows(4).position(|name| name == b"VP8L").unwrap();
        assert_eq!(memory(&written[chunk + 13..], 5, 3).unwrap() / GROUP, 1);
    }
}
