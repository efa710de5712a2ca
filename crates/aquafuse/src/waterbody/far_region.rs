//! Where an image is far: the region that looks most like open water, and whether it is any.
//!
//! Depth from colour takes a black suit or a shadow for far, and red is dead in many images. So a cell counts by several signs of
//! water: it is smooth, high up in the image, far by the depth map, not darker than the rest, and no glare. What is
//! bluish-green counts by depth from colour alone: amber or milky water is found too.

#[cfg(feature = "network")]
mod by_network;

use super::cells::Cells;
use super::glimpse::Glimpse;
use super::{EstimateOptions, WaterMap};
use crate::grid::mean_around;
use crate::image::{ImageRef, TopEdge};

/// Weights of the evidence: of smoothness (−ln of a deviation), height (0 bottom, 1 top), depth (in deviations from the
/// image's mean; from colour and given), brightness (likewise), darkness, and glare. They were chosen on 90 photographs whose
/// open water was marked by eye, but for the weight of given depth. Chosen on one half and tested on the other, B∞ is off by a
/// third more.
const SMOOTH: f32 = 0.73;
const HIGH: f32 = 0.28;
const FAR_BY_COLOUR: f32 = 0.075;
const FAR_AS_GIVEN: f32 = 0.3;
const BRIGHT: f32 = -0.044;
const DARK: f32 = -1.5;
const GLARE: f32 = -10.0;
/// Deviations in units of `[0, 1]` below this are all smooth.
const SMOOTHEST: f32 = 0.004;
/// Greys above this are glare.
const GLARING: f32 = 0.92;
/// What is added to a grey that is divided by.
const DARKEST: f32 = 0.05;

/// Share of the image that is read where no water is: the colour of things that may be far, each the more the more speaks for it.
/// With the median of the region, single frames of a sequence changed by 2.6 times as much as their source, with this by 1.5.
const OF_THINGS: f32 = 0.4;

/// Share of the image that the region is, share of the region whose colour is taken first, and how near to it cells are that
/// are taken then.
const SHARE: f32 = 0.12;
const SEED: f32 = 0.4;
const NEAR: f32 = 0.07;
const ROUNDS: usize = 5;
/// Cells within this many bytes of the colour, in every channel, are read.
const READ: f32 = 12.0;

/// Cells so near to a region's colour, in `[0, 1]`, and no rougher than so many times as it, are like it; where fewer than so many
/// per cent of an image are unlike it, all of it is. Water is as smooth everywhere as the camera's noise; a floor of sand has smoother and
/// rougher parts, and at three times as rough some became water.
const LIKE: f32 = 0.12;
const AS_SMOOTH: f32 = 1.5;
const FEW: usize = 2;

/// ln of the odds that a region is open water: a base, and weights of ln of its deviation, of how much rougher the image is, of
/// how much brighter the region is, and of how colourful it is. They were fitted to 156 photographs. In eighths that had no part in
/// the fit, 94 % of the open water was found, and 6 to 8 % of the images without any were mistaken.
const ODDS: [f32; 5] = [-16.9, -2.5, 3.05, 4.65, 5.2];
/// How much more likely it is where the depth map says itself what is far.
const ODDS_AS_GIVEN: f32 = 1.3;

/// The region of an image that is likeliest to be open water.
pub(super) struct Region {
    pub(super) cells: Cells,
    /// What speaks for water in each cell.
    pub(super) evidence: Vec<f32>,
    /// The logit of the share of water in each cell, where a network says it; and whether rules say nothing then.
    pub(super) logits: Option<Vec<f32>>,
    pub(super) alone: bool,
    /// The middle evidence of the region.
    pub(super) typical: f32,
    /// Its colour, in `[0, 1]`.
    pub(super) colour: [f32; 3],
    /// The cells that the colour was read from.
    pub(super) read: Vec<usize>,
    /// How likely it is to be open water, in `[0, 1]`.
    pub(super) seen: f32,
    /// What is read where it is not water: a wider part of the image, and its colour, in `[0, 1]`.
    pub(super) things: Vec<usize>,
    pub(super) of_things: [f32; 3],
}

impl Region {
    /// The region of an image by the map of water that is asked for, if it has one; `given` depth is not from colour.
    pub(super) fn by(
        options: &EstimateOptions,
        cells: Cells,
        image: ImageRef<'_, u8>,
        given: bool,
        glimpse: &mut Glimpse,
    ) -> Option<Self> {
        let top = options.top;
        Some(match options.water_map {
            WaterMap::Published => return None,
            WaterMap::Rules => {
                let _ = (image, glimpse);
                Self::of(cells, given, top)
            }
            #[cfg(feature = "network")]
            WaterMap::Network => Self::by_network(cells, glimpse.sight(image, top), top),
            #[cfg(feature = "network")]
            WaterMap::Both => Self::by_both(cells, glimpse.sight(image, top), given, top),
        })
    }

