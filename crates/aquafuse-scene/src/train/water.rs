//! The water estimated again, once the splats know distances.
//!
//! Steps alone hardly tell β: a splat is seen from much the same distance in all views, and its own colour, which is free,
//! makes up for a water that fades too little. What does tell is that near things and far ones are alike, the darkest
//! above all, which is what estimates from one picture rest on. They lack true distances; these are known now.

use aquafuse::depth::{Supplied, SuppliedKind};
use aquafuse::image::Encoded;
use aquafuse::waterbody::{Estimate, EstimateOptions, estimate, pool};

use super::Shot;
use crate::compare::distances;
use crate::medium::{Medium, Water};
use crate::render::render;
use crate::shared_water::{median, to_learn};
use crate::splats::Splats;

/// Views that are asked, at most, taken evenly from all.
const ASKED: usize = 24;

/// The water that the views tell, by the distances that the splats have in them; none where none of them tells any.
///
/// B∞ stays as it was learned: open water in every view tells it.
pub(super) fn told(shots: &[Shot], splats: &Splats<f32>, water: &Water<f32>) -> Option<Water<f32>> {
    let every = shots.len().div_ceil(ASKED);
    let medium = Medium::Learned(water.clone());
    let (mut estimates, mut middles) = (Vec::new(), Vec::new());
    for shot in shots.iter().step_by(every) {
        if let Some((found, middle)) = of_view(shot, splats, &medium) {
            estimates.push(found);
            middles.push(middle);
        }
    }
    let pooled = to_learn(&pool(&estimates)?, median(&mut middles)?);
    let mut raw = pooled.raw;
    raw[..3].copy_from_slice(&water.raw[..3]);
    Some(Water { raw })
}

/// The water of one view, and how far things are in it.
fn of_view(shot: &Shot, splats: &Splats<f32>, medium: &Medium<f32>) -> Option<(Estimate<Encoded>, f32)> {
    let Shot { camera, target } = shot;
    let drawn = render(splats, 0, camera, medium);
    // What is not opaque has no distance: open water, or a thing that is not learned yet.
    let values: Vec<f32> = distances(&drawn.drawing).into_iter().map(|far| far.unwrap_or(0.0)).collect();
    let mut known: Vec<f32> = values.iter().copied().filter(|far| *far > 0.0).collect();
    let middle = median(&mut known)?;
    let picture = target.bytes();
    let supplied = Supplied::new(camera.width, camera.height, values, SuppliedKind::Metres).ok()?;
    let depth = supplied.seen_with(&picture, Default::default()).ok()?.depth;
    let found = estimate(&picture, &depth, &EstimateOptions::default()).ok()?;
    Some((found, middle))
}

/// Gives the splats the colours that look through `new` as theirs did through `old`, from half way between the nearest and
/// the farthest camera.
pub(super) fn repaint(splats: &mut Splats<f32>, shots: &[Shot], old: &Medium<f32>, new: &Water<f32>) {
    let cameras: Vec<[f64; 3]> = shots.iter().map(|shot| shot.camera.position()).collect();
    let between = old.between();
    for i in 0..splats.len() {
        let distance = half_way(&cameras, splats.position(i).map(f64::from));
        let seen = between.through(splats.colour(i), distance);
        splats.paint(i, new.taken_out(seen, distance));
    }
}

fn half_way(cameras: &[[f64; 3]], position: [f64; 3]) -> f32 {
    let apart = |camera: &[f64; 3]| (0..3).map(|a| (camera[a] - position[a]).powi(2)).sum::<f64>().sqrt();
    let ends = cameras
        .iter()
        .map(apart)
        .fold((f64::MAX, 0.0_f64), |(near, far), distance| (near.min(distance), far.max(distance)));
    (0.5 * (ends.0 + ends.1)) as f32
}
