//! The depth factors of a depth from colour: how much of each depth is open water, and what the things there let through.

use super::super::depth_factors::DepthFactors;
use super::super::statistics::{Bin, Statistics};
use super::envelope::Point;
use crate::image::Encoding;

/// Bytes by which open water may differ from its colour, in every channel, for it shades from bright to dark: what is within all
/// three counts wholly, what is within the last alone a third.
const NEAR: [f32; 3] = [12.0, 24.0, 36.0];
/// Water whose brightest channel (encoded) is fainter cannot be distinguished from shadow: black would count as water.
const FAINTEST_WATER: f32 = NEAR[2] / 255.0;
/// What is divided by is no less (in the encoding of the fit): a channel without a veil says nothing, and β_B stands.
const FAINTEST: f32 = 1e-3;

/// F of each bin: `(1 - w) F'`, with w its share of open water and `F' = e^(-β_B z)` that of its things.
///
/// Backscatter is never more than the darkest things show, so that `F' >= 1 - dark / B∞`. Open water lets nothing through. `read`
/// is its colour, encoded; `veil` the same in the encoding of the fit. None of water that is as dark as shadow.
pub(super) fn depth_factors<E: Encoding>(
    statistics: &Statistics<E>,
    envelopes: &[Vec<Point>; 3],
    read: [f32; 3],
    veil: [f32; 3],
    coefficient: [f32; 3],
) -> Option<DepthFactors> {
    if read.iter().all(|&channel| channel < FAINTEST_WATER) {
        return None;
    }
    let water: Vec<f32> = statistics.bins.iter().map(|bin| water_in(bin, read)).collect();
    let knots = statistics.bins.iter().enumerate().filter(|(_, bin)| bin.z > 0.0).map(|(i, bin)| {
        let things = 1.0 - smoothed(&water, i);
        let factor = |c: usize| {
            let at_least = 1.0 - envelopes[c][i].dark / veil[c].max(FAINTEST);
            things * (-coefficient[c] * bin.z).exp().max(at_least)
        };
        (bin.z, std::array::from_fn(factor))
    });
    DepthFactors::from_knots(&knots.collect::<Vec<_>>())
}

/// Share of a bin that has the colour of open water: in each channel so many values are near it, and no more pixels can be
/// than in the channel with fewest.
fn water_in<E: Encoding>(bin: &Bin<E>, water: [f32; 3]) -> f32 {
    let near = |c: usize, off: f32| {
        let [low, high] = [-off, off].map(|off| (255.0 * water[c] + off).round().clamp(0.0, 255.0) as u8);
        (bin.up_to(c, high) - bin.below(c, low)) as f32 / bin.count as f32
    };
    let within = |off: f32| (0..3).map(|c| near(c, off)).fold(1.0, f32::min);
    NEAR.map(within).iter().sum::<f32>() / NEAR.len() as f32
}

/// A share with its neighbours, which count half each: what is water and what is not passes into one another without an edge.
fn smoothed(shares: &[f32], i: usize) -> f32 {
    let [before, after] = [i.saturating_sub(1), (i + 1).min(shares.len() - 1)];
    0.25 * shares[before] + 0.5 * shares[i] + 0.25 * shares[after]
}

#[cfg(test)]
mod tests {
    use super::super::envelope;
    use super::*;
    use crate::depth::Quantised;
    use crate::image::{Encoded, Image};
    use crate::waterbody::veiling_light::{Places, Reading, VeilingLightSource};

    /// Three quarters water about level 88, things alone about level 148.
    fn amber(water: [u8; 3]) -> Option<DepthFactors> {
        let thing = |i: u32| [60 + (i % 90) as u8, 40 + (i % 70) as u8, 30 + (i % 50) as u8];
        let pixels = (0..8000).map(|i| if i < 4000 && i / 16 % 4 > 0 { water } else { thing(i) });
        let image = Image::from_raw(100, 80, pixels.flatten().collect()).unwrap();
        let levels: Vec<u8> =
            (0..8000_u32).map(|i| if i < 4000 { 80 } else { 140 } + (i % 16) as u8).collect();
        let quantised = Quantised { levels: levels.into(), step: 1.0 / 255.0, beyond: None };
        let statistics = Statistics::<Encoded>::gather(image.view(), &quantised);
        let read = water.map(|value| f32::from(value) / 255.0);
        let light = Reading {
            rgb: read,
            source: VeilingLightSource::OpenWater,
            share: 0.4,
            places: Places::Cells(Vec::new()),
            standard_error: [0.0; 3],
            level: None,
            noise: 0.3,
        };
        let envelopes = std::array::from_fn(|c| envelope::read(&statistics, c, light.noise));
        depth_factors(&statistics, &envelopes, read, read, [1.0; 3])
    }

    #[test]
    fn depths_that_are_water_let_nothing_through_though_they_are_taken_for_near() {
        let table = amber([200, 180, 90]).unwrap();
        let [near, far] = [88.0, 148.0].map(|level| table.at(level / 255.0));
        for c in 0..3 {
            assert!(near[c] < 0.25 && far[c] > 0.5, "{near:?} {far:?}");
        }
    }

    #[test]
    fn backscatter_is_never_more_than_the_darkest_things_show() {
        // β_B says e^-.58 = .56 at the far end; the darkest things there have 60 of 200.
        let far = amber([200, 180, 90]).unwrap().at(148.0 / 255.0);
        assert!((far[0] - 0.7).abs() < 0.02, "{far:?}");
    }

    #[test]
    fn water_as_dark_as_shadow_is_not_looked_for() {
        assert_eq!((amber([11, 12, 17]), amber([10, 20, 35])), (None, None));
        assert!(amber([10, 20, 40]).is_some());
    }
}
