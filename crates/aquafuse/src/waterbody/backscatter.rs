//! How fast backscatter grows with distance (Eq. 5), and what that says about the veiling light.
//!
//! The darkest things of each depth form an envelope that follows the curve of backscatter. How well depends
//! on how dark they are and on how right depth is, so every optical depth τ = β_B z95 is weighed with every
//! floor, and the answer is a mean with a deviation. The paper's fit to the darkest 1 % stands beside it.

mod envelope;
mod mixing_line;
mod posterior;
mod published;
mod things;
mod veils;

use super::Seen;
use super::depth_factors::DepthFactors;
use super::statistics::Statistics;
use super::veiling_light::{Reading, VeilingLightSource};
use crate::depth::{DepthMap, Quantised};
use crate::image::Encoding;
use envelope::Point;
use posterior::{Bell, Grid, Posterior, Trust, weigh};
use veils::Veils;

/// How the growth of backscatter with distance is estimated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum BackscatterMethod {
    /// The darkest things of each depth, with a floor, and all three channels together.
    #[default]
    Envelope,
    /// The paper's: the darkest 1 % of the whole image is taken to be black, the curve fitted to it.
    Published,
}

/// ln τ expected before looking, and its deviation.
///
/// β_B itself has no scale of its own: colour depth often ends at .12 to .6 of its range, so the same water
/// gives very different β_B. Of all fixed answers an optical depth of 1.2 did best on truth scenes.
const EXPECTED: Bell = Bell { mean: 0.182, deviation: 0.8 };
/// Optical depths outside are not believed: thinner looks like none, thicker like opaque.
const RANGE: [f32; 2] = [0.03, 12.0];
/// Places of the first look over [`RANGE`], and of the second around what it found.
const COARSE: usize = 40;
const FINE: usize = 33;
/// How far the second look reaches, in deviations of the first; and its least deviation, since a first look
/// cannot see narrower than its own steps.
const REACH: f32 = 3.5;
const LEAST_DEVIATION: f32 = 0.06;

/// With given depth a bin is wrong by its byte, and where the veiling light is fitted with the curve by what its darkest
/// things are, which one floor for all bins does not show; with depth from colour by a good deal, and all bins alike.
const GIVEN: Trust = Trust { deviation: 1.0 / 255.0, weight: 1.0 };
const GIVEN_BEHIND_THINGS: Trust = Trust { weight: 0.2, ..GIVEN };
const FROM_COLOUR: Trust = Trust { deviation: 8.0 / 255.0, weight: 0.1 };
/// How far depth from colour strays from its mixing line.
const LINE_DEVIATION: f32 = 0.35;
/// Share of the camera's noise that stays in a bin's dark end.
const NOISE_LEFT: f32 = 1.0;

/// What makes red and blue thicker than green in most waters, as ln of the ratio, and how far waters stray.
const SLOPE: [f32; 3] = [0.262, 0.0, 0.095];
const SLOPE_DEVIATION: f32 = 0.3;

/// What was found, per channel.
pub(super) struct Growth {
    /// B∞ in the encoding of the fit; as read where open water was seen.
    pub(super) veil: [f32; 3],
    /// Deviation of ln B∞ that the curve leaves; 0 where open water was seen.
    pub(super) ln_veil_deviation: [f32; 3],
    /// β_B.
    pub(super) coefficient: [f32; 3],
    /// Deviation of ln β_B.
    pub(super) ln_deviation: [f32; 3],
    /// How dark the darkest things are (encoded), and share of the bins on the curve.
    pub(super) floor: [f32; 3],
    pub(super) on_curve: [f32; 3],
    /// F of depth from colour, where open water was seen.
    pub(super) depth_factors: Option<DepthFactors>,
}

/// The dark envelope of each channel, near to far.
pub(super) fn envelopes<E: Encoding>(statistics: &Statistics<E>, light: &Reading) -> [Vec<Point>; 3] {
    std::array::from_fn(|c| envelope::read(statistics, c, light.noise))
}

