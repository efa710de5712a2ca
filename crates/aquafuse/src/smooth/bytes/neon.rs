//! Weights and means of 8 pixels at once, by NEON.

#![allow(unsafe_code, reason = "loads and stores of vectors, and the calls that need NEON")]

use std::arch::aarch64::{
    float32x4_t, int16x8_t, uint16x8_t, vabdq_s16, vaddq_s16, vaddq_u16, vcombine_s16, vcvtnq_s32_f32,
    vcvtq_f32_s32, vcvtq_f32_u32, vdivq_f32, vdupq_n_f32, vdupq_n_s16, vdupq_n_u16, vget_high_s16,
    vget_high_u16, vget_low_s16, vget_low_u16, vld1q_s16, vminq_u16, vmovl_s16, vmovl_u16, vmovn_s32,
    vmulq_f32, vqmovun_s16, vqrdmulhq_s16, vreinterpretq_s16_u16, vreinterpretq_u16_s16, vshlq_n_u16,
    vshrq_n_s16, vshrq_n_u16, vst1_u8, vst1q_s16, vsubq_s16,
};

use super::super::weights::{GROWTH, MOST, SHIFT, SQUARINGS};
use super::plain::{LOST, OWN, SCALE};
use super::{LANES, PART, Tap, Taps};

/// Pixels of a vector; blocks are whole vectors.
const VECTOR: usize = 8;

/// [`super::plain::weigh`], of whole vectors.
pub(super) fn weigh(own: [&[i16]; 3], other: [&[i16]; 3], found: &mut [i16]) {
    // SAFETY: NEON is part of this architecture.
    unsafe { weigh_vectors(own, other, found) }
}

/// [`super::plain::average`].
pub(super) fn average(taps: &Taps<'_>, blocks: usize, means: &mut [Vec<u8>; 3]) {
    // SAFETY: NEON is part of this architecture.
    unsafe { average_vectors(taps, blocks, means) }
}

#[target_feature(enable = "neon")]
fn weigh_vectors(own: [&[i16]; 3], other: [&[i16]; 3], found: &mut [i16]) {
    let most = vdupq_n_u16(MOST << PART);
    let growth = vdupq_n_s16(GROWTH);
    let all = vdupq_n_s16(i16::MAX);
    for x in (0..found.len()).step_by(VECTOR) {
        let off = |c: usize| vreinterpretq_u16_s16(vabdq_s16(load(own[c], x), load(other[c], x)));
        let difference = vaddq_u16(vaddq_u16(off(0), off(1)), off(2));
        let difference = vshlq_n_u16::<{ (SHIFT - PART) as i32 }>(vminq_u16(difference, most));
        let difference = vreinterpretq_s16_u16(difference);
        let y = vqrdmulhq_s16(vqrdmulhq_s16(difference, difference), growth);
        let half_square = vshrq_n_s16::<1>(vqrdmulhq_s16(y, y));
        let mut power = vaddq_s16(vsubq_s16(all, y), half_square);
        for _ in 0..SQUARINGS {
            power = vqrdmulhq_s16(power, power);
        }
        store(found, x, power);
    }
}

#[target_feature(enable = "neon")]
fn average_vectors(taps: &Taps<'_>, blocks: usize, means: &mut [Vec<u8>; 3]) {
    for x in (0..blocks * LANES).step_by(VECTOR) {
        let middle = [load(taps.middle[0], x), load(taps.middle[1], x), load(taps.middle[2], x)];
        let mut sums = [vdupq_n_s16(0); 3];
        let mut total = vdupq_n_u16(OWN);
        for Tap { values, weights } in &taps.around {
            let weight = load(weights, x);
            total = vaddq_u16(total, vshrq_n_u16::<{ LOST as i32 }>(vreinterpretq_u16_s16(weight)));
            for c in 0..3 {
                let off = vsubq_s16(load(values[c], x), middle[c]);
                sums[c] = vaddq_s16(sums[c], vqrdmulhq_s16(weight, off));
            }
        }
        let scale = scales(total);
        for c in 0..3 {
            let more = vcombine_s16(
                vmovn_s32(vcvtnq_s32_f32(vmulq_f32(
                    vcvtq_f32_s32(vmovl_s16(vget_low_s16(sums[c]))),
                    scale[0],
                ))),
                vmovn_s32(vcvtnq_s32_f32(vmulq_f32(
                    vcvtq_f32_s32(vmovl_s16(vget_high_s16(sums[c]))),
                    scale[1],
                ))),
            );
            let mean = vaddq_s16(vshrq_n_s16::<{ PART as i32 }>(middle[c]), more);
            let lanes = &mut means[c][x..x + VECTOR];
            // SAFETY: the slice is as long as the vector.
            unsafe { vst1_u8(lanes.as_mut_ptr(), vqmovun_s16(mean)) }
        }
    }
}

/// What sums are multiplied by to be steps of a byte, in two halves.
#[inline]
#[target_feature(enable = "neon")]
fn scales(total: uint16x8_t) -> [float32x4_t; 2] {
    let [low, high] = [vmovl_u16(vget_low_u16(total)), vmovl_u16(vget_high_u16(total))];
    let scale = vdupq_n_f32(SCALE);
    [vdivq_f32(scale, vcvtq_f32_u32(low)), vdivq_f32(scale, vcvtq_f32_u32(high))]
}

#[inline]
#[target_feature(enable = "neon")]
fn load(values: &[i16], x: usize) -> int16x8_t {
    let lanes = &values[x..x + VECTOR];
    // SAFETY: the slice is as long as the vector.
    unsafe { vld1q_s16(lanes.as_ptr()) }
}

#[inline]
#[target_feature(enable = "neon")]
fn store(values: &mut [i16], x: usize, vector: int16x8_t) {
    let lanes = &mut values[x..x + VECTOR];
    // SAFETY: the slice is as long as the vector.
    unsafe { vst1q_s16(lanes.as_mut_ptr(), vector) }
}
