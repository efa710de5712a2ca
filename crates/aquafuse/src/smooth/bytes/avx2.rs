//! Weights and means of 16 pixels at once, by AVX2.

#![allow(unsafe_code, reason = "loads and stores of vectors, and the calls that need AVX2")]

use std::arch::x86_64::{
    __m128i, __m256i, _mm_loadu_si128, _mm_or_si128, _mm_packus_epi16, _mm_shuffle_epi8, _mm_storeu_si128,
    _mm256_abs_epi16, _mm256_add_epi16, _mm256_castsi256_si128, _mm256_cvtepi32_ps, _mm256_cvtepu8_epi16,
    _mm256_cvtps_epi32, _mm256_div_ps, _mm256_extracti128_si256, _mm256_loadu_si256, _mm256_min_epu16,
    _mm256_mul_ps, _mm256_mulhrs_epi16, _mm256_packs_epi32, _mm256_set1_epi16, _mm256_set1_ps,
    _mm256_setzero_si256, _mm256_slli_epi16, _mm256_srai_epi16, _mm256_srli_epi16, _mm256_storeu_si256,
    _mm256_sub_epi16, _mm256_unpackhi_epi16, _mm256_unpacklo_epi16,
};

use super::super::weights::{GROWTH, MOST, SHIFT, SQUARINGS};
use super::plain::{self, LOST, OWN, SCALE};
use super::{LANES, PART, Tap, Taps};
use crate::simd::Avx2;

/// [`super::plain::split`].
pub(super) fn split(_: Avx2, pixels: &[[u8; 3]], row: [&mut [i16]; 3]) {
    // SAFETY: the first argument proves that the processor has AVX2.
    unsafe { split_vectors(pixels, row) }
}

/// [`super::plain::join`].
pub(super) fn join(_: Avx2, means: [&[u8]; 3], pixels: &mut [[u8; 3]]) {
    // SAFETY: the first argument proves that the processor has AVX2.
    unsafe { join_vectors(means, pixels) }
}

/// [`super::plain::weigh`], of whole vectors.
pub(super) fn weigh(_: Avx2, own: [&[i16]; 3], other: [&[i16]; 3], found: &mut [i16]) {
    // SAFETY: the first argument proves that the processor has AVX2.
    unsafe { weigh_vectors(own, other, found) }
}

/// [`super::plain::average`].
pub(super) fn average(_: Avx2, taps: &Taps<'_>, blocks: usize, means: &mut [Vec<u8>; 3]) {
    // SAFETY: the first argument proves that the processor has AVX2.
    unsafe { average_vectors(taps, blocks, means) }
}

/// Picks no byte.
const NONE: u8 = 0x80;

/// For each channel and each third of 16 pixels, which byte of the third comes where in the channel.
const APART: [[[u8; LANES]; 3]; 3] = {
    let mut picks = [[[NONE; LANES]; 3]; 3];
    let mut byte = 0;
    while byte < 3 * LANES {
        picks[byte % 3][byte / LANES][byte / 3] = (byte % LANES) as u8;
        byte += 1;
    }
    picks
};

/// For each third of 16 pixels and each channel, which pixel's byte comes where in the third.
const TOGETHER: [[[u8; LANES]; 3]; 3] = {
    let mut picks = [[[NONE; LANES]; 3]; 3];
    let mut byte = 0;
    while byte < 3 * LANES {
        picks[byte / LANES][byte % 3][byte % LANES] = (byte / 3) as u8;
        byte += 1;
    }
    picks
};

/// The bytes that each of three vectors gives, put together.
#[inline]
#[target_feature(enable = "avx2")]
fn picked(from: [__m128i; 3], picks: &[[u8; LANES]; 3]) -> __m128i {
    let [a, b, c] = [0, 1, 2].map(|i| _mm_shuffle_epi8(from[i], load_bytes(&picks[i])));
    _mm_or_si128(_mm_or_si128(a, b), c)
}