/// Fits β_B of all channels, and where no open water was seen B∞ with it.
///
/// The search is over ln(β_B z95), so the unit of z cancels. Where the bins say nothing (water as dark as
/// shadow, flat depth) the other channels answer up to the slope of most waters, and where these say nothing
/// either, the expected optical depth.
pub(super) fn fit<E: Encoding>(statistics: &Statistics<E>, light: &Reading, depth: &DepthMap) -> Growth {
    let veil = light.rgb.map(E::from_encoded);
    let open = light.source == VeilingLightSource::OpenWater;
    let envelopes = envelopes(statistics, light);
    let (base, veils): (_, fn(usize) -> Veils) = match (depth.is_measured(), open) {
        (true, true) => (GIVEN, |_| Veils::Seen),
        (true, false) => (GIVEN_BEHIND_THINGS, |channel| Veils::BehindThings { channel }),
        (false, true) => (FROM_COLOUR, |_| Veils::Seen),
        (false, false) => (FROM_COLOUR, |_| Veils::AboutAsRead),
    };
    let noise = NOISE_LEFT * light.noise / 255.0;
    let trust = Trust { deviation: base.deviation.hypot(noise), ..base };
    let bins: Vec<f32> = statistics.bins.iter().map(|bin| bin.z / statistics.z95).collect();
    let coarse = Grid::new(even(RANGE[0].ln(), RANGE[1].ln(), COARSE), &bins);
    let line = depth.model().filter(|_| open);
    let line = line.and_then(|model| mixing_line::optical_depth(statistics, veil, model, &coarse));
    let prior = |c: usize| match line {
        Some(ln_tau) => Bell { mean: ln_tau[c], deviation: LINE_DEVIATION },
        None => EXPECTED,
    };
    let look = |c: usize, prior: Bell, tried: &Grid| {
        weigh::<E>(&envelopes[c], veil[c], trust, prior, tried, veils(c))
    };

    let first: [Bell; 3] = std::array::from_fn(|c| {
        let seen = look(c, prior(c), &coarse).ln_tau;
        Bell { deviation: seen.deviation.max(LEAST_DEVIATION), ..seen }
    });
    let found: [Posterior; 3] = std::array::from_fn(|c| {
        let others = of_others(first, c);
        let near = first[c].and(others);
        let reach = REACH * near.deviation.max(LEAST_DEVIATION);
        let fine = Grid::new(even(near.mean - reach, near.mean + reach, FINE), &bins);
        look(c, prior(c).and(others), &fine)
    });
    let coefficient = found.each_ref().map(|found| found.ln_tau.mean.exp() / statistics.z95);
    let depth_factors = match depth.model() {
        Some(_) if open => things::by_coefficient(statistics, &envelopes, veil, coefficient),
        None if depth.is_inverse() => things::by_range(statistics, &envelopes, veil),
        _ => None,
    };
    Growth {
        veil: std::array::from_fn(|c| (veil[c] * found[c].ln_veil.mean.exp()).min(1.0)),
        ln_veil_deviation: found.each_ref().map(|found| found.ln_veil.deviation),
        coefficient,
        ln_deviation: found.each_ref().map(|found| found.ln_tau.deviation),
        floor: found.each_ref().map(|found| found.floor),
        on_curve: found.each_ref().map(|found| found.on_curve),
        depth_factors,
    }
}

/// Deviation of ln B∞ that the paper's way, which says nothing about its error, is believed to have.
const PUBLISHED_VEIL_DEVIATION: f32 = 0.3;

/// The paper's fit: its veiling light is taken as it is.
pub(super) fn fit_published<E: Encoding>(
    counted: Seen<'_>,
    quantised: &Quantised<'_>,
    statistics: &Statistics<E>,
    light: &Reading,
) -> Growth {
    let veil = light.rgb.map(E::from_encoded);
    let z: [Option<f32>; 256] = std::array::from_fn(|level| {
        let inside = quantised.beyond != Some(level as u8);
        inside.then_some(level as f32 * quantised.step / statistics.z95)
    });
    let taus = even(RANGE[0].ln(), RANGE[1].ln(), 3 * COARSE);
    let ln_tau = published::optical_depth::<E>(counted, &z, veil, &taus);
    Growth {
        veil,
        ln_veil_deviation: [PUBLISHED_VEIL_DEVIATION; 3],
        coefficient: ln_tau.map(|ln_tau| ln_tau.exp() / statistics.z95),
        ln_deviation: [EXPECTED.deviation; 3],
        floor: [0.0; 3],
        on_curve: [1.0; 3],
        depth_factors: None,
    }
}

/// What the other two channels say about channel `c`.
fn of_others(found: [Bell; 3], c: usize) -> Bell {
    let of = |other: usize| Bell {
        mean: found[other].mean - SLOPE[other] + SLOPE[c],
        deviation: found[other].deviation.hypot(SLOPE_DEVIATION),
    };
    of((c + 1) % 3).and(of((c + 2) % 3))
}

fn even(from: f32, to: f32, count: usize) -> Vec<f32> {
    (0..count).map(|i| from + (to - from) * i as f32 / (count - 1) as f32).collect()
}

#[cfg(test)]
mod tests {
    use super::super::veiling_light::Places;
    use super::*;
    use crate::image::{Encoded, Image, Linear};

