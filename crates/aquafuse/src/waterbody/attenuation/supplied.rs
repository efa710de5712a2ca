//! β_D where depth is supplied: beside β_B, which is then known well.

use super::{Attenuation, Fit, direct_signals, fit};
use crate::image::Encoding;
use crate::waterbody::statistics::Statistics;

/// β_D over β_B as most waters have it, and how far waters stray from it.
const BESIDE: f32 = 1.2;
const BESIDE_DEVIATION: f32 = 0.4;
/// How far the mean colours of near and far things are apart, as ln of their ratio: in brightness, and in each channel besides.
const BRIGHTNESS_DEVIATION: f32 = 0.6;
const HUE_DEVIATION: f32 = 0.15;

/// β_D of all channels from supplied distances, the same at each.
///
/// How fast the direct signal fades is β_D if near and far things are alike. They often differ in brightness and less in hue, and
/// β_D goes with β_B, which is known well once distances are. So the slopes of `-ln E` over z are
/// `s = β_D + a + e`, with an error a of all channels and one e of each, and `β_D = 1.2 β_B` with an error of its own, all of them
/// normal: the answer is the mean of β_D given s. Where `exchange` takes β_D from the slopes alone, it falls short of `physical`
/// however right depth is.
pub(in crate::waterbody) fn fit_supplied<E: Encoding>(
    statistics: &Statistics<E>,
    veiling_light: [f32; 3],
    backscatter_coefficient: [f32; 3],
) -> [Fit; 3] {
    let lines = std::array::from_fn(|c| {
        line(&direct_signals(statistics, c, veiling_light[c], backscatter_coefficient[c]))
    });
    let coefficients = weighed(lines, backscatter_coefficient.map(|beta| BESIDE * beta));
    std::array::from_fn(|c| {
        // This is the residual of the slope: it says whether things of all distances look alike.
        let by_slope = fit(statistics, c, veiling_light[c], backscatter_coefficient[c]);
        let curve = Attenuation { mu: [coefficients[c], 0.0, 0.0, 0.0], held_beyond: 0.0 };
        let at_camera =
            lines[c].map_or(by_slope.at_camera, |line| (line.ln + coefficients[c] * line.z).exp());
        Fit { curve, at_camera, ..by_slope }
    })
}

/// The straight line through the logarithm of a direct signal.
#[derive(Clone, Copy)]
struct Line {
    /// Mean z, and the mean of its squared deviations.
    z: f32,
    square: f32,
    /// Mean of ln, and how fast it falls with z.
    ln: f32,
    slope: f32,
}

/// None where there is nothing to draw it through.
fn line(direct: &[(f32, f32)]) -> Option<Line> {
    let count = direct.len() as f32;
    let mean = |of: &dyn Fn(&(f32, f32)) -> f32| direct.iter().map(of).sum::<f32>() / count;
    let (z, ln) = (mean(&|(z, _)| *z), mean(&|(_, signal)| signal.ln()));
    let square = mean(&|(at, _)| (at - z).powi(2));
    let product = mean(&|(at, signal)| (at - z) * (signal.ln() - ln));
    (square > 0.0).then(|| Line { z, square, ln, slope: -product / square })
}

/// The coefficients, by the lines and by what is expected beside β_B.
fn weighed(lines: [Option<Line>; 3], expected: [f32; 3]) -> [f32; 3] {
    // Variances of slopes: of what is expected, and of what a hue and a brightness make.
    let own = expected.map(|expected| (BESIDE_DEVIATION * expected).powi(2));
    let of = |c: usize| lines[c].filter(|_| own[c] > 0.0);
    let off = |c: usize, line: Line| line.slope - expected[c];
    let spread = |c: usize, line: Line| own[c] + HUE_DEVIATION.powi(2) / line.square;
    let (mut pulled, mut weight) = (0.0, 0.0);
    for (c, line) in (0..3).filter_map(|c| Some((c, of(c)?))) {
        let precision = spread(c, line).recip();
        // Once each channel's share of how well brightness is known.
        pulled += precision * off(c, line);
        weight += precision + line.square / (3.0 * BRIGHTNESS_DEVIATION.powi(2));
    }
    let brightness = if weight > 0.0 { pulled / weight } else { 0.0 };
    std::array::from_fn(|c| {
        let Some(line) = of(c) else { return expected[c] };
        (expected[c] + own[c] / spread(c, line) * (off(c, line) - brightness)).max(0.0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Encoded;
    use crate::waterbody::Waterbody;
    use crate::waterbody::presets::{Conditions, Preset};

    /// The line of signals that fade by `coefficient` per z, whose units are so many to one.
    fn fading(coefficient: f32, unit: f32) -> Option<Line> {
        let at = (1..30).map(|i| i as f32 * unit);
        line(&at.map(|z| (z, 0.8 * (-coefficient / unit * z).exp())).collect::<Vec<_>>())
    }

    #[test]
    fn the_unit_of_depth_cancels() {
        let found = |unit: f32| weighed([0.3, 0.1, 0.2].map(|slope| fading(slope, unit)), [0.2 / unit; 3]);
        let (metres, millimetres) = (found(1.0), found(1000.0));
        assert!(
            (0..3).all(|c| (metres[c] / millimetres[c] - 1000.0).abs() < 0.1),
            "{metres:?} {millimetres:?}"
        );
    }

    #[test]
    fn what_fades_as_expected_is_as_expected() {
        let found = weighed([0.2, 0.1, 0.15].map(|slope| fading(slope, 1.0)), [0.2, 0.1, 0.15]);
        assert!(found.iter().zip([0.2, 0.1, 0.15]).all(|(found, expected)| (found - expected).abs() < 1e-4));
        assert_eq!(weighed([None; 3], [0.2, 0.1, 0.15]), [0.2, 0.1, 0.15]);
    }

    #[test]
    fn a_far_end_of_another_brightness_moves_it_less_than_one_of_another_hue() {
        let moved = |slopes: [f32; 3]| weighed(slopes.map(|slope| fading(slope, 0.3)), [0.5; 3])[2] - 0.5;
        let (darker, bluer) = (moved([0.6; 3]), moved([0.5, 0.5, 0.6]));
        assert!(0.0 < darker && darker < 0.7 * bluer, "{darker} {bluer}");
    }

    #[test]
    fn tables_of_waters_stray_no_further_from_it() {
        let ratios: Vec<f32> = Preset::ALL
            .iter()
            .flat_map(|preset| {
                let water: Waterbody<Encoded> = preset.water(&Conditions::default());
                let far = 1.5 / water.backscatter_coefficient[1];
                [1, 2].map(|c| {
                    water.attenuation[c].optical_depth(far) / (water.backscatter_coefficient[c] * far)
                })
            })
            .collect();
        let within =
            ratios.iter().filter(|ratio| (*ratio / BESIDE).ln().abs() < 2.0 * BESIDE_DEVIATION).count();
        assert!(10 * within >= 9 * ratios.len(), "{ratios:?}");
    }
}
