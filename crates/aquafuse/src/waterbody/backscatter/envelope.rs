//! The dark envelope: how dark the darkest things of each depth are.

use super::super::statistics::Statistics;
use crate::image::Encoding;

/// Quantile of a bin that stands for its darkest things. Black things are rare, less than 1 % of many pictures;
/// of 400 pixels this is the second darkest.
const DARK: f64 = 0.004;
/// How many standard deviations noise alone moves that quantile down where all of a bin has one colour, and
/// where a few dark pixels stand apart from the rest.
const MOVED: [f32; 2] = [2.65, 0.9];

/// One bin of depth, in one channel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    /// z in units of z95.
    pub(super) z: f32,
    /// The darkest things, what noise took from them given back, in the encoding of the fit.
    pub(super) dark: f32,
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
        let around = |step: f32| E::from_encoded((encoded + step).clamp(0.0, 1.0));
        Point {
            z: bin.z / statistics.z95,
            dark: E::from_encoded(encoded),
            slope: ((around(STEP) - around(-STEP)) / (2.0 * STEP)).max(0.02),
        }
    };
    statistics.bins.iter().map(point).collect()
}

/// Over what the slope is taken: five steps of a byte, so that the foot of the curve is not mistaken for all of it.
const STEP: f32 = 5.0 / 255.0;
