//! Depth as the sum of a term in red and a term in the stronger of green and blue: two byte tables.
//!
//! Between bytes, for images whose values lie closer together, the tables are interpolated.

use crate::image::Sample;
use crate::packed::{channels, pack};
use crate::simd::{self, Level, Work};

/// Levels of depth by red and by max(green, blue), in fixed point: no exponential a pixel, and the same
/// level on every machine that makes the same tables.
pub(super) struct Tables {
    of_red: [i32; 256],
    of_max: [i32; 256],
}

/// Fractional bits: the sum of two entries keeps the rounding of one exact sum.
const FRACTION: u32 = 16;
const ONE: f64 = 255.0 * (1 << FRACTION) as f64;

impl Tables {
    /// Tables of two terms, whose arguments are encoded values and whose sum is depth, both in `[0, 1]`.
    pub(super) fn of_terms(red: impl Fn(f64) -> f64, max: impl Fn(f64) -> f64) -> Self {
        let entry = |term: f64| (term * ONE).round() as i32;
        Self {
            of_red: std::array::from_fn(|byte| entry(red(byte as f64 / 255.0))),
            of_max: std::array::from_fn(|byte| entry(max(byte as f64 / 255.0))),
        }
    }

    /// Tables of whole levels: the level of depth is `of(max) - of(red)`, 0 at least.
    pub(super) fn of_difference(of: impl Fn(f64) -> f64) -> Self {
        let whole = |byte: usize| ((255.0 * of(byte as f64 / 255.0)).round() as i32) << FRACTION;
        Self { of_red: std::array::from_fn(|byte| -whole(byte)), of_max: std::array::from_fn(whole) }
    }

    /// The level of one colour.
    #[inline]
    pub(super) fn level(&self, red: u8, max: u8) -> u8 {
        let sum = self.of_red[usize::from(red)].saturating_add(self.of_max[usize::from(max)]);
        (sum.saturating_add(1 << (FRACTION - 1)) >> FRACTION).clamp(0, 255) as u8
    }

    /// The levels of all colours: for whole images, whose every pixel is then one look.
    pub(super) fn square(&self) -> Square {
        let level = |place: usize| self.level((place >> 8) as u8, place as u8);
        Square { levels: (0..COLOURS).map(level).collect() }
    }

    /// The depth of one colour of 16 bits in steps of 1 / 65535; [`Tables::level`] to the byte where the
    /// colour is one of bytes.
    #[inline]
    pub(super) fn fine(&self, red: u16, max: u16) -> u16 {
        let sum = between(&self.of_red, red) + between(&self.of_max, max);
        // A level is 257 of these steps.
        let steps = (sum * i64::from(WORDS_A_BYTE) + (1 << (FRACTION - 1))) >> FRACTION;
        steps.clamp(0, i64::from(u16::MAX)) as u16
    }

    /// [`Tables::fine`] of each pixel.
    pub(super) fn fine_row<T: Sample>(&self, pixels: &[[T; 3]], row: &mut [u16]) {
        for (depth, &[r, g, b]) in row.iter_mut().zip(pixels) {
            *depth = self.fine(r.to_word(), g.to_word().max(b.to_word()));
        }
    }
}

/// Pairs of red and max(green, blue).
const COLOURS: usize = 256 * 256;

/// The level of each pair of red and max(green, blue). 64 kB: neighbouring pixels use a small part of it.
#[derive(Clone)]
pub(super) struct Square {
    levels: Box<[u8]>,
}

/// Pixels whose places are found together, before any is looked up.
const BLOCK: usize = 64;

impl Square {
    /// The level of each pixel.
    pub(super) fn row<T: Sample>(&self, pixels: &[[T; 3]], row: &mut [u8]) {
        match T::bytes(pixels.as_flattened()) {
            Some(bytes) => self.row_of_bytes(Level::best(), bytes.as_chunks().0, row),
            None => {
                let levels = self.levels();
                for (level, pixel) in row.iter_mut().zip(pixels) {
                    *level = levels[usize::from(place(&pixel.map(T::to_byte)))];
                }
            }
        }
    }

    fn row_of_bytes(&self, level: Level, pixels: &[[u8; 3]], row: &mut [u8]) {
        let mut words = [0; BLOCK];
        for (pixels, row) in pixels.chunks(BLOCK).zip(row.chunks_mut(BLOCK)) {
            pack(level, pixels, &mut words[..pixels.len()]);
            simd::widest_by(level, ToPlaces { words: &mut words });
            for (level, &place) in row.iter_mut().zip(&words) {
                *level = self.levels()[place as usize % COLOURS];
            }
        }
    }

    fn levels(&self) -> &[u8; COLOURS] {
        self.levels.first_chunk().expect("all colours")
    }
}

/// Packed pixels become their indices in the square.
struct ToPlaces<'a> {
    words: &'a mut [u32; BLOCK],
}

impl Work for ToPlaces<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        for word in self.words {
            let [r, g, b] = channels(*word);
            *word = (r << 8) | g.max(b);
        }
    }
}

/// The index of a colour in the square.
#[inline]
fn place(&[r, g, b]: &[u8; 3]) -> u16 {
    u16::from_be_bytes([r, g.max(b)])
}

/// 65535 / 255: byte b is word 257 b.
const WORDS_A_BYTE: u16 = 257;

/// A table of bytes read at a word, on the line between the two entries around it.
#[inline]
fn between(table: &[i32; 256], word: u16) -> i64 {
    let (byte, part) = (usize::from(word / WORDS_A_BYTE), i64::from(word % WORDS_A_BYTE));
    let (low, high) = (i64::from(table[byte]), i64::from(table[(byte + 1).min(255)]));
    low + (high - low) * part / i64::from(WORDS_A_BYTE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::depth::Eq3;

    #[test]
    fn every_instruction_set_gives_the_level_of_every_colour() {
        let tables = Eq3::OURS.tables();
        let square = tables.square();
        // All reds with all of the larger of green and blue, which take turns; in pieces of odd lengths.
        let pixels: Vec<[u8; 3]> = (0..=u16::MAX)
            .map(|place| {
                let [red, max] = place.to_be_bytes();
                let less = red.min(max);
                if place % 3 == 0 { [red, max, less] } else { [red, less, max] }
            })
            .collect();
        let expected: Vec<u8> = pixels.iter().map(|&[r, g, b]| tables.level(r, g.max(b))).collect();
        for length in [1, 63, 64, 65, 1000, pixels.len()] {
            for level in Level::all() {
                let mut found = vec![0; pixels.len()];
                for (pixels, row) in pixels.chunks(length).zip(found.chunks_mut(length)) {
                    square.row_of_bytes(level, pixels, row);
                }
                assert_eq!(found, expected, "{level:?}, {length} at once");
            }
        }
    }
}
