//! Depth where none was supplied: from colour, in the unit of the rest.
//!
//! Structure from motion finds nothing in open water, so a third of a frame may have no depth, and just its far
//! end. The curve from colour to distance is the median distance of each colour, made rising by pooling adjacent
//! violators (Barlow et al. 1972). At its far end it meets the far end of the map, and beyond the farthest colour
//! of the valid pixels lies open water. What was measured beside a hole counts more than its colour (`spread`).

mod spread;

use spread::Guess;

use crate::depth::map::Guesses;
use crate::image::ImageRef;

/// Levels of colour depth.
const LEVELS: usize = 256;
/// The farthest colour and the far end of the map: beyond this share lie edges, where a near pixel has the colour
/// behind it or the other way round.
const FAR: f64 = 0.98;
/// From this share of the colours on, the curve runs straight to the far end. The median distance of a far colour
/// falls short of it, because colour does not order everything rightly.
const TOWARDS_FAR: f64 = 0.90;
/// Open water lies this many times farther than the far end of the map. Nearer, it keeps a part of its own colour;
/// farther, the ramp takes the steps in which the estimators count from the scene. On truth scenes without depth in
/// their farther part `physical` makes .82 of the true change with 2, .83 with 4, .79 with 12.
const OPEN_WATER: f32 = 4.0;
/// The colour of the nearest things, as a share of the colours of valid pixels.
const NEAR: f64 = 0.02;
/// The colour of open water, as a share of those colours in holes that are farther than the colours of things: their middle, because
/// ground that goes on behind what was measured has the colours between. Of seven images whose farther two fifths were taken away, the
/// depth is found with two thirds of the error that eight levels leave, and neither too near nor too far.
const WATER: f64 = 0.5;
/// Things go at least this part of the way to open water, or every guess would lie as far as that.
const LEAST_WAY: f32 = 0.1;
/// Levels of colour depth over which the curve rises to open water, at least: a step would be seen as an edge. Estimators count with
/// these: where they counted the ground behind what was measured, β_B fell to a third on two of seven images.
const RAMP: usize = 8;

/// Fills what is not valid in the map of `image`; `levels` is its colour depth, `most` the largest distance there is. Returns where z
/// is a guess.
pub(super) fn fill(
    image: ImageRef<'_, u8>,
    distances: &mut [f32],
    valid: &[bool],
    levels: &[u8],
    most: f32,
) -> Guesses {
    let Curve { at, counted, farthest, water, far } = curve(distances, valid, levels);
    let guess = |i: usize| {
        let level = usize::from(levels[i]);
        let water = level.saturating_sub(farthest).min(water) as f32 / water as f32;
        Guess { distance: at[level].min(most), counted: counted[level].min(most), water }
    };
    let guesses = spread::fill(image, distances, valid, far, guess);
    for (distance, _) in distances.iter_mut().zip(valid).filter(|(_, valid)| !**valid) {
        *distance = distance.clamp(0.0, most);
    }
    guesses
}

/// Distance by level of colour depth, rising.
struct Curve {
    at: [f32; LEVELS],
    /// The same for estimators.
    counted: [f32; LEVELS],
    /// The farthest colour of things, and the levels from there to the colour of open water.
    farthest: usize,
    water: usize,
    /// The far end of what is valid.
    far: f32,
}

/// The curve of the valid pixels.
fn curve(distances: &[f32], valid: &[bool], levels: &[u8]) -> Curve {
    let mut by_level: Vec<Vec<f32>> = vec![Vec::new(); LEVELS];
    for ((distance, valid), level) in distances.iter().zip(valid).zip(levels) {
        if *valid {
            by_level[usize::from(*level)].push(*distance);
        }
    }
    let counts: [usize; LEVELS] = std::array::from_fn(|level| by_level[level].len());
    let [nearest, towards_far, farthest] = [NEAR, TOWARDS_FAR, FAR].map(|share| level_at(&counts, share));
    let far = far_end(&by_level, counts.iter().sum());
    let mut behind = [0; LEVELS];
    for (level, _) in levels.iter().zip(valid).filter(|(_, valid)| !**valid) {
        behind[usize::from(*level)] += 1;
    }
    behind[..=farthest].fill(0);
    let water = level_at(&behind, WATER).max(farthest + RAMP) - farthest;

    let mut knots = rising(&mut by_level[..towards_far.min(farthest.saturating_sub(1)) + 1]);
    knots.retain(|knot| knot.0 < farthest);
    knots.iter_mut().for_each(|knot| knot.1 = knot.1.min(far));
    knots.push((farthest, far));
    knots.push((farthest + RAMP, (far * OPEN_WATER).min(f32::MAX)));
    let counted = std::array::from_fn(|level| along(&knots, level));
    // With each step of z a colour goes the same part of the way that is left to the colour of open water. How much of it lies between
    // the nearest things and the far end says how long a step is.
    let steps = ((farthest + water).saturating_sub(nearest) as f32 / water as f32).ln().max(LEAST_WAY);
    let at = std::array::from_fn(|level| {
        let left = 1.0 - level.saturating_sub(farthest).min(water) as f32 / water as f32;
        if level > farthest { far * (1.0 - left.ln() / steps).min(OPEN_WATER) } else { counted[level] }
    });
    Curve { at: at.map(|z: f32| z.min(f32::MAX)), counted, farthest, water, far }
}

