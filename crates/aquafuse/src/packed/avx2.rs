//! Eight pixels packed at once, by AVX2.

#![allow(unsafe_code, reason = "loads and stores of vectors, and the call that needs AVX2")]

use std::arch::x86_64::{
    __m128i, _mm_loadu_si128, _mm256_set_m128i, _mm256_setr_epi8, _mm256_shuffle_epi8, _mm256_storeu_si256,
};

use crate::simd::Avx2;

/// Pixels packed at once.
const BLOCK: usize = 8;

/// [`super::pack`] of whole blocks.
#[inline]
pub(super) fn pack(_: Avx2, blocks: &[[[u8; 3]; BLOCK]], words: &mut [[u32; BLOCK]]) {
    // SAFETY: the first argument proves that the processor has AVX2.
    unsafe { inside(blocks, words) }
}

#[target_feature(enable = "avx2")]
fn inside(blocks: &[[[u8; 3]; BLOCK]], words: &mut [[u32; BLOCK]]) {
    // Red, green, blue and nothing, from four pixels at the start of 16 bytes and from four at their end.
    let spread = _mm256_setr_epi8(
        0, 1, 2, -1, 3, 4, 5, -1, 6, 7, 8, -1, 9, 10, 11, -1, 4, 5, 6, -1, 7, 8, 9, -1, 10, 11, 12, -1, 13,
        14, 15, -1,
    );
    for (block, words) in blocks.iter().zip(words) {
        let bytes: *const u8 = block.as_flattened().as_ptr();
        // SAFETY: eight pixels are 24 bytes, of which the first and the last 16 are read, aligned or not.
        let (first, last): (__m128i, __m128i) =
            unsafe { (_mm_loadu_si128(bytes.cast()), _mm_loadu_si128(bytes.add(8).cast())) };
        let rgb = _mm256_shuffle_epi8(_mm256_set_m128i(last, first), spread);
        // SAFETY: eight words of four bytes, aligned or not.
        unsafe { _mm256_storeu_si256(words.as_mut_ptr().cast(), rgb) };
    }
}
