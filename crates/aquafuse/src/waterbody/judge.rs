//! From what the fits found to intervals and a verdict. Every number here was measured on truth scenes of
//! reefs in synthetic waters; the tables of `docs/results.md` try them on harbours in Jerlov's waters.

use std::f32::consts::{FRAC_1_SQRT_2, PI};

use super::backscatter::Growth;
use super::quality::{Quality, Reason, Reasons};
use super::share::FAINTEST_WATER;
use super::statistics::Statistics;
use super::veiling_light::{Reading, VeilingLightSource};
use super::{Intervals, attenuation};
use crate::depth::DepthMap;
use crate::image::Encoding;

/// Deviations of a normal error to either side that hold nine in ten.
const NINE_IN_TEN: f32 = 1.645;
/// Error of B∞ beside the standard error of its reading and [`rounding`], in bytes.
const BESIDES: f32 = 0.04;
/// Weights of the deviations of ln β_B and ln B∞, and a base, in the error of ln β_B.
const OF_GROWTH: Cases<[f32; 3]> =
    Cases { open: [1.2, 0.0, 0.05], given: [1.0, 1.0, 0.1], from_colour: [4.5, 2.0, 0.15] };
/// Weight of the deviation of ln B∞, and a base, in its error where no open water was seen.
const OF_VEIL: Cases<[f32; 2]> = Cases { open: [0.0; 2], given: [1.0, 0.1], from_colour: [4.0, 0.28] };

/// A figure for each case: open water seen; none, with given depth; none, with depth from colour.
struct Cases<T> {
    open: T,
    given: T,
    from_colour: T,
}

impl<T> Cases<T> {
    fn of(self, light: &Reading, depth: &DepthMap) -> T {
        match light.source {
            VeilingLightSource::OpenWater => self.open,
            _ if !depth.is_measured() => self.from_colour,
            _ => self.given,
        }
    }
}

/// Error that rounding leaves in a mean of bytes whose values deviate by `noise`, in bytes: without noise all are rounded the same
/// way; noise of deviation σ before rounding makes of a mean a sine about the truth, of amplitude `e^(-2π²σ²) / π`.
fn rounding(noise: f32) -> f32 {
    // Rounding itself deviates by the root of a twelfth.
    let before = (noise * noise - 1.0 / 12.0).max(0.0);
    (-2.0 * PI * PI * before).exp() / PI * FRAC_1_SQRT_2
}

/// How far off the numbers may be.
pub(super) fn intervals<E: Encoding>(growth: &Growth, light: &Reading, depth: &DepthMap) -> Intervals {
    let open = light.source == VeilingLightSource::OpenWater;
    let [of_growth, of_veil, base] = OF_GROWTH.of(light, depth);
    let [of_guess, guess] = OF_VEIL.of(light, depth);
    let veiling_light = std::array::from_fn(|c| {
        if open {
            let half =
                NINE_IN_TEN * light.standard_error[c].hypot(rounding(light.noise).hypot(BESIDES) / 255.0);
            [-half, half].map(|off| E::from_encoded((light.rgb[c] + off).clamp(0.0, 1.0)))
        } else {
            let half = NINE_IN_TEN * (of_guess * growth.ln_veil_deviation[c]).hypot(guess);
            [-half, half].map(|ln| (growth.veil[c] * ln.exp()).min(1.0))
        }
    });
    let backscatter_coefficient = std::array::from_fn(|c| {
        let known = (of_growth * growth.ln_deviation[c]).hypot(of_veil * growth.ln_veil_deviation[c]);
        let half = NINE_IN_TEN * known.hypot(base);
        [-half, half].map(|ln| growth.coefficient[c] * ln.exp())
    });
    Intervals { veiling_light, backscatter_coefficient }
}

/// A channel whose veil is fainter (encoded) hides its errors: 25 % of β_B moves no pixel by 1.2 steps of a byte.
const VISIBLE: f32 = 0.05;
/// What is asked of a fit: the largest expected floor, the least share of bins on the curve, the largest
/// deviation of ln β_B, the largest L_z. Depth from colour cannot be asked for as much: its β_B has no truth.
struct Demands {
    floor: f32,
    on_curve: f32,
    ln_deviation: f32,
    l_z: f32,
}
const GIVEN: Demands = Demands { floor: 0.03, on_curve: 0.6, ln_deviation: 0.07, l_z: 0.1 };
const FROM_COLOUR: Demands = Demands { floor: 0.08, on_curve: 0.25, ln_deviation: 0.5, l_z: 0.65 };

/// Open water that is less likely than this may be a smooth thing: of 31 photographs of which a person could not say whether
/// open water is in view, none is surer and `good`.
const SURE: f32 = 0.99;
/// Depths that span less than this share of z95 are alike.
const FLAT: f32 = 0.12;
/// More than this share of the image at one end of the levels of depth from colour is too much.
const SATURATED: f64 = 0.6;
/// No water scatters as much red as green or blue, nor all three this much (encoded): that is glare.
const GLARE: f32 = 0.7;
/// Red is dead where fewer than this share of the pixels reach this byte.
const LIVELY: f64 = 0.1;
const LIVELY_RED: u8 = 12;

