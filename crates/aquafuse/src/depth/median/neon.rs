//! The median of 16 bytes or 8 words at once, by NEON.

#![allow(unsafe_code, reason = "loads and stores of vectors, and the call that needs NEON")]

use std::arch::aarch64::{
    uint8x16_t, uint16x8_t, vld1q_u8, vld1q_u16, vmaxq_u8, vmaxq_u16, vminq_u8, vminq_u16, vst1q_u8,
    vst1q_u16,
};

use super::kernel::{comparators, pair_kernel};
use super::network::{middle_of, select, sort_6, sort_7};
use super::{CORE, PAIR_ROWS, SIDE};

/// [`super::plain::pair`] of bytes.
pub(super) fn pair_of_bytes(
    rows: &[&[u8]; PAIR_ROWS],
    planes: &mut [Vec<u8>; CORE],
    above: &mut [u8],
    below: &mut [u8],
) {
    // SAFETY: NEON is part of this architecture.
    unsafe { bytes(rows, planes, above, below) }
}

/// [`super::plain::pair`] of words.
pub(super) fn pair_of_words(
    rows: &[&[u16]; PAIR_ROWS],
    planes: &mut [Vec<u16>; CORE],
    above: &mut [u16],
    below: &mut [u16],
) {
    // SAFETY: NEON is part of this architecture.
    unsafe { words(rows, planes, above, below) }
}

pair_kernel! {
    #[target_feature(enable = "neon")]
    fn bytes(values: u8, lanes: 16, load: load_bytes, store: store_bytes, min: vminq_u8, max: vmaxq_u8)
}
pair_kernel! {
    #[target_feature(enable = "neon")]
    fn words(values: u16, lanes: 8, load: load_words, store: store_words, min: vminq_u16, max: vmaxq_u16)
}

#[inline]
#[target_feature(enable = "neon")]
fn load_bytes(values: &[u8], x: usize) -> uint8x16_t {
    let lanes = &values[x..x + 16];
    // SAFETY: the slice is as long as the vector.
    unsafe { vld1q_u8(lanes.as_ptr()) }
}

#[inline]
#[target_feature(enable = "neon")]
fn store_bytes(values: &mut [u8], x: usize, vector: uint8x16_t) {
    let lanes = &mut values[x..x + 16];
    // SAFETY: the slice is as long as the vector.
    unsafe { vst1q_u8(lanes.as_mut_ptr(), vector) }
}

#[inline]
#[target_feature(enable = "neon")]
fn load_words(values: &[u16], x: usize) -> uint16x8_t {
    let lanes = &values[x..x + 8];
    // SAFETY: the slice is as long as the vector.
    unsafe { vld1q_u16(lanes.as_ptr()) }
}

#[inline]
#[target_feature(enable = "neon")]
fn store_words(values: &mut [u16], x: usize, vector: uint16x8_t) {
    let lanes = &mut values[x..x + 8];
    // SAFETY: the slice is as long as the vector.
    unsafe { vst1q_u16(lanes.as_mut_ptr(), vector) }
}
