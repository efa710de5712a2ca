//! The straight bars at the sides of an image: letterboxes, pillars, padding, frames, and bars with text on them.
//!
//! A bar is sought at each side, from the outermost line (a row or a column) inwards. Its first lines have one colour.
//! Text may cover a part of the lines that follow. It ends at a straight edge: at one line, colours leave that of the bar in
//! a good part of the places. Flat open water has the first and not the second.
//!
//! JPEG stores blocks of 8 or 16 pixels, and an edge ripples through its blocks. So there are tiers: the less even the first
//! lines are, the higher and the more complete the edge must be.

mod line;
mod lines;

use std::ops::Range;

use super::Margins;
use crate::image::{Encoding, ImageRef, Sample};
use line::leaving;
use lines::{Lines, SIDES};
pub(super) use lines::{distance, median, to_bytes};

/// How even a bar is, and what its edge must be.
#[derive(Clone, Copy)]
struct Tier {
    /// The first lines lie within so many steps of the bar's colour.
    within: u16,
    /// At the edge, colours leave it by so many steps,
    step: u16,
    /// in this percentage of the places.
    percent: usize,
}

const fn tier(within: u16, step: u16, percent: usize) -> Tier {
    Tier { within, step, percent }
}

/// An edge of 8 steps is found in flat water too, where JPEG of quality 40 keeps one colour for each block of 16 rows.
const TIERS: [Tier; 4] = [tier(3, 12, 30), tier(6, 16, 50), tier(12, 20, 60), tier(24, 36, 70)];
/// Of a line of the bar, this percentage has its colour. It is less than all because JPEG carries text into lines without.
const EVEN: usize = 93;
/// Lines of a bar with text have its colour, within [`TEXT_WITHIN`] steps, in this percentage of the places at least.
const TEXT: usize = 15;
const TEXT_WITHIN: u16 = 16;
/// Just before the edge, colours have left that of the bar in this percentage of the places at most. Of flat water they leave
/// bit by bit.
const GONE: usize = 20;
/// Bars are mostly grey, and water is not. A bar of another colour must end in this percentage of the places.
const COLOURED: usize = 70;
/// The ripples of a block reach so far.
const RIPPLES: usize = 16;
/// A bar wider than this has blocks without ripples. So uneven lines that are more are flat water.
const UNEVEN: usize = 2 * RIPPLES;
/// The sharpest line is sought so far before and after the edge. JPEG blurs colour over twice as many lines as brightness.
const BEFORE: usize = 2;
const AFTER: usize = 4;
const AFTER_COLOURED: usize = 8;
/// A bar reaches at most over this percentage of an image.
const MOST: usize = 45;
/// Where bars leave less than so many rows or columns, there is no scene.
const LEAST: usize = 16;
/// Bars within bars, of other colours: more than these are not looked for.
const NESTED: usize = 4;

/// The margins that bars fill.
pub(super) fn find<T: Sample, E: Encoding>(image: ImageRef<'_, T, E>) -> Margins {
    let mut found = Margins::default();
    let mut colours = Vec::new();
    for round in 0..NESTED {
        let Some(mut sides) = sides(image, found) else { break };
        let even = sides.each_mut().map(Lines::even);
        let before = found;
        for side in SIDES {
            let lines = &mut sides[side as usize];
            // What is left of a bar's blurred edge is no second bar.
            let (tiers, is_even) = match round {
                0 => (&TIERS[..], lines.even_within(TIERS[3].within) > 0),
                _ => (&TIERS[..1], even[side as usize] >= 3),
            };
            let (ahead, behind) = side.neighbours(even);
            let span = lines.span(ahead, behind);
            let colour = lines.colour;
            let bar = tiers.iter().filter(|_| is_even).find_map(|&tier| edge(lines, &span, colour, tier));
            if let Some(width) = bar {
                *side.of(&mut found) += width;
                colours.push(colour);
            }
        }
        if found == before {
            break;
        }
    }
    let found = with_like_sides(image, found, &colours);
    let enough = found.leave(image.size()).is_some_and(|(width, height)| width >= LEAST && height >= LEAST);
    if enough { found } else { Margins::default() }
}

