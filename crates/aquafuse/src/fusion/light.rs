//! How much the light on things, and the haze before them, change from one image's water to another's.

use crate::image::Encoding;

/// Bounds (encoded) of the gain of a channel, and of the brightness in it.
const GAIN: [f32; 2] = [0.4, 2.0];
const BRIGHTNESS: [f32; 2] = [0.6, 1.5];
/// How much of the ratio of colours, and of the ratio of brightness, is the light's: things and exposures differ, too.
const OF_HUE: f32 = 0.75;
const OF_BRIGHTNESS: f32 = 0.5;
/// Luma of red, green and blue (Rec. 601).
const LUMA: [f32; 3] = [0.299, 0.587, 0.114];
/// How much of the ratio of the coefficients is taken for haze, and its bound: both are estimates.
const OF_HAZE: f32 = 0.5;
const MOST_HAZE: f32 = 2.0;

/// What near things are multiplied by, from their colours ([`Estimate::near_colour`]) here and there: 1 for equal ones.
///
/// [`Estimate::near_colour`]: crate::waterbody::Estimate::near_colour
pub(super) fn gain<E: Encoding>(own: [f32; 3], other: [f32; 3]) -> [f32; 3] {
    let luma = |colour: [f32; 3]| -> f32 { (0..3).map(|c| LUMA[c] * colour[c]).sum() };
    let brighter = luma(other) / luma(own);
    let within = |gain: f32, [least, most]: [f32; 2]| {
        gain.clamp(E::from_encoded(least), E::from_encoded(most.recip()).recip())
    };
    let brightness = within(brighter.powf(OF_BRIGHTNESS), BRIGHTNESS);
    let gain: [f32; 3] =
        std::array::from_fn(|c| within((other[c] / own[c] / brighter).powf(OF_HUE) * brightness, GAIN));
    // Black things have no light to compare.
    if gain.iter().all(|gain| gain.is_finite()) { gain } else { [1.0; 3] }
}

/// How many times as thick as the content's water the reference's is, from β_B here and there, per one unit of z: 1 for equal ones.
pub(super) fn haze(own: [f32; 3], other: [f32; 3]) -> f32 {
    let mean = (0..3).map(|c| (other[c] / own[c]).ln()).sum::<f32>() / 3.0;
    let haze = (OF_HAZE * mean).exp().clamp(MOST_HAZE.recip(), MOST_HAZE);
    if haze.is_finite() { haze } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Encoded, Linear};

    #[test]
    fn equal_lights_change_nothing_and_no_light_is_out_of_bounds() {
        assert_eq!(gain::<Encoded>([0.2, 0.3, 0.1], [0.2, 0.3, 0.1]), [1.0; 3]);
        assert_eq!(gain::<Encoded>([0.0; 3], [0.0; 3]), [1.0; 3]);
        for (own, other) in
            [([0.9, 0.01, 0.5], [0.01, 0.9, 0.5]), ([1.0; 3], [0.01; 3]), ([0.01; 3], [1.0; 3])]
        {
            let encoded = gain::<Encoded>(own, other);
            assert!(encoded.iter().all(|gain| (0.4..=2.0).contains(gain)), "{encoded:?}");
            let linear = gain::<Linear>(own, other);
            assert!(linear.iter().all(|gain| (0.13..=4.7).contains(gain)), "{linear:?}");
        }
    }

    #[test]
    fn three_quarters_of_the_hue_and_half_of_the_brightness_go_over() {
        let [r, g, b] = gain::<Encoded>([0.2; 3], [0.15, 0.25, 0.3]);
        assert!((r / g - 0.6_f32.powf(0.75)).abs() < 1e-5 && (b / g - 1.2_f32.powf(0.75)).abs() < 1e-5);
        let brighter = gain::<Encoded>([0.2; 3], [0.3; 3]);
        assert!(brighter.iter().all(|gain| (gain - 1.5_f32.sqrt()).abs() < 1e-5), "{brighter:?}");
    }

    #[test]
    fn haze_is_the_root_of_the_ratio_within_bounds() {
        assert_eq!(haze([0.2, 0.3, 0.4], [0.2, 0.3, 0.4]), 1.0);
        assert!((haze([0.2; 3], [0.3; 3]) - 1.5_f32.sqrt()).abs() < 1e-6);
        for other in [[0.0; 3], [1e6; 3], [f32::NAN; 3]] {
            assert!((0.5..=2.0).contains(&haze([0.2; 3], other)));
        }
        assert_eq!(haze([0.0; 3], [0.0; 3]), 1.0);
    }
}