/// The level that this share of what is counted does not exceed.
fn level_at(counts: &[usize; LEVELS], share: f64) -> usize {
    let total: usize = counts.iter().sum();
    let mut seen = 0;
    let reached = counts.iter().position(|count| {
        seen += count;
        seen as f64 >= share * total as f64
    });
    reached.unwrap_or(LEVELS - 1)
}

/// The distance that 98 % of the valid pixels do not exceed.
fn far_end(by_level: &[Vec<f32>], total: usize) -> f32 {
    let mut all = by_level.concat();
    let rank = ((total as f64 * FAR).ceil() as usize).clamp(1, total) - 1;
    *all.select_nth_unstable_by(rank, f32::total_cmp).1
}

/// Medians of the levels that hold pixels, pooled with their neighbours until they rise.
fn rising(by_level: &mut [Vec<f32>]) -> Vec<(usize, f32)> {
    /// Neighbouring levels that share one distance.
    struct Pool {
        first: usize,
        last: usize,
        weight: f64,
        distance: f64,
    }
    let mut pools: Vec<Pool> = Vec::new();
    for (level, distances) in by_level.iter_mut().enumerate().filter(|(_, distances)| !distances.is_empty()) {
        let middle = distances.len() / 2;
        let median = *distances.select_nth_unstable_by(middle, f32::total_cmp).1;
        let (weight, distance) = (distances.len() as f64, f64::from(median));
        let mut pool = Pool { first: level, last: level, weight, distance };
        while let Some(before) = pools.pop_if(|before| before.distance >= pool.distance) {
            let weight = before.weight + pool.weight;
            let distance = (before.distance * before.weight + pool.distance * pool.weight) / weight;
            pool = Pool { first: before.first, weight, distance, ..pool };
        }
        pools.push(pool);
    }
    let ends = |pool: &Pool| [(pool.first, pool.distance as f32), (pool.last, pool.distance as f32)];
    pools.iter().flat_map(ends).collect()
}

/// The value at `level` along straight lines through `knots`, held before the first and after the last.
fn along(knots: &[(usize, f32)], level: usize) -> f32 {
    let after = knots.partition_point(|knot| knot.0 <= level);
    match (after.checked_sub(1).map(|before| knots[before]), knots.get(after)) {
        (Some((a, from)), Some(&(b, to))) => from + (to - from) * (level - a) as f32 / (b - a) as f32,
        (Some((_, held)), None) | (None, Some(&(_, held))) => held,
        (None, None) => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Level of colour depth of things at z, where open water has 130.
    fn level(z: f32) -> u8 {
        (130.0 - 100.0 * (-z / 6.0).exp()).round() as u8
    }

    /// Ground from 1 to 16, measured up to 7, and as much open water.
    fn ground() -> Curve {
        let z: Vec<f32> = (0..300).map(|i| 1.0 + 0.05 * i as f32).collect();
        let levels: Vec<u8> = z.iter().map(|&z| level(z)).chain([130; 300]).collect();
        let valid: Vec<bool> = (0..600).map(|i| i < 300 && z[i] <= 7.0).collect();
        let distances: Vec<f32> = (0..600).map(|i| if valid[i] { z[i] } else { 0.0 }).collect();
        curve(&distances, &valid, &levels)
    }

    #[test]
    fn ground_behind_what_was_measured_lies_where_its_colour_says_and_is_no_open_water() {
        let Curve { at, far, farthest, water, .. } = ground();
        for z in [7.5, 8.0, 9.0, 10.0, 12.0_f32] {
            let found = at[usize::from(level(z))];
            assert!(found > z / 1.3 && found < z * 1.3, "{found} is not {z}");
        }
        assert!(at.windows(2).all(|pair| pair[0] <= pair[1]), "it rises");
        assert!(at[130] == OPEN_WATER * far && farthest + water == 130);
        // What lies just behind would be open water by ramps of a fixed width.
        assert!(usize::from(level(8.0)) < farthest + water / 3);
    }

    #[test]
    fn a_hole_without_far_colours_has_a_ramp_all_the_same() {
        let levels: Vec<u8> = (0..100).map(|i| 40 + i / 10).collect();
        let distances: Vec<f32> = levels.iter().map(|&level| f32::from(level) / 10.0).collect();
        let valid: Vec<bool> = (0..100).map(|i| i % 7 != 0).collect();
        let Curve { at, water, far, .. } = curve(&distances, &valid, &levels);
        assert!(water == RAMP && at[usize::from(u8::MAX)] == OPEN_WATER * far);
        assert!(at.iter().all(|z| z.is_finite() && *z > 0.0));
    }
}
