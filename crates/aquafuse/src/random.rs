//! Numbers by chance that are the same for a seed on every machine, and sums of bytes to key them on.
//!
//! For the crates of this workspace alone: no part of the API. Manifests and checkpoints rest on every number here.

/// What SplitMix64 adds to its state: 2^64 over the golden ratio, odd.
pub const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;

/// The next number of SplitMix64 (Steele, Lea and Flood 2014), whose state is all there is to keep.
///
/// # Examples
///
/// ```
/// use aquafuse::random::split_mix;
///
/// // The first of seed 0, as published.
/// assert_eq!(split_mix(&mut 0), 0xE220_A839_7B1D_CDAF);
/// ```
pub fn split_mix(state: &mut u64) -> u64 {
    *state = state.wrapping_add(GOLDEN);
    let mut x = *state;
    x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    x ^ (x >> 31)
}

/// What FNV-1a begins with.
pub const FNV_BASIS: u64 = 0xCBF2_9CE4_8422_2325;

/// FNV-1a of what `hash` is of and one byte more (Fowler, Noll and Vo), or one larger value at once.
///
/// # Examples
///
/// ```
/// use aquafuse::random::{FNV_BASIS, fnv};
///
/// assert_eq!(fnv(FNV_BASIS, b'a'), 0xAF63_DC4C_8601_EC8C);
/// ```
pub fn fnv(hash: u64, value: impl Into<u64>) -> u64 {
    (hash ^ value.into()).wrapping_mul(0x0000_0100_0000_01B3)
}