#[target_feature(enable = "avx2")]
fn split_vectors(pixels: &[[u8; 3]], row: [&mut [i16]; 3]) {
    let (blocks, rest) = pixels.as_chunks::<LANES>();
    let [(r, r_rest), (g, g_rest), (b, b_rest)] = row.map(|channel| channel.as_chunks_mut::<LANES>());
    for (((pixels, r), g), b) in blocks.iter().zip(r).zip(g).zip(b) {
        let thirds = thirds_of(pixels);
        for (channel, picks) in [r, g, b].into_iter().zip(&APART) {
            let wide = _mm256_cvtepu8_epi16(picked(thirds, picks));
            store(channel, _mm256_slli_epi16::<{ PART as i32 }>(wide));
        }
    }
    plain::split(rest, [r_rest, g_rest, b_rest]);
}

#[target_feature(enable = "avx2")]
fn join_vectors(means: [&[u8]; 3], pixels: &mut [[u8; 3]]) {
    let (blocks, rest) = pixels.as_chunks_mut::<LANES>();
    let [(r, r_rest), (g, g_rest), (b, b_rest)] = means.map(|channel| channel.as_chunks::<LANES>());
    for (((pixels, r), g), b) in blocks.iter_mut().zip(r).zip(g).zip(b) {
        let channels = [load_bytes(r), load_bytes(g), load_bytes(b)];
        for (third, picks) in pixels.as_flattened_mut().as_chunks_mut().0.iter_mut().zip(&TOGETHER) {
            store_bytes(third, picked(channels, picks));
        }
    }
    plain::join([r_rest, g_rest, b_rest], rest);
}

#[inline]
#[target_feature(enable = "avx2")]
fn thirds_of(pixels: &[[u8; 3]; LANES]) -> [__m128i; 3] {
    let thirds: &[[u8; LANES]] = pixels.as_flattened().as_chunks().0;
    [load_bytes(&thirds[0]), load_bytes(&thirds[1]), load_bytes(&thirds[2])]
}

#[target_feature(enable = "avx2")]
fn weigh_vectors(own: [&[i16]; 3], other: [&[i16]; 3], found: &mut [i16]) {
    let most = _mm256_set1_epi16((MOST << PART) as i16);
    let growth = _mm256_set1_epi16(GROWTH);
    let all = _mm256_set1_epi16(i16::MAX);
    let found = found.as_chunks_mut::<LANES>().0;
    let blocks = found.len();
    let [a, b, c] = [start(own[0], blocks), start(own[1], blocks), start(own[2], blocks)];
    let [d, e, f] = [start(other[0], blocks), start(other[1], blocks), start(other[2], blocks)];
    for (x, found) in found.iter_mut().enumerate() {
        // SAFETY: every slice holds so many blocks, and is borrowed until the end.
        let at = |start: Start| load(unsafe { &*start.add(x) });
        let off = |own: Start, other: Start| _mm256_abs_epi16(_mm256_sub_epi16(at(own), at(other)));
        let difference = _mm256_add_epi16(_mm256_add_epi16(off(a, d), off(b, e)), off(c, f));
        let difference = _mm256_slli_epi16::<{ (SHIFT - PART) as i32 }>(_mm256_min_epu16(difference, most));
        let y = _mm256_mulhrs_epi16(_mm256_mulhrs_epi16(difference, difference), growth);
        let half_square = _mm256_srli_epi16::<1>(_mm256_mulhrs_epi16(y, y));
        let mut power = _mm256_add_epi16(_mm256_sub_epi16(all, y), half_square);
        for _ in 0..SQUARINGS {
            power = _mm256_mulhrs_epi16(power, power);
        }
        store(found, power);
    }
}

/// Where blocks begin.
type Start = *const [i16; LANES];

/// Where so many blocks begin; they are there.
fn start(values: &[i16], blocks: usize) -> Start {
    values[..blocks * LANES].as_ptr().cast()
}

