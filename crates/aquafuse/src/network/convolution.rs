//! Convolutions in whole numbers: exact sums, which do not depend on their order, on threads or on vectors.
//!
//! Weights are whole numbers of 8 bits with a scale for each channel of the result. The input is rounded to whole numbers of 15 bits,
//! in steps of its own largest value. So products are sums of pairs, for which processors have one instruction.

#[cfg(all(feature = "simd", target_arch = "x86_64"))]
mod avx2;
#[cfg(all(feature = "simd", target_arch = "aarch64"))]
mod neon;

use super::layers::Maps;
use crate::simd::{self, Level, Work};

/// Channels of the result that are summed side by side.
const LANES: usize = 8;
/// The largest input: `9 * 56` products with weights up to 127 fit into 32 bits.
const MOST: f32 = 16383.0;
/// Added to a number and taken off again, it rounds to the nearest whole one; the last bits are then those of that number.
const ROUNDING: f32 = 12_582_912.0;

/// The weights of two channels of the input for eight of the result: in turns where one instruction multiplies both, else one after
/// the other.
type Pair = [i16; 2 * LANES];

/// Where a pair has the weight of its first or second channel for a channel of the result.
#[inline(always)]
const fn place_in_pair(second: usize, lane: usize) -> usize {
    if cfg!(target_arch = "x86_64") { 2 * lane + second } else { LANES * second + lane }
}

/// A convolution without a bias: for each eight channels of the result, each place and each two channels of the input. `side` is 3
/// or 1 places.
#[derive(Clone, Debug)]
pub(super) struct Convolution {
    from: usize,
    to: usize,
    side: usize,
    weights: Vec<Pair>,
    /// What a step of each channel's weights is.
    scales: Vec<f32>,
}

impl Convolution {
    /// From weights in the order of the file: channel of the result, channel of the input, row, column. `from` is a multiple
    /// of four.
    pub(super) fn new(from: usize, to: usize, side: usize, scales: &[f32], stored: &[i8]) -> Self {
        let places = side * side;
        debug_assert!(from.is_multiple_of(4) && stored.len() == to * from * places);
        let mut weights = vec![[0; 2 * LANES]; to.div_ceil(LANES) * places * from / 2];
        for (i, weight) in stored.iter().enumerate() {
            let (out, rest) = (i / (from * places), i % (from * places));
            let (channel, place) = (rest / places, rest % places);
            let pair = ((out / LANES) * places + place) * from / 2 + channel / 2;
            weights[pair][place_in_pair(channel % 2, out % LANES)] = i16::from(*weight);
        }
        Self { from, to, side, weights, scales: scales.to_vec() }
    }

    /// The maps it makes of others; beyond their border they are 0.
    pub(super) fn of(&self, input: &Maps, level: Level) -> Maps {
        let words = Words::of(input, level);
        let mut output = Maps::new(input.width, input.height, self.to);
        let mut scales: Vec<f32> = self.scales.iter().map(|scale| scale * words.step).collect();
        scales.resize(self.to.next_multiple_of(LANES), 0.0);
        let work = Convolve { by: self, input: &words, scales: &scales, output: &mut output };
        match level {
            #[cfg(all(feature = "simd", target_arch = "x86_64"))]
            Level::Avx2(proof) => avx2::run(proof, work),
            #[cfg(all(feature = "simd", target_arch = "aarch64"))]
            Level::Neon => neon::run(work),
            _ => simd::widest_by(level, work),
        }
        output
    }

    /// The weights of the place at column `dx`, row `dy`, for eight channels of the result.
    #[inline(always)]
    fn at(&self, block: usize, dx: usize, dy: usize) -> &[Pair] {
        let pairs = self.from / 2;
        &self.weights[((block * self.side + dy) * self.side + dx) * pairs..][..pairs]
    }
}

