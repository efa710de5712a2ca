//! How fast backscatter grows with distance, fitted to the darkest pixels (Eq. 5).

use super::statistics::Statistics;
use crate::image::Encoding;

/// What tells how fast backscatter grows with distance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BackscatterMethod {
    /// The darkest things of each depth, with a floor, and all three channels together.
    #[default]
    Envelope,
    /// The paper's: the darkest 1 % of the whole picture is taken to be black, the curve fitted to it.
    Published,
}

/// Quantile of a depth bin that stands for its darkest things. The paper takes the darkest 1-5 %.
const DARK: f64 = 0.02;
/// The darkest thing at distance 0 is not black: encoded colour of a shadow seen through no water.
const SHADOW: f32 = 0.04;
/// Optical depth β_B z95 expected before looking, and how far (as a factor) one picture strays from it.
///
/// β_B itself has no scale of its own: colour depth often ends at .12 to .6 of its range, so the same water
/// gives very different β_B. Of all fixed answers an optical depth of 1.2 did best on truth scenes.
const EXPECTED: f32 = 1.2;
const SPREAD: f32 = 2.0;
/// Optical depths outside are not believed: thinner cannot be told from none, thicker from opaque.
const RANGE: [f32; 2] = [0.05, 8.0];
/// Residuals beyond this (encoded) count linearly, not squared: bins without a dark thing lie above the curve.
const NOISE: f32 = 0.03;
/// Steps of ln τ tried over [`RANGE`]; the best is refined by a parabola, so this need not be fine.
const STEPS: usize = 96;

/// Fits β_B of one channel: the dark quantile of each depth bin is to equal
/// `B∞ (1 - e^(-β_B z)) + shadow e^(-β_B z)`.
///
/// The search is over ln(β_B z95), so the unit of z cancels. Where the bins say nothing (water as dark as
/// shadow, flat depth) the answer falls back to the expected optical depth, smoothly.
pub(super) fn fit<E: Encoding>(statistics: &Statistics<E>, channel: usize, veiling_light: f32) -> f32 {
    let shadow = E::from_encoded(SHADOW).min(veiling_light);
    let noise = E::from_encoded(NOISE);
    let envelope: Vec<(f32, f32)> =
        statistics.bins.iter().map(|bin| (bin.z / statistics.z95, bin.quantile(channel, DARK))).collect();
    let cost = |ln_tau: f32| {
        let tau = ln_tau.exp();
        let misfit: f32 = envelope
            .iter()
            .map(|&(z, dark)| {
                let factor = (-tau * z).exp();
                huber((veiling_light * (1.0 - factor) + shadow * factor - dark) / noise)
            })
            .sum();
        misfit + 0.5 * ((ln_tau - EXPECTED.ln()) / SPREAD.ln()).powi(2)
    };
    let [low, high] = RANGE.map(f32::ln);
    let step = (high - low) / STEPS as f32;
    let at = |i: usize| low + step * i as f32;
    let costs: Vec<f32> = (0..=STEPS).map(|i| cost(at(i))).collect();
    let best = (0..=STEPS).min_by(|&i, &j| costs[i].total_cmp(&costs[j])).unwrap_or(0);
    let ln_tau = if best == 0 || best == STEPS {
        at(best)
    } else {
        at(best) + step * vertex(costs[best - 1], costs[best], costs[best + 1])
    };
    ln_tau.exp() / statistics.z95
}

/// Squared near 0, linear far away.
fn huber(x: f32) -> f32 {
    let x = x.abs();
    if x <= 1.0 { 0.5 * x * x } else { x - 0.5 }
}

/// Where the parabola through three even places has its minimum, in steps from the middle one.
fn vertex(left: f32, middle: f32, right: f32) -> f32 {
    let curvature = left - 2.0 * middle + right;
    if curvature > 0.0 { (0.5 * (left - right) / curvature).clamp(-0.5, 0.5) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::depth::Quantised;
    use crate::image::{Encoded, Image};

    /// Columns of rising depth, each with its share of shadow; the rest is bright.
    fn seen_through(beta: f32, veil: f32) -> (Image<u8>, Vec<u8>) {
        let (mut samples, mut levels) = (Vec::new(), Vec::new());
        for y in 0..64 {
            for level in 0..=255_u8 {
                let factor = (-beta * f32::from(level) / 255.0).exp();
                let clear = if y % 16 == 0 { SHADOW } else { 0.5 };
                let value = veil * (1.0 - factor) + clear * factor;
                samples.extend([(255.0 * value + 0.5) as u8; 3]);
                levels.push(level);
            }
        }
        (Image::from_raw(256, 64, samples).unwrap(), levels)
    }

    fn gathered(image: &Image<u8>, levels: &[u8], step: f32) -> Statistics<Encoded> {
        Statistics::gather(image, &Quantised { levels: levels.into(), step, beyond: None })
    }

    #[test]
    fn a_clean_envelope_gives_its_coefficient_back() {
        for beta in [0.8, 1.5, 3.0] {
            let (image, levels) = seen_through(beta, 0.6);
            let found = fit(&gathered(&image, &levels, 1.0 / 255.0), 1, 0.6);
            assert!((found / beta - 1.0).abs() < 0.12, "{found} for {beta}");
        }
    }

    #[test]
    fn the_unit_of_depth_cancels() {
        let (image, levels) = seen_through(1.5, 0.6);
        let beta = |step| fit(&gathered(&image, &levels, step), 0, 0.6);
        assert!((beta(1.0) * 100.0 / beta(0.01) - 1.0).abs() < 1e-4);
    }

    #[test]
    fn water_as_dark_as_shadow_gives_the_expected_optical_depth() {
        let image = Image::from_raw(256, 1, vec![0; 768]).unwrap();
        let levels: Vec<u8> = (0..=255).collect();
        let statistics = gathered(&image, &levels, 1.0 / 255.0);
        assert!((fit(&statistics, 0, 0.0) * statistics.z95 / EXPECTED - 1.0).abs() < 1e-2);
    }
}
