//! Pixels of three bytes as words of four, which vectors take apart by shifts: red in the lowest byte, then green and blue.

#[cfg(all(feature = "simd", target_arch = "x86_64"))]
mod avx2;

use crate::simd::Level;

/// Packs as many pixels as there are words.
pub(crate) fn pack(level: Level, pixels: &[[u8; 3]], words: &mut [u32]) {
    match level {
        #[cfg(all(feature = "simd", target_arch = "x86_64"))]
        Level::Avx2(proof) => {
            let (blocks, rest) = pixels.as_chunks();
            let (to_blocks, to_rest) = words.as_chunks_mut();
            avx2::pack(proof, blocks, to_blocks);
            by_pixels(rest, to_rest);
        }
        _ => by_pixels(pixels, words),
    }
}

fn by_pixels(pixels: &[[u8; 3]], words: &mut [u32]) {
    for (word, &[r, g, b]) in words.iter_mut().zip(pixels) {
        *word = u32::from_le_bytes([r, g, b, 0]);
    }
}

/// Red, green and blue of a word.
#[inline(always)]
pub(crate) fn channels(word: u32) -> [u32; 3] {
    [word & 0xff, (word >> 8) & 0xff, word >> 16]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_instruction_set_packs_every_pixel() {
        for pixels in [0, 1, 7, 8, 9, 64, 100] {
            let image: Vec<[u8; 3]> =
                (0..pixels).map(|i| [0, 1, 2].map(|c| (71 * (3 * i + c)) as u8)).collect();
            for level in Level::all() {
                let mut words = vec![u32::MAX; pixels];
                pack(level, &image, &mut words);
                let unpacked: Vec<[u8; 3]> =
                    words.iter().map(|&word| channels(word).map(|value| value as u8)).collect();
                assert_eq!(unpacked, image, "{level:?}");
            }
        }
    }
}
