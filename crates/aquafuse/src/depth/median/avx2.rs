//! The median of 32 bytes or 16 words at once, by AVX2.

#![allow(unsafe_code, reason = "loads and stores of vectors, and the call that needs AVX2")]

use std::arch::x86_64::{
    __m256i, _mm256_loadu_si256, _mm256_max_epu8, _mm256_max_epu16, _mm256_min_epu8, _mm256_min_epu16,
    _mm256_storeu_si256,
};

use super::kernel::{comparators, pair_kernel};
use super::network::{middle_of, select, sort_6, sort_7};
use super::{CORE, PAIR_ROWS, SIDE};
use crate::simd::Avx2;

/// [`super::plain::pair`] of bytes.
pub(super) fn pair_of_bytes(
    _: Avx2,
    rows: &[&[u8]; PAIR_ROWS],
    planes: &mut [Vec<u8>; CORE],
    above: &mut [u8],
    below: &mut [u8],
) {
    // SAFETY: the first argument proves that the processor has AVX2.
    unsafe { bytes(rows, planes, above, below) }
}

/// [`super::plain::pair`] of words.
pub(super) fn pair_of_words(
    _: Avx2,
    rows: &[&[u16]; PAIR_ROWS],
    planes: &mut [Vec<u16>; CORE],
    above: &mut [u16],
    below: &mut [u16],
) {
    // SAFETY: the first argument proves that the processor has AVX2.
    unsafe { words(rows, planes, above, below) }
}

pair_kernel! {
    #[target_feature(enable = "avx2")]
    fn bytes(values: u8, lanes: 32, load: load, store: store, min: _mm256_min_epu8, max: _mm256_max_epu8)
}
pair_kernel! {
    #[target_feature(enable = "avx2")]
    fn words(values: u16, lanes: 16, load: load, store: store, min: _mm256_min_epu16, max: _mm256_max_epu16)
}

#[inline]
#[target_feature(enable = "avx2")]
fn load<T>(values: &[T], x: usize) -> __m256i {
    let lanes = &values[x..x + size_of::<__m256i>() / size_of::<T>()];
    // SAFETY: the slice is as long as the vector; the load asks for no alignment, and any bits are a vector.
    unsafe { _mm256_loadu_si256(lanes.as_ptr().cast()) }
}

#[inline]
#[target_feature(enable = "avx2")]
fn store<T>(values: &mut [T], x: usize, vector: __m256i) {
    let lanes = &mut values[x..x + size_of::<__m256i>() / size_of::<T>()];
    // SAFETY: the slice is as long as the vector; the store asks for no alignment. T is u8 or u16 here, of which
    // any bits are a value.
    unsafe { _mm256_storeu_si256(lanes.as_mut_ptr().cast(), vector) }
}
