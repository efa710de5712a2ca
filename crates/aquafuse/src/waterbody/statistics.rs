//! What the estimators read: the colours of an image counted by depth, in one pass.

use std::marker::PhantomData;

use super::Seen;
use crate::depth::{LEVELS, Quantised};
use crate::image::Encoding;

/// Bins over depth, equally full. The darkest things of a wide bin are those of its near end, which bends the
/// curve; more bins leave too few pixels for a dark quantile in each.
const BINS: u64 = 32;
/// Pixels a bin must hold to be read: the dark quantile of fewer is chance.
const LEAST_PIXELS: u64 = 50;

/// Colours counted by depth.
pub(super) struct Statistics<E: Encoding> {
    /// The bins that hold enough pixels, near to far.
    pub(super) bins: Vec<Bin<E>>,
    /// z that 95 % of the pixels do not exceed, those beyond the steps of depth left out; the scale on which
    /// coefficients are bounded. Never 0.
    pub(super) z95: f32,
    /// Share of all pixels at the nearest and at the farthest levels.
    pub(super) at_ends: [f64; 2],
}

/// The colours of one range of depths.
pub(super) struct Bin<E: Encoding> {
    /// Mean z of its pixels.
    pub(super) z: f32,
    pub(super) count: u64,
    values: Values,
    encoding: PhantomData<E>,
}

/// The dark end of a bin in one channel, in bytes.
pub(super) struct Dark {
    pub(super) value: f32,
    pub(super) spread: f32,
}

/// Levels that count as an end of the range: the mean over neighbours of which some are not at the end is not at it either.
const AT_END: usize = 3;

impl<E: Encoding> Statistics<E> {
    /// Counts an image by its depth. What lies beyond the steps of depth gives the veiling light, but not how
    /// fast anything grows with distance: it joins no bin, unless there is nothing else.
    pub(super) fn gather(counted: Seen<'_>, depth: &Quantised<'_>) -> Self {
        let Quantised { step, beyond, .. } = depth;
        let pixels = counted.count() as u64;
        let mut counts = count(counted);
        let at_end = |counts: &[u64]| counts.iter().sum::<u64>() as f64 / pixels.max(1) as f64;
        let at_ends = [at_end(&counts[..AT_END]), at_end(&counts[LEVELS - AT_END..])];
        if let Some(beyond) = beyond.map(usize::from)
            && counts[beyond] < pixels
        {
            counts[beyond] = 0;
        }
        let total = counts.iter().sum::<u64>() as f64;
        let level_at = |share: f64| {
            let mut seen = 0;
            let level = counts.iter().position(|count| {
                seen += count;
                seen as f64 >= share * total
            });
            level.unwrap_or(LEVELS - 1)
        };
        let whole = counts.iter().sum::<u64>().max(1);
        let (mut before, mut weighted, mut count) = (0, [0; BINS as usize], [0; BINS as usize]);
        // A level belongs where its middle pixel does.
        let bin_of: [u8; LEVELS] = std::array::from_fn(|level| {
            let middle = 2 * before + counts[level];
            before += counts[level];
            let bin = (middle * BINS / (2 * whole)).min(BINS - 1);
            weighted[bin as usize] += counts[level] * level as u64;
            count[bin as usize] += counts[level];
            bin as u8
        });
        let values = count_by_bin(counted, &bin_of, &counts);
        let bins =
            values.into_iter().zip(count).zip(weighted).filter(|((_, count), _)| *count >= LEAST_PIXELS);
        let bin = |((values, count), weighted): ((_, u64), u64)| {
            let z = (weighted as f64 / count as f64) as f32 * step;
            Bin { z, count, values, encoding: PhantomData }
        };
        let bins = bins.map(bin).collect();
        // Depth that is 0 everywhere has no scale; any will do, since no coefficient can be read off it.
        let z95 = level_at(0.95).max(1) as f32 * step;
        Self { bins, z95, at_ends }
    }
}

#[cfg(test)]
impl<E: Encoding> Statistics<E> {
    /// Counts all of an image.
    pub(super) fn of_all(image: crate::image::ImageRef<'_, u8>, depth: &Quantised<'_>) -> Self {
        Self::gather(Seen::whole(image, &depth.levels), depth)
    }
}

/// Pixels of each level.
fn count(seen: Seen<'_>) -> [u64; LEVELS] {
    // Neighbours are often equal, and a count cannot rise again before it has been written: four take turns.
    let mut turns = [[0_u32; LEVELS]; 4];
    for (_, levels) in seen.rows() {
        let (fours, rest) = levels.as_chunks::<4>();
        for four in fours {
            for (turn, &level) in turns.iter_mut().zip(four) {
                turn[usize::from(level)] += 1;
            }
        }
        for &level in rest {
            turns[0][usize::from(level)] += 1;
        }
    }
    std::array::from_fn(|level| turns.iter().map(|turn| u64::from(turn[level])).sum())
}