    /// The region of the image in cells, by rules.
    pub(super) fn of(cells: Cells, given: bool, top: TopEdge) -> Self {
        let rough = roughness(&cells);
        let grey: Vec<f32> = cells.all().iter().map(|cell| grey(&unit(&cell.mean))).collect();
        let evidence = evidence(&cells, &rough, &grey, given, top);
        let (inside, read, colour) = far_colour(&cells, &evidence, SHARE);
        let (things, of_things) = far_things(&cells, &evidence);
        let of_region = median(inside.iter().map(|&cell| rough[cell]).collect());
        let typical = median(inside.iter().map(|&cell| evidence[cell]).collect());
        let usual = usual(&cells, &rough, &colour, of_region);
        let of_usual = |values: &[f32]| median(usual.iter().map(|&cell| values[cell]).collect());
        let seen = likelihood(of_region, of_usual(&rough), &colour, of_usual(&grey), given);
        Self { cells, evidence, logits: None, alone: false, typical, colour, read, things, of_things, seen }
    }
}

/// The cells of the largest evidence, and their mean colour, in `[0, 1]`; each counts by how much more it has than the least of them.
/// In whole numbers, whose sums do not depend on their order.
fn far_things(cells: &Cells, evidence: &[f32]) -> (Vec<usize>, [f32; 3]) {
    let least = largest(count(OF_THINGS, evidence.len()), evidence);
    let things: Vec<usize> = (0..evidence.len()).filter(|&cell| evidence[cell] >= least).collect();
    let (mut sums, mut weights) = ([0; 3], 0);
    for &cell in &things {
        // One more, so that equal cells count.
        let weight = steps(evidence[cell] - least) + 1;
        weights += weight;
        (0..3).for_each(|c| sums[c] += weight * steps(cells.all()[cell].mean[c] / 255.0));
    }
    (things, sums.map(|sum| (sum as f64 / (65536.0 * weights as f64)) as f32))
}

/// So many of some cells, at least one.
fn count(share: f32, of: usize) -> usize {
    ((share * of as f32).ceil() as usize).clamp(1, of)
}

/// This share of the cells, those of the largest evidence; those of them whose colour is read, and that colour.
fn far_colour(cells: &Cells, evidence: &[f32], share: f32) -> (Vec<usize>, Vec<usize>, [f32; 3]) {
    let members = count(share, evidence.len());
    let least = largest(members, evidence);
    let surest = largest(count(SEED, members), evidence);
    let inside: Vec<usize> = (0..evidence.len()).filter(|&cell| evidence[cell] >= least).collect();
    let surest = inside.iter().copied().filter(|&cell| evidence[cell] >= surest).collect();
    let (read, colour) = commonest(cells, &inside, surest, &|read| colour_of(read, cells));
    (inside, read, colour)
}

/// Those of the cells inside that have the commonest colour, and that colour: it begins as the typical colour of `read`.
fn commonest(
    cells: &Cells,
    inside: &[usize],
    mut read: Vec<usize>,
    typical: &dyn Fn(&[usize]) -> [f32; 3],
) -> (Vec<usize>, [f32; 3]) {
    let mut colour = typical(&read);
    let near = |colour: &[f32; 3], is_near: &dyn Fn([f32; 3]) -> bool| -> Vec<usize> {
        let off = |&cell: &usize| {
            let own = unit(&cells.all()[cell].mean);
            is_near(std::array::from_fn(|c| (own[c] - colour[c]).abs()))
        };
        inside.iter().copied().filter(off).collect()
    };
    let within = |[r, g, b]: [f32; 3]| r * r + g * g + b * b < NEAR * NEAR;
    let all_within = |off: [f32; 3]| off.iter().all(|off| *off < READ / 255.0);
    for _ in 0..ROUNDS {
        let closer = near(&colour, &within);
        if closer.is_empty() {
            return (read, colour);
        }
        // Their colour would be what it is.
        if closer == read {
            break;
        }
        read = closer;
        colour = typical(&read);
    }
    let closer = near(&colour, &all_within);
    if !closer.is_empty() {
        read = closer;
        colour = typical(&read);
    }
    (read, colour)
}

/// The median colour of cells, in `[0, 1]`.
fn colour_of(cells: &[usize], all: &Cells) -> [f32; 3] {
    std::array::from_fn(|c| median(cells.iter().map(|&cell| all.all()[cell].mean[c]).collect()) / 255.0)
}

impl Region {
    /// The level of depth that its colour was read at.
    pub(super) fn level(&self) -> u8 {
        median(self.read.iter().map(|&cell| f32::from(self.cells.all()[cell].level)).collect()) as u8
    }
}

/// The cells by which a region is judged: all of them, or, where much of the image is like the region, half as many of those as of
/// the others: open water that fills an image would else be compared with itself.
fn usual(cells: &Cells, rough: &[f32], colour: &[f32; 3], of_region: f32) -> Vec<usize> {
    let is_like = |&cell: &usize| {
        let own = unit(&cells.all()[cell].mean);
        let off: f32 = (0..3).map(|c| (own[c] - colour[c]).powi(2)).sum();
        off < LIKE * LIKE && rough[cell] < AS_SMOOTH * of_region.max(SMOOTHEST)
    };
    let (mut like, others): (Vec<usize>, Vec<usize>) = (0..rough.len()).partition(is_like);
    if like.len() <= others.len() / 2 || others.len() <= FEW * rough.len() / 100 {
        return (0..rough.len()).collect();
    }
    // The roughest of them, so that their order in the image is nothing.
    like.sort_by(|a, b| {
        rough[*b].total_cmp(&rough[*a]).then(grey_of(cells, *a).total_cmp(&grey_of(cells, *b)))
    });
    like.truncate(others.len() / 2);
    like.extend(others);
    like
}

