//! What optical depth a depth from colour must have, from the water's colour alone.

use super::super::statistics::Statistics;
use super::posterior::Grid;
use crate::depth::DepthModel;
use crate::image::Encoding;

/// A grey thing near by, encoded: the middle of what stands on a sea floor. Between .3 and .5 little changes.
const GREY: f32 = 0.4;
/// How much faster red and blue fade than green in most waters.
const SLOPE: [f32; 3] = [1.5, 1.0, 1.1];
/// Optical depths tried, of green; at the last nothing of the thing is left.
const STEPS: usize = 64;
const LAST: f32 = 6.0;

/// Optical depth β_B z95 per channel that serves depth from colour best, where open water has been seen.
///
/// A grey thing that moves away changes its colour along a known line, from grey to B∞, and with it the depth
/// that `model` reads off it. That gives the depth factor of each depth; the single exponential nearest to it
/// over the image's depths is the answer. None where the model is no function of one pixel.
pub(super) fn optical_depth<E: Encoding>(
    statistics: &Statistics<E>,
    veil: [f32; 3],
    model: DepthModel,
    tried: &Grid,
) -> Option<[f32; 3]> {
    let depth_of = model.of_colours()?;
    let grey = E::from_encoded(GREY);
    let mut line: Vec<(f32, f32)> = Vec::with_capacity(STEPS);
    for step in 0..STEPS {
        let t = LAST * step as f32 / (STEPS - 1) as f32;
        let colour = std::array::from_fn(|c| {
            let left = (-t * SLOPE[c]).exp();
            E::to_encoded(grey * left + veil[c] * (1.0 - left))
        });
        // Depth may only rise along the line, or it could not be read backwards.
        let before = line.last().map_or(0.0, |&(z, _)| z);
        line.push((depth_of(colour).max(before), t));
    }
    let of_bins: Vec<f32> = statistics.bins.iter().map(|bin| thickness_around(&line, bin.z)).collect();
    let best = |c: usize| {
        // What the line says is left of each bin.
        let of_bins: Vec<f32> = of_bins.iter().map(|t| (-t * SLOPE[c]).exp()).collect();
        let misfit = |factors: &[f32]| -> f32 {
            factors.iter().zip(&of_bins).map(|(factor, left)| (factor - left).powi(2)).sum()
        };
        let costs = tried.iter().map(|(ln_tau, factors)| (ln_tau, misfit(factors)));
        costs.min_by(|(_, a), (_, b)| a.total_cmp(b)).map_or(0.0, |(ln_tau, _)| ln_tau)
    };
    Some(std::array::from_fn(best))
}

/// Optical depth of green at which the line has the level of depth `z`: the middle of where it stays there.
fn thickness_around(line: &[(f32, f32)], z: f32) -> f32 {
    0.5 * (thickness(line, z - HALF_LEVEL) + thickness(line, z + HALF_LEVEL))
}

/// Half a level of depth.
const HALF_LEVEL: f32 = 0.5 / 255.0;

/// Optical depth of green at which the line first has this depth.
fn thickness(line: &[(f32, f32)], z: f32) -> f32 {
    let after = line.partition_point(|&(depth, _)| depth < z);
    match (after.checked_sub(1).and_then(|i| line.get(i)), line.get(after)) {
        (None, _) => 0.0,
        (Some(_), None) => LAST,
        (Some(&(z0, t0)), Some(&(z1, t1))) => t0 + (t1 - t0) * (z - z0) / (z1 - z0),
    }
}