/// Maps in whole numbers, two channels in a word, with their border.
struct Words {
    /// What 1 is.
    step: f32,
    /// Words of a row, its border among them.
    row: usize,
    /// Words of a pixel.
    pairs: usize,
    values: Vec<i32>,
}

impl Words {
    fn of(maps: &Maps, level: Level) -> Self {
        let values = maps.values();
        let most = simd::widest_by(level, Most(values));
        let step = most / MOST;
        let by = if most > 0.0 { MOST / most } else { 0.0 };
        let pairs = maps.channels / 2;
        let mut words = vec![0; values.len() / 2];
        simd::widest_by(level, Pack { values: values.as_chunks().0, by, words: &mut words });
        Self { step, row: (maps.width + 2) * pairs, pairs, values: words }
    }

    /// The pixel at column `x`, row `y`, both counted from the border on.
    #[inline(always)]
    fn at(&self, x: usize, y: usize) -> &[i32] {
        &self.values[y * self.row + x * self.pairs..][..self.pairs]
    }
}

/// The largest absolute value.
struct Most<'a>(&'a [f32]);

impl Work for Most<'_> {
    type Output = f32;

    #[inline(always)]
    fn run(self) -> f32 {
        let mut most = [0.0_f32; 4 * LANES];
        let (some, rest) = self.0.as_chunks::<{ 4 * LANES }>();
        for some in some {
            for (most, value) in most.iter_mut().zip(some) {
                let value = value.abs();
                *most = if value > *most { value } else { *most };
            }
        }
        most.iter().chain(rest).fold(0.0, |most, value| most.max(value.abs()))
    }
}

/// Rounds, and packs two in a word.
struct Pack<'a> {
    values: &'a [[f32; 2]],
    by: f32,
    words: &'a mut [i32],
}

impl Work for Pack<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        for (word, [first, second]) in self.words.iter_mut().zip(self.values) {
            let [first, second] = [first, second].map(|value| (value * self.by + ROUNDING).to_bits());
            *word = ((first & 0xffff) | (second << 16)).cast_signed();
        }
    }
}

/// All of a convolution.
struct Convolve<'a> {
    by: &'a Convolution,
    input: &'a Words,
    /// What a step of each channel of the result is.
    scales: &'a [f32],
    output: &'a mut Maps,
}

impl Convolve<'_> {
    /// Stores eight channels of the result at one pixel.
    #[inline(always)]
    fn store(&mut self, sums: [i32; LANES], x: usize, y: usize, block: usize) {
        let scales = &self.scales[block * LANES..][..LANES];
        let found: [f32; LANES] = std::array::from_fn(|lane| sums[lane] as f32 * scales[lane]);
        let output = &mut self.output.pixel_mut(x, y)[block * LANES..];
        match output.first_chunk_mut() {
            Some(output) => *output = found,
            None => output.iter_mut().zip(found).for_each(|(output, found)| *output = found),
        }
    }

    /// How far a convolution reaches into the border of its input, from the first pixel.
    #[inline(always)]
    fn inset(&self) -> usize {
        1 - self.by.side / 2
    }
}