/// Parts of a row that are counted side by side.
const PARTS: usize = 4;

/// Pixels of each value, by channel.
type Values = [[u32; 256]; 3];

/// Pixels of each value in each bin, those of levels without a count left out.
fn count_by_bin(seen: Seen<'_>, bin_of: &[u8; LEVELS], counts: &[u64; LEVELS]) -> Vec<Values> {
    // One bin more for what is left out.
    let bins = BINS as usize + 1;
    let place: [u8; LEVELS] =
        std::array::from_fn(|level| if counts[level] == 0 { BINS as u8 } else { bin_of[level] });
    let mut counted = vec![[[0; 256]; 3]; bins];
    let mut add = |pixel: &[u8; 3], level: u8| {
        let values = &mut counted[usize::from(place[usize::from(level)])];
        for (values, &value) in values.iter_mut().zip(pixel) {
            values[usize::from(value)] += 1;
        }
    };
    for (pixels, levels) in seen.rows() {
        // As in `count`: pixels of four parts take turns, which are seldom alike.
        let part = pixels.len() / PARTS;
        let (rest, rest_of_levels) = (&pixels[PARTS * part..], &levels[PARTS * part..]);
        let parts: [_; PARTS] =
            std::array::from_fn(|i| (&pixels[i * part..][..part], &levels[i * part..][..part]));
        for i in 0..part {
            for (pixels, levels) in parts {
                add(&pixels[i], levels[i]);
            }
        }
        for (pixel, &level) in rest.iter().zip(rest_of_levels) {
            add(pixel, level);
        }
    }
    counted.truncate(BINS as usize);
    counted
}

impl<E: Encoding> Bin<E> {
    /// The byte that `share` of the pixels do not exceed, between bytes by the rank within the byte.
    fn quantile(&self, channel: usize, share: f64) -> f64 {
        let rank = share * self.count as f64;
        let mut seen = 0.0;
        for (value, &count) in self.values[channel].iter().enumerate() {
            let next = seen + f64::from(count);
            if count > 0 && next >= rank {
                let within = (rank - seen) / f64::from(count) - 0.5;
                return (value as f64 + within).clamp(0.0, 255.0);
            }
            seen = next;
        }
        255.0
    }

    /// How many of its pixels have less than `value`.
    pub(super) fn below(&self, channel: usize, value: u8) -> u64 {
        self.values[channel][..usize::from(value)].iter().map(|&count| u64::from(count)).sum()
    }

    /// The dark end: [`Bin::quantile`] in bytes, and the deviation of all values, in bytes.
    pub(super) fn dark(&self, channel: usize, share: f64) -> Dark {
        let (mut sum, mut squares) = (0, 0);
        for (value, &count) in (0_u32..256).zip(&self.values[channel]) {
            sum += u64::from(value) * u64::from(count);
            squares += u64::from(value * value) * u64::from(count);
        }
        let mean = sum as f64 / self.count as f64;
        let variance = (squares as f64 / self.count as f64 - mean * mean).max(0.0);
        Dark { value: self.quantile(channel, share) as f32, spread: variance.sqrt() as f32 }
    }

    /// The mean value.
    pub(super) fn mean(&self, channel: usize) -> f32 {
        let sum: f64 = (0_u16..256)
            .zip(&self.values[channel])
            .map(|(byte, &count)| f64::from(E::from_encoded(f32::from(byte) / 255.0)) * f64::from(count))
            .sum();
        (sum / self.count as f64) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Encoded, Image};

    #[test]
    fn a_bin_knows_its_quantiles_and_its_mean() {
        let samples: Vec<u8> = (0..100).flat_map(|v| [v, 2 * v, 100]).collect();
        let image = Image::from_raw(100, 1, samples).unwrap();
        let depth = Quantised { levels: vec![7; 100].into(), step: 0.5, beyond: None };
        let statistics = Statistics::<Encoded>::of_all(image.view(), &depth);
        let [bin] = &statistics.bins[..] else { panic!("flat depth is one bin") };
        assert_eq!((bin.z, statistics.z95), (3.5, 3.5));
        assert!((bin.quantile(0, 0.5) - 49.5).abs() < 1.0);
        assert!((bin.dark(0, 0.5).spread - 28.9).abs() < 0.1);
        assert!((bin.mean(1) * 255.0 - 99.0).abs() < 1e-3);
    }
}
