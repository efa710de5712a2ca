//! Waters as the sea may show them, by number: type, depth, camera and exposure drawn together.

use super::{Camera, Conditions, Preset};
use crate::random::{GOLDEN, split_mix};

/// How far below the surface, metres, evenly in the logarithm.
const DEPTHS: [f64; 2] = [1.0, 20.0];
/// How far the peaks of a camera lie from the usual ones, nm, and how many times as wide its channels are.
const PEAKS: f64 = 10.0;
const WIDTHS: [f64; 2] = [0.8, 1.3];
/// The encoded value of white.
const LEVELS: [f64; 2] = [0.6, 1.0];
/// How many times as bright as usual open water is.
const VEILS: [f64; 2] = [0.5, 1.1];

/// The water of this number: a type of Jerlov's, and where and with what camera it is looked at.
///
/// The type is drawn evenly; the depth below the surface from 1 to 20 m, evenly in its logarithm; the peaks of the camera ± 10 nm
/// and its widths times .8 to 1.3; how far it balances itself from not at all to whole; the encoded value of white from .6 to 1; the
/// brightness of open water times .5 to 1.1. The same number is the same water on every machine.
///
/// # Examples
///
/// ```
/// use aquafuse::waterbody::{Estimate, presets::sea};
///
/// let [one, other] = [1, 2].map(|number| {
///     let (preset, conditions) = sea(number);
///     preset.estimate::<aquafuse::image::Encoded>(&conditions)
/// });
/// assert_ne!(one.water.veiling_light, other.water.veiling_light);
/// ```
pub fn sea(number: u32) -> (Preset, Conditions) {
    let mut state = u64::from(number).wrapping_mul(GOLDEN);
    // 53 bits, as many as the float has.
    let mut share = || (split_mix(&mut state) >> 11) as f64 / (1_u64 << 53) as f64;
    let mut between = |[low, high]: [f64; 2]| low + (high - low) * share();
    let preset = Preset::ALL[between([0.0, Preset::ALL.len() as f64]) as usize];
    let depth = between(DEPTHS.map(f64::ln)).exp();
    let (balance, level, veil) = (between([0.0, 1.0]), between(LEVELS), between(VEILS));
    let usual = Camera::default();
    let peaks = usual.peaks_nm().map(|peak| peak + between([-PEAKS, PEAKS]));
    let widths = usual.deviations_nm().map(|width| width * between(WIDTHS));
    let camera = Camera::new(format!("camera of sea water {number}"), "drawn", peaks, widths);
    let conditions = Conditions::default().with_camera(camera.expect("in range"));
    let conditions = conditions
        .with_depth_below_surface(depth)
        .and_then(|conditions| conditions.with_balance(balance))
        .and_then(|conditions| conditions.with_white_level(level))
        .and_then(|conditions| {
            let usual = conditions.veil_factor();
            conditions.with_veil_factor(veil * usual)
        });
    (preset, conditions.expect("in range"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Encoded;

    #[test]
    fn all_types_come_and_all_numbers_are_in_range() {
        let drawn: Vec<_> = (0..2000).chain([u32::MAX]).map(sea).collect();
        for preset in Preset::ALL {
            let count = drawn.iter().filter(|(other, _)| other == preset).count();
            // Five standard deviations of a binomial of 2,001.
            assert!((133..=268).contains(&count), "{preset} comes {count} times");
        }
        let mean = drawn.iter().map(|(_, conditions)| conditions.depth_below_surface_m().ln()).sum::<f64>()
            / drawn.len() as f64;
        assert!((mean - 0.5 * 20.0_f64.ln()).abs() < 0.1, "{mean}");
    }

    #[test]
    fn these_waters_stay_what_they_are() {
        // A change here changes every dataset that was multiplied by numbers.
        let found = [0, 1, 31].map(|number| {
            let (preset, conditions) = sea(number);
            let water = preset.estimate::<Encoded>(&conditions).water;
            (preset.name(), water.veiling_light.rgb().map(|value| (255.0 * value).round() as u8))
        });
        assert_eq!(found, FIXED);
    }

    const FIXED: [(&str, [u8; 3]); 3] =
        [("jerlov-7C", [157, 154, 104]), ("jerlov-III", [61, 77, 77]), ("jerlov-IB", [65, 114, 139])];
}