impl Work for Convolve<'_> {
    type Output = ();

    #[inline(always)]
    fn run(mut self) {
        let (by, input, inset) = (self.by, self.input, self.inset());
        for y in 0..self.output.height {
            for block in 0..by.to.div_ceil(LANES) {
                for x in 0..self.output.width {
                    let mut sums = [0_i32; LANES];
                    for (dy, dx) in (0..by.side).flat_map(|dy| (0..by.side).map(move |dx| (dy, dx))) {
                        let pixel = input.at(x + inset + dx, y + inset + dy);
                        for (word, pair) in pixel.iter().zip(by.at(block, dx, dy)) {
                            let (first, second) = (i32::from(*word as i16), word >> 16);
                            for (lane, sum) in sums.iter_mut().enumerate() {
                                let weight = |second: usize| i32::from(pair[place_in_pair(second, lane)]);
                                *sum += first * weight(0) + second * weight(1);
                            }
                        }
                    }
                    self.store(sums, x, y, block);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn maps(width: usize, height: usize, channels: usize) -> Maps {
        let mut maps = Maps::new(width, height, channels);
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            for (c, value) in maps.pixel_mut(x, y).iter_mut().enumerate() {
                *value = ((x * 37 + y * 11 + c * 53 + 7) % 101) as f32 / 50.0 - 1.0;
            }
        }
        maps
    }

    fn convolution(from: usize, to: usize, side: usize) -> (Convolution, Vec<i8>, Vec<f32>) {
        let stored: Vec<i8> = (0..to * from * side * side)
            .map(|i| ((i * 71 + 5) % 255) as i32 as i16)
            .map(|i| (i - 127) as i8)
            .collect();
        let scales: Vec<f32> = (0..to).map(|c| 0.001 * (c + 1) as f32).collect();
        (Convolution::new(from, to, side, &scales, &stored), stored, scales)
    }

    #[test]
    fn a_convolution_is_the_sum_it_is_defined_by() {
        for (from, to, side) in [(8, 11, 3), (16, 3, 1)] {
            let (width, height) = (7, 6);
            let input = maps(width, height, from);
            let (convolution, stored, scales) = convolution(from, to, side);
            let found = convolution.of(&input, Level::Plain);
            let reach = (side / 2) as isize;
            let at = |x: isize, y: isize, c: usize| -> f64 {
                let inside = (0..width as isize).contains(&x) && (0..height as isize).contains(&y);
                if inside { f64::from(input.row(y as usize)[x as usize * from + c]) } else { 0.0 }
            };
            let places = side * side;
            for (y, x, out) in
                (0..height).flat_map(|y| (0..width).flat_map(move |x| (0..to).map(move |out| (y, x, out))))
            {
                let (mut sum, mut size) = (0.0, 0.0);
                for (c, place) in (0..from).flat_map(|c| (0..places).map(move |place| (c, place))) {
                    let weight =
                        f64::from(stored[(out * from + c) * places + place]) * f64::from(scales[out]);
                    let (dx, dy) = ((place % side) as isize - reach, (place / side) as isize - reach);
                    sum += weight * at(x as isize + dx, y as isize + dy, c);
                    size += weight.abs();
                }
                // Half a step of the input for each weight.
                let most = size * 0.51 / f64::from(MOST);
                let found = f64::from(found.row(y)[x * to + out]);
                assert!((sum - found).abs() <= most, "{found} is not {sum}, more than {most} off");
            }
        }
    }

    #[test]
    fn the_largest_sum_fits() {
        let (from, to) = (56, 8);
        let convolution = Convolution::new(from, to, 3, &[1.0; 8], &vec![-127; from * to * 9]);
        let mut input = Maps::new(3, 3, from);
        (0..3).for_each(|y| input.row_mut(y).fill(-2.0));
        for level in Level::all() {
            let found = convolution.of(&input, level);
            let middle = found.row(1)[to];
            assert!((middle - 2.0 * 127.0 * 9.0 * 56.0).abs() < 0.1, "{level:?}: {middle}");
        }
    }

    #[test]
    fn maps_of_nothing_stay_nothing() {
        let (convolution, ..) = convolution(8, 11, 3);
        let empty = Maps::new(5, 4, 8);
        assert!(Level::all().into_iter().all(|level| convolution.of(&empty, level) == Maps::new(5, 4, 11)));
    }

    #[test]
    fn vectors_change_no_bit() {
        for (from, to, side, width) in [(12, 16, 3, 13), (16, 56, 3, 9), (56, 48, 1, 5), (16, 3, 1, 8)] {
            let (convolution, ..) = convolution(from, to, side);
            let input = maps(width, 6, from);
            let plain = convolution.of(&input, Level::Plain);
            for level in Level::all() {
                assert_eq!(convolution.of(&input, level), plain, "{from} to {to} by {level:?}");
            }
        }
    }
}