fn grey_of(cells: &Cells, cell: usize) -> f32 {
    grey(&unit(&cells.all()[cell].mean))
}

/// ln of the odds, as a likelihood.
fn likelihood(rough: f32, rough_elsewhere: f32, colour: &[f32; 3], usual_grey: f32, given: bool) -> f32 {
    let [base, of_roughness, of_contrast, of_brightness, of_colour] = ODDS;
    let most = colour.iter().copied().fold(0.0, f32::max);
    let least = colour.iter().copied().fold(1.0, f32::min);
    let odds = base
        + if given { ODDS_AS_GIVEN } else { 0.0 }
        + of_roughness * (rough + 0.002).ln()
        + of_contrast * (rough_elsewhere / (rough + 0.0005) + 0.01).ln()
        + of_brightness * ((grey(colour) + 0.02) / (usual_grey + 0.02)).ln()
        + of_colour * (most - least) / (most + DARKEST);
    (1.0 + (-odds).exp()).recip()
}

/// Deviation of values in a cell and its neighbours, in units of `[0, 1]`.
fn roughness(cells: &Cells) -> Vec<f32> {
    let (columns, _) = cells.grid().size();
    let variances: Vec<f32> = cells.all().iter().map(|cell| cell.variance).collect();
    mean_around(columns, 1, &variances).into_iter().map(f32::sqrt).collect()
}

/// What speaks for water in each cell, with its neighbours.
fn evidence(cells: &Cells, rough: &[f32], grey: &[f32], given: bool, top: TopEdge) -> Vec<f32> {
    let (columns, rows) = cells.grid().size();
    let far = if given { FAR_AS_GIVEN } else { FAR_BY_COLOUR };
    let depth = Standard::of(cells.all().iter().map(|cell| i64::from(cell.level)));
    let bright = Standard::of(grey.iter().map(|&grey| steps(grey)));
    let usual = median(grey.to_vec());
    let of_cell = |i: usize| {
        SMOOTH * -(rough[i] + SMOOTHEST).ln()
            + HIGH * height(i % columns, i / columns, (columns, rows), top)
            + far * depth.at(f32::from(cells.all()[i].level))
            + BRIGHT * bright.at(steps(grey[i]) as f32)
            + DARK * (usual - grey[i]).max(0.0) / (usual + DARKEST)
            + GLARE * (grey[i] - GLARING).max(0.0)
    };
    let alone: Vec<f32> = (0..rough.len()).map(of_cell).collect();
    mean_around(columns, 1, &alone)
}

/// How high up a cell is in the image as seen, 0 at the bottom and 1 at the top.
fn height(x: usize, y: usize, (columns, rows): (usize, usize), top: TopEdge) -> f32 {
    let below = match top {
        TopEdge::First => (y as f32 + 0.5) / rows as f32,
        TopEdge::Last => ((rows - 1 - y) as f32 + 0.5) / rows as f32,
        TopEdge::Left => (x as f32 + 0.5) / columns as f32,
        TopEdge::Right => ((columns - 1 - x) as f32 + 0.5) / columns as f32,
    };
    1.0 - below
}

/// Mean and deviation of whole numbers, whose sums do not depend on their order.
struct Standard {
    mean: f32,
    scale: f32,
}

impl Standard {
    fn of(values: impl Iterator<Item = i64>) -> Self {
        let (mut count, mut sum, mut squares) = (0.0, 0, 0);
        for value in values {
            (count, sum, squares) = (count + 1.0, sum + value, squares + value * value);
        }
        let mean = sum as f64 / count;
        let variance = squares as f64 / count - mean * mean;
        // A tenth of a step: less is rounding, and distinguishes nothing.
        let scale = if variance > 0.01 { variance.sqrt().recip() } else { 0.0 };
        Self { mean: mean as f32, scale: scale as f32 }
    }

    fn at(&self, value: f32) -> f32 {
        (value - self.mean) * self.scale
    }
}

/// A value in whole steps of 1/65536.
fn steps(value: f32) -> i64 {
    (65536.0 * value) as i64
}

fn unit(mean: &[f32; 3]) -> [f32; 3] {
    mean.map(|value| value / 255.0)
}

fn grey(colour: &[f32; 3]) -> f32 {
    (colour[0] + colour[1] + colour[2]) / 3.0
}

/// The least of the so many largest values.
fn largest(many: usize, values: &[f32]) -> f32 {
    let place = values.len() - many;
    *values.to_vec().select_nth_unstable_by(place, f32::total_cmp).1
}

/// The middle value; of an even number, the upper of the middle two.
pub(super) fn median(mut values: Vec<f32>) -> f32 {
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f32::total_cmp).1
}

#[cfg(test)]
mod tests;