/// Borders mostly have one colour. So a side without a bar is looked at again, for the colours of the others: it is even in
/// one of them, or has half of the edge that is asked for otherwise.
fn with_like_sides<T: Sample, E: Encoding>(
    image: ImageRef<'_, T, E>,
    mut found: Margins,
    colours: &[[u8; 3]],
) -> Margins {
    let Some(mut sides) = sides(image, found).filter(|_| !colours.is_empty()) else { return found };
    for side in SIDES.into_iter().filter(|side| *side.of(&mut found.clone()) == 0).collect::<Vec<_>>() {
        let lines = &mut sides[side as usize];
        let span = lines.span(0, 0);
        let eased = TIERS[1..].iter().map(|&tier| Tier { percent: tier.percent / 2, ..tier });
        let with_edge = colours
            .iter()
            .filter_map(|&colour| eased.clone().find_map(|tier| edge(lines, &span, colour, tier)));
        let width = with_edge.max().or_else(|| {
            let most = lines.most_even(TIERS[0].within);
            let even = colours.iter().map(|&colour| lines.even_in(colour, TIERS[0].within));
            even.filter(|even| (3..most).contains(even)).max()
        });
        *side.of(&mut found) += width.unwrap_or(0);
    }
    found
}

/// The lines at each side of what the margins leave, if that is enough for a scene.
fn sides<T: Sample, E: Encoding>(
    image: ImageRef<'_, T, E>,
    margins: Margins,
) -> Option<[Lines<'_, T, E>; 4]> {
    let (width, height) = margins.leave(image.size())?;
    (width >= LEAST && height >= LEAST).then(|| SIDES.map(|side| Lines::new(image, margins, side)))
}

/// The line at which a bar of a colour ends: the first line of the scene. `span` are the pixels of a line that lie between
/// the bars of the neighbouring sides.
fn edge<T: Sample, E: Encoding>(
    lines: &mut Lines<'_, T, E>,
    span: &Range<usize>,
    colour: [u8; 3],
    tier: Tier,
) -> Option<usize> {
    let first = lines.even_in(colour, tier.within);
    if first == 0 || first >= lines.most_even(tier.within) || span.len() < LEAST / 2 {
        return None;
    }
    let (percent, after) =
        if is_grey(colour) { (tier.percent, AFTER) } else { (tier.percent.max(COLOURED), AFTER_COLOURED) };
    let last = lines.count() - 2;
    let (mut best, mut most, mut end) = (0, 0, None);
    for k in first..=last.min(lines.most()) {
        let around = lines.around([k.saturating_sub(2), k - 1, k, k + 1], span);
        // What leaves the colour is half a step from it: most lines are no edge, whatever is about them, and lie within the bar.
        let near = around[2].has(colour, tier.step.div_ceil(2) - 1);
        if near * 100 <= (100 - percent) * span.len() {
            let (leaving, gone) = leaving(around, colour, tier.step);
            if leaving > most && gone * 100 <= GONE * span.len() {
                (best, most) = (k, leaving);
            }
        }
        let is_short = |has: usize| has * 100 < TEXT * span.len();
        if is_short(near) && is_short(around[2].has(colour, TEXT_WITHIN.max(tier.within))) {
            end = end.or(Some(k));
        }
        if end.is_some_and(|end| k >= end + RIPPLES) {
            break;
        }
    }
    if most * 100 < percent * span.len() {
        return None;
    }
    let mut sharpness = |k: usize| -> u64 {
        let [_, outer, inner, _] = lines.around([k - 1, k - 1, k, k], span);
        outer.off(inner)
    };
    let candidates = first.max(best.saturating_sub(BEFORE))..=last.min(best + after);
    // Of equally sharp lines the first one.
    candidates.rev().max_by_key(|&k| sharpness(k))
}

/// Whether a colour is black, white or between.
fn is_grey([r, g, b]: [u8; 3]) -> bool {
    r.max(g).max(b) - r.min(g).min(b) <= 12
}
