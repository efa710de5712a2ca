//! Maps, and the layers of the network beside its convolutions: each sum in one order, whatever the vectors.
//!
//! Maps lie pixel by pixel, the channels of a pixel side by side, with a border of zeros around them.

use crate::simd::{self, Level, Work};

/// What is added to a variance that is divided by.
const LEAST_VARIANCE: f32 = 1e-5;

/// Maps of some channels with a border of one pixel.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Maps {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) channels: usize,
    values: Vec<f32>,
}

impl Maps {
    pub(super) fn new(width: usize, height: usize, channels: usize) -> Self {
        Self { width, height, channels, values: vec![0.0; (width + 2) * (height + 2) * channels] }
    }

    #[inline(always)]
    fn start(&self, x: usize, y: usize) -> usize {
        ((y + 1) * (self.width + 2) + x + 1) * self.channels
    }

    /// All values, those of the border among them.
    pub(super) fn values(&self) -> &[f32] {
        &self.values
    }

    /// The channels of one pixel.
    #[inline(always)]
    pub(super) fn pixel_mut(&mut self, x: usize, y: usize) -> &mut [f32] {
        let start = self.start(x, y);
        &mut self.values[start..start + self.channels]
    }

    /// The channels of row `y`, pixel after pixel.
    pub(super) fn row(&self, y: usize) -> &[f32] {
        let start = self.start(0, y);
        &self.values[start..start + self.width * self.channels]
    }

    pub(super) fn row_mut(&mut self, y: usize) -> &mut [f32] {
        let start = self.start(0, y);
        &mut self.values[start..start + self.width * self.channels]
    }
}

/// Group normalisation (Wu and He 2018), then nothing below 0.
#[derive(Clone, Debug)]
pub(super) struct Norm {
    pub(super) groups: usize,
    pub(super) scale: Vec<f32>,
    pub(super) shift: Vec<f32>,
}

impl Norm {
    pub(super) fn apply(&self, maps: &mut Maps, level: Level) {
        let (sums, squares) = simd::widest_by(level, Moments(maps));
        let channels = maps.channels;
        let per_group = channels / self.groups;
        let count = (per_group * maps.width * maps.height) as f64;
        let (mut scale, mut shift) = (vec![0.0; channels], vec![0.0; channels]);
        for group in 0..self.groups {
            let of = group * per_group..(group + 1) * per_group;
            let mean = sums[of.clone()].iter().sum::<f64>() / count;
            let variance = squares[of.clone()].iter().sum::<f64>() / count - mean * mean;
            let by = (variance.max(0.0) + f64::from(LEAST_VARIANCE)).sqrt().recip();
            for c in of {
                scale[c] = (f64::from(self.scale[c]) * by) as f32;
                shift[c] = (f64::from(self.shift[c]) - f64::from(self.scale[c]) * by * mean) as f32;
            }
        }
        simd::widest_by(level, Normalise { maps, scale: &scale, shift: &shift });
    }
}

/// Sums of values and of their squares for each channel.
struct Moments<'a>(&'a Maps);

impl Work for Moments<'_> {
    type Output = (Vec<f64>, Vec<f64>);

    #[inline(always)]
    fn run(self) -> Self::Output {
        let maps = self.0;
        let channels = maps.channels;
        let (mut sums, mut squares) = (vec![0.0_f64; channels], vec![0.0_f64; channels]);
        let (mut of_row, mut squares_of_row) = (vec![0.0_f32; channels], vec![0.0_f32; channels]);
        for y in 0..maps.height {
            of_row.fill(0.0);
            squares_of_row.fill(0.0);
            for pixel in maps.row(y).chunks_exact(channels) {
                for ((sum, square), value) in of_row.iter_mut().zip(&mut squares_of_row).zip(pixel) {
                    *sum += value;
                    *square += value * value;
                }
            }
            for c in 0..channels {
                sums[c] += f64::from(of_row[c]);
                squares[c] += f64::from(squares_of_row[c]);
            }
        }
        (sums, squares)
    }
}

