//! A convolution by NEON: four products and sums in one instruction.

#![allow(unsafe_code, reason = "loads and stores of vectors")]

use std::arch::aarch64::{
    int16x4_t, int16x8_t, int32x4_t, vdupq_n_s32, vget_low_s16, vld1_s16, vld1q_s16, vmlal_high_lane_s16,
    vmlal_lane_s16, vst1q_s32,
};

use super::{Convolve, LANES, Pair};

/// Pixels of a row that share the weights once they are loaded.
const PIXELS: usize = 4;

pub(super) fn run(mut work: Convolve<'_>) {
    let width = work.output.width;
    for y in 0..work.output.height {
        for block in 0..work.by.to.div_ceil(LANES) {
            let mut x = 0;
            while x + PIXELS <= width {
                tile::<PIXELS>(&mut work, x, y, block);
                x += PIXELS;
            }
            for x in x..width {
                tile::<1>(&mut work, x, y, block);
            }
        }
    }
}

/// Eight channels of the result at so many pixels from column `x` on.
#[inline]
fn tile<const PIXELS: usize>(work: &mut Convolve<'_>, x: usize, y: usize, block: usize) {
    let (by, input, inset) = (work.by, work.input, work.inset());
    // SAFETY: NEON is part of the architecture.
    let mut sums = [[unsafe { vdupq_n_s32(0) }; 2]; PIXELS];
    for dy in 0..by.side {
        for dx in 0..by.side {
            let weights = by.at(block, dx, dy).as_chunks::<2>().0;
            let pixels: [&[[i32; 2]]; PIXELS] = std::array::from_fn(|i| {
                &input.at(x + i + inset + dx, y + inset + dy).as_chunks::<2>().0[..weights.len()]
            });
            for (four, weights) in weights.iter().enumerate() {
                let weights = loaded(weights);
                for (sums, pixel) in sums.iter_mut().zip(&pixels) {
                    // SAFETY: two words are four channels, aligned or not.
                    *sums = added(*sums, weights, unsafe { vld1_s16(pixel[four].as_ptr().cast()) });
                }
            }
        }
    }
    for (i, sums) in sums.into_iter().enumerate() {
        let mut lanes = [0_i32; LANES];
        let [low, high] = lanes.as_chunks_mut::<4>().0 else { return };
        // SAFETY: four sums each, aligned or not.
        unsafe {
            vst1q_s32(low.as_mut_ptr(), sums[0]);
            vst1q_s32(high.as_mut_ptr(), sums[1]);
        }
        work.store(lanes, x + i, y, block);
    }
}

/// The weights of four channels of the input.
#[inline(always)]
fn loaded([first, second]: &[Pair; 2]) -> [int16x8_t; 4] {
    let load = |pair: &Pair, from: usize| {
        let weights: &[i16] = &pair[from..][..LANES];
        // SAFETY: eight weights, aligned or not.
        unsafe { vld1q_s16(weights.as_ptr()) }
    };
    [load(first, 0), load(first, LANES), load(second, 0), load(second, LANES)]
}

/// The sums with the products of four channels.
#[inline(always)]
fn added([low, high]: [int32x4_t; 2], weights: [int16x8_t; 4], pixel: int16x4_t) -> [int32x4_t; 2] {
    let [a, b, c, d] = weights;
    // SAFETY: NEON is part of the architecture.
    unsafe {
        let low = vmlal_lane_s16::<0>(low, vget_low_s16(a), pixel);
        let high = vmlal_high_lane_s16::<0>(high, a, pixel);
        let low = vmlal_lane_s16::<1>(low, vget_low_s16(b), pixel);
        let high = vmlal_high_lane_s16::<1>(high, b, pixel);
        let low = vmlal_lane_s16::<2>(low, vget_low_s16(c), pixel);
        let high = vmlal_high_lane_s16::<2>(high, c, pixel);
        let low = vmlal_lane_s16::<3>(low, vget_low_s16(d), pixel);
        let high = vmlal_high_lane_s16::<3>(high, d, pixel);
        [low, high]
    }
}
