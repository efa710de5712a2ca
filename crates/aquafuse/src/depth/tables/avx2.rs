//! The index of colours in the square, eight pixels at once, by AVX2.

#![allow(unsafe_code, reason = "loads and stores of vectors, and the call that needs AVX2")]

use std::arch::x86_64::{
    __m128i, _mm_loadu_si128, _mm256_and_si256, _mm256_max_epu8, _mm256_or_si256, _mm256_set_m128i,
    _mm256_set1_epi32, _mm256_setr_epi8, _mm256_shuffle_epi8, _mm256_slli_epi32, _mm256_srli_epi32,
    _mm256_storeu_si256,
};

use crate::simd::Avx2;

/// [`super::place`] of each pixel.
#[inline]
pub(super) fn places(_: Avx2, pixels: &[[u8; 3]; super::BLOCK], places: &mut [u32; super::BLOCK]) {
    // SAFETY: the first argument proves that the processor has AVX2.
    unsafe { inside(pixels, places) }
}

#[target_feature(enable = "avx2")]
fn inside(pixels: &[[u8; 3]; super::BLOCK], places: &mut [u32; super::BLOCK]) {
    // Red, green, blue and nothing, from four pixels at the start of 16 bytes and from four at their end.
    let spread = _mm256_setr_epi8(
        0, 1, 2, -1, 3, 4, 5, -1, 6, 7, 8, -1, 9, 10, 11, -1, 4, 5, 6, -1, 7, 8, 9, -1, 10, 11, 12, -1, 13,
        14, 15, -1,
    );
    let byte = _mm256_set1_epi32(0xff);
    let (eights, _) = pixels.as_chunks::<8>();
    let (to_eights, _) = places.as_chunks_mut::<8>();
    for (eight, places) in eights.iter().zip(to_eights) {
        let bytes: *const u8 = eight.as_flattened().as_ptr();
        // SAFETY: eight pixels are 24 bytes, of which the first and the last 16 are read, aligned or not.
        let (first, last): (__m128i, __m128i) =
            unsafe { (_mm_loadu_si128(bytes.cast()), _mm_loadu_si128(bytes.add(8).cast())) };
        let rgb = _mm256_shuffle_epi8(_mm256_set_m128i(last, first), spread);
        let max = _mm256_max_epu8(_mm256_srli_epi32::<8>(rgb), _mm256_srli_epi32::<16>(rgb));
        let red = _mm256_slli_epi32::<8>(_mm256_and_si256(rgb, byte));
        let place = _mm256_or_si256(red, _mm256_and_si256(max, byte));
        // SAFETY: eight places of four bytes, aligned or not.
        unsafe { _mm256_storeu_si256(places.as_mut_ptr().cast(), place) };
    }
}
