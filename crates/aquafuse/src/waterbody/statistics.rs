//! What the estimators read: the colours of a picture counted by depth, in one pass.

use std::marker::PhantomData;

use crate::depth::{LEVELS, Quantised};
use crate::image::{Encoding, Image};

/// Bins over depth. Fewer blur the curve, more leave too few pixels for a dark quantile in each.
const BINS: usize = 11;
/// The bins span these shares of the depths; what lies outside joins the outermost bins.
const SPAN: [f64; 2] = [0.02, 0.98];
/// Share of the pixels a bin must hold to be read, and the least number: a 2 % quantile of fewer is noise.
const LEAST_SHARE: f64 = 0.002;
const LEAST_PIXELS: u64 = 50;

/// Colours counted by depth.
pub(super) struct Statistics<E: Encoding> {
    /// The bins that hold enough pixels, near to far.
    pub(super) bins: Vec<Bin<E>>,
    /// z that 95 % of the pixels do not exceed, those beyond the steps of depth left out; the scale on which
    /// coefficients are bounded. Never 0.
    pub(super) z95: f32,
}

/// The colours of one range of depths.
pub(super) struct Bin<E: Encoding> {
    /// Mean z of its pixels.
    pub(super) z: f32,
    count: u64,
    values: [[u32; 256]; 3],
    encoding: PhantomData<E>,
}

impl<E: Encoding> Statistics<E> {
    /// Counts `image` by its depth. What lies beyond the steps of depth tells the veiling light, but not how
    /// fast anything grows with distance: it joins no bin, unless there is nothing else.
    pub(super) fn gather(image: &Image<u8>, depth: &Quantised<'_>) -> Self {
        let Quantised { levels, step, beyond } = depth;
        let mut counts = [0_u64; LEVELS];
        for &level in levels.iter() {
            counts[usize::from(level)] += 1;
        }
        if let Some(beyond) = beyond.map(usize::from)
            && counts[beyond] < levels.len() as u64
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
        let [low, high] = SPAN.map(level_at);
        let bin_of: [u8; LEVELS] = std::array::from_fn(|level| {
            let inside = level.clamp(low, high) - low;
            (inside * BINS / (high - low + 1)) as u8
        });
        let mut bins: Vec<Bin<E>> = (0..BINS).map(|_| Bin::default()).collect();
        for (pixel, &level) in image.pixels().iter().zip(levels.iter()) {
            if counts[usize::from(level)] == 0 {
                continue;
            }
            let bin = &mut bins[usize::from(bin_of[usize::from(level)])];
            for (values, &value) in bin.values.iter_mut().zip(pixel) {
                values[usize::from(value)] += 1;
            }
        }
        for (index, bin) in bins.iter_mut().enumerate() {
            let members = (0..LEVELS).filter(|&level| usize::from(bin_of[level]) == index);
            let weighted: u64 = members.clone().map(|level| counts[level] * level as u64).sum();
            bin.count = members.map(|level| counts[level]).sum();
            bin.z = (weighted as f64 / bin.count.max(1) as f64) as f32 * step;
        }
        let enough = ((LEAST_SHARE * total) as u64).max(LEAST_PIXELS);
        bins.retain(|bin| bin.count >= enough);
        // Depth that is 0 everywhere has no scale; any will do, since no coefficient can be read off it.
        let z95 = level_at(0.95).max(1) as f32 * step;
        Self { bins, z95 }
    }
}

impl<E: Encoding> Default for Bin<E> {
    fn default() -> Self {
        Self { z: 0.0, count: 0, values: [[0; 256]; 3], encoding: PhantomData }
    }
}

impl<E: Encoding> Bin<E> {
    /// The value that `share` of the pixels do not exceed, between bytes by the rank within the byte.
    ///
    /// Quantiles commute with the transfer function, so they are read from bytes and then converted.
    pub(super) fn quantile(&self, channel: usize, share: f64) -> f32 {
        let rank = share * self.count as f64;
        let mut seen = 0.0;
        for (value, &count) in self.values[channel].iter().enumerate() {
            let next = seen + f64::from(count);
            if count > 0 && next >= rank {
                let within = (rank - seen) / f64::from(count) - 0.5;
                return E::from_encoded(((value as f64 + within).clamp(0.0, 255.0) / 255.0) as f32);
            }
            seen = next;
        }
        E::from_encoded(1.0)
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
    use crate::image::Encoded;

    #[test]
    fn a_bin_knows_its_quantiles_and_its_mean() {
        let samples: Vec<u8> = (0..100).flat_map(|v| [v, 2 * v, 100]).collect();
        let image = Image::from_raw(100, 1, samples).unwrap();
        let depth = Quantised { levels: vec![7; 100].into(), step: 0.5, beyond: None };
        let statistics = Statistics::<Encoded>::gather(&image, &depth);
        let [bin] = &statistics.bins[..] else { panic!("flat depth is one bin") };
        assert_eq!((bin.z, statistics.z95), (3.5, 3.5));
        assert!((bin.quantile(0, 0.5) * 255.0 - 49.5).abs() < 1.0);
        assert!((bin.mean(1) * 255.0 - 99.0).abs() < 1e-3);
    }
}
