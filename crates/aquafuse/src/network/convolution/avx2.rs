//! A convolution by AVX2: sixteen products and eight sums in two instructions.

#![allow(unsafe_code, reason = "loads and stores of vectors, and the call that needs AVX2")]

use std::arch::x86_64::{
    _mm256_add_epi32, _mm256_loadu_si256, _mm256_madd_epi16, _mm256_set1_epi32, _mm256_setzero_si256,
    _mm256_storeu_si256,
};

use super::{Convolve, LANES, Pair};
use crate::simd::Avx2;

/// Pixels of a row that share the weights once they are loaded, and blocks of channels that share a pixel.
const PIXELS: usize = 4;
const BLOCKS: usize = 2;

pub(super) fn run(_: Avx2, work: Convolve<'_>) {
    // SAFETY: the first argument proves that the processor has AVX2.
    unsafe { inside(work) }
}

#[target_feature(enable = "avx2")]
fn inside(mut work: Convolve<'_>) {
    let (width, blocks) = (work.output.width, work.by.to.div_ceil(LANES));
    for y in 0..work.output.height {
        let mut block = 0;
        while block < blocks {
            let many = if block + BLOCKS <= blocks { BLOCKS } else { 1 };
            let mut x = 0;
            while x < width {
                x += match (x + PIXELS <= width, many) {
                    (true, BLOCKS) => tile::<PIXELS, BLOCKS>(&mut work, x, y, block),
                    (true, _) => tile::<PIXELS, 1>(&mut work, x, y, block),
                    (false, BLOCKS) => tile::<1, BLOCKS>(&mut work, x, y, block),
                    (false, _) => tile::<1, 1>(&mut work, x, y, block),
                };
            }
            block += many;
        }
    }
}

/// So many pixels from column `x` on, and blocks from `block` on; how many pixels those are.
#[target_feature(enable = "avx2")]
#[inline]
fn tile<const PIXELS: usize, const BLOCKS: usize>(
    work: &mut Convolve<'_>,
    x: usize,
    y: usize,
    block: usize,
) -> usize {
    let (by, input, inset) = (work.by, work.input, work.inset());
    let pairs = input.pairs;
    let mut sums = [[_mm256_setzero_si256(); BLOCKS]; PIXELS];
    // Loops and no closures, which would be called, and not inlined.
    let (mut pixels, mut weights): ([&[i32]; PIXELS], [&[Pair]; BLOCKS]) = ([&[]; PIXELS], [&[]; BLOCKS]);
    for dy in 0..by.side {
        for dx in 0..by.side {
            for (i, pixel) in pixels.iter_mut().enumerate() {
                *pixel = &input.at(x + i + inset + dx, y + inset + dy)[..pairs];
            }
            for (i, weights) in weights.iter_mut().enumerate() {
                *weights = &by.at(block + i, dx, dy)[..pairs];
            }
            for pair in 0..pairs {
                for i in 0..BLOCKS {
                    // SAFETY: a pair of weights is 32 bytes, aligned or not.
                    let weights = unsafe { _mm256_loadu_si256(weights[i][pair].as_ptr().cast()) };
                    for pixel in 0..PIXELS {
                        let both = _mm256_set1_epi32(pixels[pixel][pair]);
                        let products = _mm256_madd_epi16(both, weights);
                        sums[pixel][i] = _mm256_add_epi32(sums[pixel][i], products);
                    }
                }
            }
        }
    }
    for (pixel, sums) in sums.into_iter().enumerate() {
        for (i, sums) in sums.into_iter().enumerate() {
            let mut lanes = [0_i32; LANES];
            // SAFETY: eight sums of four bytes, aligned or not.
            unsafe { _mm256_storeu_si256(lanes.as_mut_ptr().cast(), sums) };
            work.store(lanes, x + pixel, y, block + i);
        }
    }
    PIXELS
}