#[target_feature(enable = "avx2")]
fn average_vectors(taps: &Taps<'_>, blocks: usize, means: &mut [Vec<u8>; 3]) {
    let zero = _mm256_setzero_si256();
    let three = |values: &[&[i16]; 3]| [0, 1, 2].map(|c| start(values[c], blocks));
    let around =
        taps.around.each_ref().map(|Tap { values, weights }| (three(values), start(weights, blocks)));
    let middle = three(&taps.middle);
    let [r, g, b] = means.each_mut().map(|channel| &mut channel.as_chunks_mut::<LANES>().0[..blocks]);
    for x in 0..blocks {
        // SAFETY: every slice holds so many blocks, and is borrowed for as long as `taps`.
        let at = |start: Start| load(unsafe { &*start.add(x) });
        let middle = [at(middle[0]), at(middle[1]), at(middle[2])];
        let mut sums = [zero; 3];
        let mut total = _mm256_set1_epi16(OWN as i16);
        for (values, weights) in &around {
            let weight = at(*weights);
            total = _mm256_add_epi16(total, _mm256_srli_epi16::<{ LOST as i32 }>(weight));
            for c in 0..3 {
                let off = _mm256_sub_epi16(at(values[c]), middle[c]);
                sums[c] = _mm256_add_epi16(sums[c], _mm256_mulhrs_epi16(weight, off));
            }
        }
        let scale = [_mm256_unpacklo_epi16(total, zero), _mm256_unpackhi_epi16(total, zero)];
        let scale = scale.map(|total| _mm256_div_ps(_mm256_set1_ps(SCALE), _mm256_cvtepi32_ps(total)));
        let mean = |c: usize| {
            let sign = _mm256_srai_epi16::<15>(sums[c]);
            let wide = [_mm256_unpacklo_epi16(sums[c], sign), _mm256_unpackhi_epi16(sums[c], sign)];
            let more = |i: usize| _mm256_cvtps_epi32(_mm256_mul_ps(_mm256_cvtepi32_ps(wide[i]), scale[i]));
            let own = _mm256_srli_epi16::<{ PART as i32 }>(middle[c]);
            let mean = _mm256_add_epi16(own, _mm256_packs_epi32(more(0), more(1)));
            let [low, high] = [_mm256_castsi256_si128(mean), _mm256_extracti128_si256::<1>(mean)];
            _mm_packus_epi16(low, high)
        };
        store_bytes(&mut r[x], mean(0));
        store_bytes(&mut g[x], mean(1));
        store_bytes(&mut b[x], mean(2));
    }
}

#[inline]
#[target_feature(enable = "avx2")]
fn load(lanes: &[i16; LANES]) -> __m256i {
    // SAFETY: the array is as long as the vector; the load asks for no alignment, and any bits are a vector.
    unsafe { _mm256_loadu_si256(lanes.as_ptr().cast()) }
}

#[inline]
#[target_feature(enable = "avx2")]
fn load_bytes(lanes: &[u8; LANES]) -> __m128i {
    // SAFETY: the array is as long as the vector; the load asks for no alignment, and any bits are a vector.
    unsafe { _mm_loadu_si128(lanes.as_ptr().cast()) }
}

#[inline]
#[target_feature(enable = "avx2")]
fn store(lanes: &mut [i16; LANES], vector: __m256i) {
    // SAFETY: the array is as long as the vector; the store asks for no alignment, and any bits are values.
    unsafe { _mm256_storeu_si256(lanes.as_mut_ptr().cast(), vector) }
}

#[inline]
#[target_feature(enable = "avx2")]
fn store_bytes(lanes: &mut [u8; LANES], vector: __m128i) {
    // SAFETY: the array is as long as the vector; the store asks for no alignment, and any bits are values.
    unsafe { _mm_storeu_si128(lanes.as_mut_ptr().cast(), vector) }
}