struct Normalise<'a> {
    maps: &'a mut Maps,
    scale: &'a [f32],
    shift: &'a [f32],
}

impl Work for Normalise<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { maps, scale, shift } = self;
        for y in 0..maps.height {
            for pixel in maps.row_mut(y).chunks_exact_mut(scale.len()) {
                for ((value, scale), shift) in pixel.iter_mut().zip(scale).zip(shift) {
                    *value = (*value * scale + shift).max(0.0);
                }
            }
        }
    }
}

/// The means of squares of four pixels.
pub(super) fn halved(maps: &Maps) -> Maps {
    let (channels, mut half) = (maps.channels, Maps::new(maps.width / 2, maps.height / 2, maps.channels));
    for y in 0..half.height {
        let [above, below] = [2 * y, 2 * y + 1].map(|y| maps.row(y));
        for (x, pixel) in half.row_mut(y).chunks_exact_mut(channels).enumerate() {
            let start = 2 * x * channels;
            for (c, value) in pixel.iter_mut().enumerate() {
                let (left, right) = (start + c, start + channels + c);
                *value = 0.25 * ((above[left] + above[right]) + (below[left] + below[right]));
            }
        }
    }
    half
}

/// Adds to each pixel of `maps` the one of a map of half the sides that lies over it.
pub(super) fn add_doubled(maps: &mut Maps, half: &Maps) {
    let channels = maps.channels;
    for y in 0..maps.height {
        let from = half.row(y / 2);
        for (x, pixel) in maps.row_mut(y).chunks_exact_mut(channels).enumerate() {
            let from = &from[x / 2 * channels..][..channels];
            pixel.iter_mut().zip(from).for_each(|(value, add)| *value += add);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(count: usize) -> Vec<f32> {
        (0..count).map(|i| ((i * 37 + 11) % 101) as f32 / 50.0 - 1.0).collect()
    }

    fn filled(width: usize, height: usize, channels: usize) -> Maps {
        let mut maps = Maps::new(width, height, channels);
        let values = numbers(width * height * channels);
        for y in 0..height {
            maps.row_mut(y).copy_from_slice(&values[y * width * channels..][..width * channels]);
        }
        maps
    }

    #[test]
    fn vectors_change_no_bit() {
        let channels = 24;
        let norm = Norm { groups: 4, scale: numbers(channels), shift: numbers(channels) };
        let by = |level: Level| {
            let mut maps = filled(13, 9, channels);
            norm.apply(&mut maps, level);
            maps
        };
        let plain = by(Level::Plain);
        assert!(Level::all().into_iter().all(|level| by(level) == plain));
    }

    #[test]
    fn normalised_groups_have_mean_and_deviation_of_scale_and_shift() {
        let mut maps = filled(8, 6, 8);
        // Shifted so far up that nothing is cut off at 0.
        let norm = Norm { groups: 2, scale: vec![0.5; 8], shift: vec![9.0; 8] };
        norm.apply(&mut maps, Level::Plain);
        for group in 0..2 {
            let values: Vec<f32> = (0..6)
                .flat_map(|y| maps.row(y).to_vec())
                .enumerate()
                .filter(|(i, _)| i % 8 / 4 == group)
                .map(|(_, value)| value)
                .collect();
            let mean = values.iter().sum::<f32>() / values.len() as f32;
            let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f32>() / values.len() as f32;
            assert!((mean - 9.0).abs() < 1e-4 && (variance.sqrt() - 0.5).abs() < 1e-3, "{mean} {variance}");
        }
    }

    #[test]
    fn halving_and_doubling_keep_a_flat_map() {
        let mut maps = Maps::new(6, 4, 3);
        (0..4).for_each(|y| maps.row_mut(y).fill(2.0));
        let half = halved(&maps);
        assert!((0..2).all(|y| half.row(y).iter().all(|value| *value == 2.0)));
        add_doubled(&mut maps, &half);
        assert!((0..4).all(|y| maps.row(y).iter().all(|value| *value == 4.0)));
    }
}
