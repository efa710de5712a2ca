//! The dark envelope: how dark the darkest things of each depth are.

use super::super::statistics::Statistics;
use crate::image::Encoding;

/// Quantile of a bin that stands for its darkest things. Black things are rare, less than 1 % of many images;
/// of 400 pixels this is the second darkest.
const DARK: f64 = 0.004;
/// How many standard deviations noise alone moves that quantile down where all of a bin has one colour, and
/// where a few dark pixels stand apart from the rest.
const MOVED: [f32; 2] = [2.65, 0.9];

/// One bin of depth, in one channel.
#[derive(Clone, Copy, Debug)]
pub(in crate::waterbody) struct Point {
    /// The darkest things, what noise took from them given back, in the encoding of the fit.
    pub(in crate::waterbody) dark: f32,
    /// How much of the encoding one step of an encoded value is there: 1 for encoded values.
    pub(super) slope: f32,
}

/// The envelope of one channel, near to far; `noise` is the camera's, in bytes.
pub(super) fn read<E: Encoding>(statistics: &Statistics<E>, channel: usize, noise: f32) -> Vec<Point> {
    let point = |bin: &super::super::statistics::Bin<E>| {
        let dark = bin.dark(channel, DARK);
        // 1 where the bin is no wider than noise, 0 where things differ by much more.
        let plain = (1.0 - (dark.spread - noise) / (4.0 * noise + 1e-3)).clamp(0.0, 1.0);
        let encoded = (dark.value + noise * (plain * MOVED[0] + (1.0 - plain) * MOVED[1])).min(255.0) / 255.0;
        // Cut at black and white, so that what is divided by is what was spanned.
        let [low, high] = [-STEP, STEP].map(|step| (encoded + step).clamp(0.0, 1.0));
        Point {
            dark: E::from_encoded(encoded),
            slope: ((E::from_encoded(high) - E::from_encoded(low)) / (high - low)).max(LEAST_SLOPE),
        }
    };
    statistics.bins.iter().map(point).collect()
}

/// The sRGB curve is flattest at black, where its slope is .077; nothing is trusted more than several times that.
const LEAST_SLOPE: f32 = 0.02;
/// Over what the slope is taken: five steps of a byte, so that the foot of the curve is not mistaken for all of it.
const STEP: f32 = 5.0 / 255.0;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::depth::Quantised;
    use crate::image::{Encoded, Image, Linear};

    #[test]
    fn a_step_of_an_encoded_value_is_itself_even_at_black_and_white() {
        for value in [0, 3, 128, 254, 255] {
            let image = Image::from_raw(64, 1, vec![value; 192]).unwrap();
            let depth = Quantised { levels: vec![9; 64].into(), step: 0.1, beyond: None };
            let [encoded] = &read(&Statistics::<Encoded>::of_all(image.view(), &depth), 1, 0.3)[..] else {
                panic!()
            };
            assert!((encoded.slope - 1.0).abs() < 1e-4, "{}", encoded.slope);
            let [linear] = &read(&Statistics::<Linear>::of_all(image.view(), &depth), 1, 0.3)[..] else {
                panic!()
            };
            assert!(linear.slope > 0.05 && linear.slope < 2.4, "{}", linear.slope);
        }
    }
}