/// Everything that speaks against an estimate.
pub(super) fn quality<E: Encoding>(
    growth: &Growth,
    light: &Reading,
    statistics: &Statistics<E>,
    attenuation: &[attenuation::Fit; 3],
    depth: &DepthMap,
) -> Quality {
    let from_colour = depth.model().is_some();
    let demands = if depth.is_measured() { GIVEN } else { FROM_COLOUR };
    let visible = |c: &usize| E::to_encoded(growth.veil[*c]) >= VISIBLE;
    let any = |holds: &dyn Fn(usize) -> bool| (0..3).filter(visible).any(holds);
    let mut reasons = Reasons::default();
    reasons.add_if(light.source != VeilingLightSource::OpenWater, Reason::NoOpenWater);
    let is_faint = light.rgb.iter().all(|&channel| channel < FAINTEST_WATER);
    let is_unsure = light.seen.is_some_and(|seen| seen < SURE || is_faint);
    reasons.add_if(is_unsure && !depth.is_measured(), Reason::OpenWaterUnsure);
    reasons.add_if(is_flat(statistics), Reason::FlatDepth);
    reasons.add_if(from_colour && is_saturated(statistics), Reason::SaturatedDepth);
    reasons.add_if(is_glare(growth.veil.map(E::to_encoded)), Reason::LightOutsideWaterHues);
    reasons.add_if(any(&|c| growth.on_curve[c] < demands.on_curve), Reason::LargeResidual);
    let few_dark =
        |c: usize| growth.floor[c] > demands.floor || growth.ln_deviation[c] > demands.ln_deviation;
    reasons.add_if(any(&few_dark), Reason::FewDarkPixels);
    reasons.add_if(is_red_dead(statistics), Reason::DeadRed);
    let l_z = attenuation.iter().map(|fit| fit.residual).fold(0.0, f32::max);
    reasons.add_if(l_z > demands.l_z, Reason::AttenuationNotConverged);
    Quality::of(reasons)
}

fn is_flat<E: Encoding>(statistics: &Statistics<E>) -> bool {
    let (Some(near), Some(far)) = (statistics.bins.first(), statistics.bins.last()) else { return true };
    far.z - near.z < FLAT * statistics.z95
}

fn is_saturated<E: Encoding>(statistics: &Statistics<E>) -> bool {
    statistics.at_ends.iter().any(|&share| share > SATURATED)
}

fn is_glare([red, green, blue]: [f32; 3]) -> bool {
    red >= green.max(blue) || red.min(green).min(blue) > GLARE
}

fn is_red_dead<E: Encoding>(statistics: &Statistics<E>) -> bool {
    let (mut all, mut dead) = (0, 0);
    for bin in &statistics.bins {
        all += bin.count;
        dead += bin.below(0, LIVELY_RED);
    }
    all > 0 && (all - dead) as f64 <= LIVELY * all as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_errs_as_much_as_means_of_rounded_values_do() {
        for deviation in [0.2_f32, 0.35, 0.5] {
            // Means of values rounded to whole numbers, their truth anywhere between two; noise by its own quantiles.
            let steps = 4000;
            let noise: Vec<f32> =
                (0..steps).map(|i| deviation * quantile((i as f32 + 0.5) / steps as f32)).collect();
            let mean = |of: &dyn Fn(f32) -> f32| noise.iter().map(|&off| of(off)).sum::<f32>() / steps as f32;
            let truths = (0..50).map(|i| i as f32 / 50.0);
            let squared: f32 = truths.map(|truth| (mean(&|off| (truth + off).round()) - truth).powi(2)).sum();
            let found = rounding(deviation.hypot((1.0_f32 / 12.0).sqrt()));
            let measured = (squared / 50.0).sqrt();
            assert!(
                (found - measured).abs() < 0.05 * measured + 1e-3,
                "{found} for {measured} at {deviation}"
            );
        }
    }

    /// Of a normal value, by halving.
    fn quantile(share: f32) -> f32 {
        let (mut low, mut high) = (-6.0, 6.0);
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            let below = 0.5 * (1.0 + erf(middle * FRAC_1_SQRT_2));
            if below < share { low = middle } else { high = middle }
        }
        low
    }

    /// Abramowitz and Stegun, 7.1.26.
    fn erf(x: f32) -> f32 {
        let t = 1.0 / (1.0 + 0.327_591_1 * x.abs());
        let series = [0.254_829_6, -0.284_496_74, 1.421_413_7, -1.453_152, 1.061_405_4];
        let sum = series.iter().rev().fold(0.0, |sum, a| (sum + a) * t);
        (1.0 - sum * (-x * x).exp()).copysign(x)
    }
}
