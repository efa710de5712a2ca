//! The depth factors of things where β_B does not say them: no more backscatter than the darkest of them show.

use super::super::depth_factors::DepthFactors;
use super::super::statistics::Statistics;
use super::envelope::Point;
use crate::image::Encoding;

/// What is divided by is no less (in the encoding of the fit): a channel without a veil says nothing, and β_B stands.
const FAINTEST: f32 = 1e-3;

/// How fast F' of an inverse depth falls from its far end: `1 - e^(-RANGE (1 - z))`.
const RANGE: f32 = 3.0;

/// F' of depth from colour: `e^(-β_B z)`.
pub(super) fn by_coefficient<E: Encoding>(
    statistics: &Statistics<E>,
    envelopes: &[Vec<Point>; 3],
    veil: [f32; 3],
    coefficient: [f32; 3],
) -> Option<DepthFactors> {
    bounded(statistics, envelopes, veil, |z| coefficient.map(|beta| (-beta * z).exp()))
}

/// F' of an inverse depth, whose order is right and whose distances are not: at its far end things let nothing through, and at
/// its near one nearly all.
pub(super) fn by_range<E: Encoding>(
    statistics: &Statistics<E>,
    envelopes: &[Vec<Point>; 3],
    veil: [f32; 3],
) -> Option<DepthFactors> {
    bounded(statistics, envelopes, veil, |z| [1.0 - (-RANGE * (1.0 - z).max(0.0)).exp(); 3])
}

/// F' of each bin by its depth, but backscatter is never more than the darkest things there and beyond show, so that
/// `F' >= 1 - dark / B∞`; it never rises with z. `veil` is B∞ in the encoding of the fit.
fn bounded<E: Encoding>(
    statistics: &Statistics<E>,
    envelopes: &[Vec<Point>; 3],
    veil: [f32; 3],
    by_depth: impl Fn(f32) -> [f32; 3],
) -> Option<DepthFactors> {
    let bins = || statistics.bins.iter().enumerate().filter(|(_, bin)| bin.z > 0.0);
    let mut beyond = [0.0_f32; 3];
    let mut knots: Vec<(f32, [f32; 3])> = bins()
        .rev()
        .map(|(i, bin)| {
            let factor = by_depth(bin.z);
            for c in 0..3 {
                let at_least = 1.0 - envelopes[c][i].dark / veil[c].max(FAINTEST);
                beyond[c] = beyond[c].max(factor[c]).max(at_least);
            }
            (bin.z, beyond)
        })
        .collect();
    knots.reverse();
    DepthFactors::from_knots(&knots)
}

#[cfg(test)]
mod tests {
    use super::super::envelope;
    use super::*;
    use crate::depth::Quantised;
    use crate::image::{Encoded, Image};

    /// Things of which the darkest at level 140 and beyond have 60 of 200.
    fn of_things(coefficient: f32) -> DepthFactors {
        let thing = |i: u32| [60 + (i % 90) as u8, 40 + (i % 70) as u8, 30 + (i % 50) as u8];
        let image = Image::from_raw(100, 80, (0..8000).flat_map(thing).collect()).unwrap();
        let levels: Vec<u8> =
            (0..8000_u32).map(|i| if i < 4000 { 80 } else { 140 } + (i % 16) as u8).collect();
        let quantised = Quantised { levels: levels.into(), step: 1.0 / 255.0, beyond: None };
        let statistics = Statistics::<Encoded>::of_all(image.view(), &quantised);
        let envelopes = std::array::from_fn(|c| envelope::read(&statistics, c, 0.3));
        let veil = [200, 180, 90].map(|value| f32::from(value as u8) / 255.0);
        by_coefficient(&statistics, &envelopes, veil, [coefficient; 3]).unwrap()
    }

    #[test]
    fn backscatter_is_never_more_than_the_darkest_things_show() {
        // β_B says e^-.58 = .56 at the far end; the darkest things there have 60 of 200.
        let far = of_things(1.0).at(148.0 / 255.0);
        assert!((far[0] - 0.7).abs() < 0.02, "{far:?}");
    }

    #[test]
    fn it_never_rises_with_depth() {
        for coefficient in [0.0, 0.1, 1.0, 9.0] {
            let table = of_things(coefficient);
            let along = (0..=255).map(|level| table.at(level as f32 / 255.0)).collect::<Vec<_>>();
            assert!(along.windows(2).all(|pair| (0..3).all(|c| pair[1][c] <= pair[0][c])), "{along:?}");
        }
    }
}
