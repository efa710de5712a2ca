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
/// Levels of colour depth over which the curve rises to open water: a step would be seen as an edge.
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
    let Curve { at, farthest, far } = curve(distances, valid, levels);
    let guess = |i: usize| {
        let level = usize::from(levels[i]);
        let water = level.saturating_sub(farthest).min(RAMP) as f32 / RAMP as f32;
        Guess { distance: at[level].min(most), water }
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
    /// The farthest colour of things; beyond it lies open water.
    farthest: usize,
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
    let total: usize = by_level.iter().map(Vec::len).sum();
    let level_at = |share: f64| {
        let mut seen = 0;
        let reached = by_level.iter().position(|distances| {
            seen += distances.len();
            seen as f64 >= share * total as f64
        });
        reached.unwrap_or(LEVELS - 1)
    };
    let (towards_far, farthest) = (level_at(TOWARDS_FAR), level_at(FAR));
    let far = far_end(&by_level, total);

    let mut knots = rising(&mut by_level[..towards_far.min(farthest.saturating_sub(1)) + 1]);
    knots.retain(|knot| knot.0 < farthest);
    knots.iter_mut().for_each(|knot| knot.1 = knot.1.min(far));
    knots.push((farthest, far));
    knots.push((farthest + RAMP, (far * OPEN_WATER).min(f32::MAX)));
    Curve { at: std::array::from_fn(|level| along(&knots, level)), farthest, far }
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