    /// Columns of rising depth, each with its share of things as dark as `floor`; the rest is bright.
    fn seen_through<E: Encoding>(beta: f32, veil: f32, floor: f32) -> (Image<u8>, Vec<u8>) {
        let (mut samples, mut levels) = (Vec::new(), Vec::new());
        for y in 0..64 {
            for level in 0..=255_u8 {
                let factor = (-beta * f32::from(level) / 255.0).exp();
                let clear = if y % 16 == 0 { floor } else { 0.6 };
                let [veil, clear] = [veil, clear].map(E::from_encoded);
                let value = E::to_encoded(veil * (1.0 - factor) + clear * factor);
                samples.extend([(255.0 * value + 0.5) as u8; 3]);
                levels.push(level);
            }
        }
        (Image::from_raw(256, 64, samples).unwrap(), levels)
    }

    fn open_water(veil: f32) -> Reading {
        Reading {
            rgb: [veil; 3],
            source: VeilingLightSource::OpenWater,
            share: 0.2,
            places: Places::Cells(Vec::new()),
            standard_error: [0.0; 3],
            seen: None,
            level: None,
            noise: 0.3,
        }
    }

    fn found<E: Encoding>(image: &Image<u8>, levels: &[u8], step: f32, light: &Reading) -> (Growth, f32) {
        let quantised = Quantised { levels: levels.into(), step, beyond: None };
        let statistics = Statistics::<E>::of_all(image.view(), &quantised);
        let given = DepthMap::from_levels(image.width(), image.height(), levels.to_vec()).unwrap();
        (fit(&statistics, light, &given), statistics.z95)
    }

    fn assert_recovered<E: Encoding>() {
        for beta in [0.8, 1.5, 3.0] {
            for floor in [0.0, 0.04] {
                let (image, levels) = seen_through::<E>(beta, 0.6, floor);
                let (growth, _) = found::<E>(&image, &levels, 1.0 / 255.0, &open_water(0.6));
                for c in [1, 2] {
                    let off = growth.coefficient[c] / beta - 1.0;
                    assert!(off.abs() < 0.08, "{off} of {beta}, floor {floor}");
                }
            }
        }
    }

    #[test]
    fn a_clean_envelope_gives_its_coefficient_back_in_either_encoding() {
        assert_recovered::<Encoded>();
        assert_recovered::<Linear>();
    }

    #[test]
    fn the_unit_of_depth_cancels() {
        let (image, levels) = seen_through::<Encoded>(1.5, 0.6, 0.0);
        let beta = |step| found::<Encoded>(&image, &levels, step, &open_water(0.6)).0.coefficient[0];
        assert!((beta(1.0) * 100.0 / beta(0.01) - 1.0).abs() < 1e-4);
    }

    #[test]
    fn water_as_dark_as_shadow_gives_the_expected_optical_depth() {
        let image = Image::from_raw(256, 64, vec![0; 3 * 256 * 64]).unwrap();
        let levels: Vec<u8> = (0..64).flat_map(|_| 0..=255).collect();
        let (growth, z95) = found::<Encoded>(&image, &levels, 1.0 / 255.0, &open_water(0.0));
        let off = (growth.coefficient[1] * z95).ln() - EXPECTED.mean;
        assert!(off.abs() < 0.2, "{off}");
        assert!(growth.ln_deviation[1] > 0.15, "nothing was seen, so nothing is sure");
    }

    #[test]
    fn a_channel_that_says_nothing_follows_the_others() {
        // Red has no veil and no light; green and blue show thick water.
        let (image, levels) = seen_through::<Encoded>(4.0, 0.6, 0.0);
        let dead = image.pixels().iter().flat_map(|&[_, g, b]| [0, g, b]).collect();
        let image = Image::from_raw(256, 64, dead).unwrap();
        let light = Reading { rgb: [0.0, 0.6, 0.6], ..open_water(0.6) };
        let (growth, _) = found::<Encoded>(&image, &levels, 1.0 / 255.0, &light);
        let [red, green, _] = growth.coefficient;
        assert!(red > 0.7 * green && red < 2.0 * green, "{red} beside {green}");
    }

    #[test]
    fn without_open_water_the_curve_corrects_the_veil() {
        let (image, levels) = seen_through::<Encoded>(3.5, 0.6, 0.0);
        let light = Reading { source: VeilingLightSource::Farthest, ..open_water(0.7) };
        let (growth, _) = found::<Encoded>(&image, &levels, 1.0 / 255.0, &light);
        assert!((growth.veil[1] - 0.6).abs() < 0.04, "{}", growth.veil[1]);
    }

    #[test]
    fn the_published_fit_needs_black_and_is_right_with_it() {
        let (image, levels) = seen_through::<Encoded>(1.5, 0.6, 0.0);
        let quantised = Quantised { levels: (&levels[..]).into(), step: 1.0 / 255.0, beyond: None };
        let statistics = Statistics::<Encoded>::of_all(image.view(), &quantised);
        let growth = fit_published(
            Seen::whole(image.view(), &quantised.levels),
            &quantised,
            &statistics,
            &open_water(0.6),
        );
        assert!((growth.coefficient[1] / 1.5 - 1.0).abs() < 0.1, "{}", growth.coefficient[1]);
    }
}
