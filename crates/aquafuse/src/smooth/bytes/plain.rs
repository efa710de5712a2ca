//! Weights and means by arithmetic that every machine has: what vectors must give bit for bit.

use super::super::weights::{ONE, product, weight};
use super::{LANES, PART, Tap, Taps};

/// Bits that the weights lose before they are summed: 13 of them have 16 bits.
pub(super) const LOST: u32 = 3;
/// The weight of a pixel itself among those.
pub(super) const OWN: u16 = ONE >> LOST;
/// What turns a sum of differences over a sum of weights into steps of a byte: products keep [`PART`] bits behind the
/// point, and 15 of the weight are gone.
pub(super) const SCALE: f32 = ((1 << (15 - LOST)) / (1 << PART)) as f32;
/// 1.5 2^23: what is added to it is rounded to a whole number, halves to even ones, and is in its last bits.
const ROUND: f32 = 12_582_912.0;

/// Takes a row apart; values get their bits behind the point.
pub(super) fn split(pixels: &[[u8; 3]], [r, g, b]: [&mut [i16]; 3]) {
    for (((r, g), b), pixel) in r.iter_mut().zip(g).zip(b).zip(pixels) {
        [*r, *g, *b] = pixel.map(|value| i16::from(value) << PART);
    }
}

/// Puts a row together.
pub(super) fn join([r, g, b]: [&[u8]; 3], pixels: &mut [[u8; 3]]) {
    for (((r, g), b), pixel) in r.iter().zip(g).zip(b).zip(pixels) {
        *pixel = [*r, *g, *b];
    }
}

pub(super) fn weigh(own: [&[i16]; 3], other: [&[i16]; 3], found: &mut [i16]) {
    for (i, found) in found.iter_mut().enumerate() {
        // Bytes with PART bits behind the point: three differences have 15.
        let off = |c: usize| own[c][i].abs_diff(other[c][i]);
        *found = weight::<PART>(off(0) + off(1) + off(2));
    }
}

pub(super) fn average(taps: &Taps<'_>, blocks: usize, means: &mut [Vec<u8>; 3]) {
    for block in 0..blocks {
        let at = |values: &[i16]| -> [i16; LANES] { values.as_chunks().0[block] };
        let mut sums = Sums::new(taps.middle.map(at));
        for Tap { values, weights } in &taps.around {
            sums.add(&at(weights), &values.map(at));
        }
        for (means, found) in means.iter_mut().zip(sums.means()) {
            means[block * LANES..][..LANES].copy_from_slice(&found);
        }
    }
}

/// Weighted sums of what the window differs by from the pixels in its middle, and the sum of the weights.
struct Sums {
    middle: [[i16; LANES]; 3],
    of_channel: [[i16; LANES]; 3],
    total: [u16; LANES],
}

impl Sums {
    /// Of the pixels themselves.
    fn new(middle: [[i16; LANES]; 3]) -> Self {
        Self { middle, of_channel: [[0; LANES]; 3], total: [OWN; LANES] }
    }

    fn add(&mut self, weights: &[i16; LANES], values: &[[i16; LANES]; 3]) {
        for i in 0..LANES {
            self.total[i] += weights[i] as u16 >> LOST;
        }
        for c in 0..3 {
            for i in 0..LANES {
                self.of_channel[c][i] += product(weights[i], values[c][i] - self.middle[c][i]);
            }
        }
    }

    /// The pixels themselves and by how much the means differ from them. Twelve products are off by 3/16 of a step at
    /// most, so that no mean passes what it is of.
    fn means(&self) -> [[u8; LANES]; 3] {
        let mut means = [[0; LANES]; 3];
        for c in 0..3 {
            for i in 0..LANES {
                let scale = SCALE / f32::from(self.total[i]);
                let more = (f32::from(self.of_channel[c][i]) * scale + ROUND).to_bits() as i16;
                means[c][i] = ((self.middle[c][i] >> PART) + more) as u8;
            }
        }
        means
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::smooth::weights::AHEAD;

    #[test]
    fn sums_of_the_largest_products_fit() {
        let product =
            |difference: u16| product(weight::<0>(difference), i16::try_from(difference << PART).unwrap());
        let largest = (0..=255).map(product).max().unwrap();
        assert!(largest.checked_mul(2 * AHEAD.len() as i16).is_some(), "{largest}");
        assert!(13 * u32::from(OWN) <= u32::from(u16::MAX));
    }

    #[test]
    fn means_stay_within_the_values_they_are_of() {
        // Black among white and the other way round, at every weight: what rounding takes must not pass 0 or 255.
        for (middle, other) in
            (0..=255_u8).flat_map(|other| [(0, other), (255, other), (1, other), (254, other)])
        {
            for share in (0..=ONE as i16).step_by(129) {
                let scaled = |value: u8| [i16::from(value) << PART; LANES];
                let mut sums = Sums::new([scaled(middle); 3]);
                let most = weight::<0>(u16::from(middle.abs_diff(other)));
                if share > most {
                    break;
                }
                (0..2 * AHEAD.len()).for_each(|_| sums.add(&[share; LANES], &[scaled(other); 3]));
                let mean = sums.means()[0][0];
                assert!((middle.min(other)..=middle.max(other)).contains(&mean), "{middle}, {other}: {mean}");
            }
        }
    }
}
