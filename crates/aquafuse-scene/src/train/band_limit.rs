//! The 3D smoothing filter of Mip-Splatting, as a bound: no splat is thinner than what its nearest camera can tell apart.
//!
//! What is thinner was never seen to be so. Drawn larger than it was trained, it would be a needle.

use rayon::prelude::*;

use super::TrainView;
use crate::splats::{LOG_SCALE, Splats};

/// How far beyond the edge of an image a splat still counts as seen, in sizes of the image. As published.
const MARGIN: f64 = 0.15;

/// Widens splats to `least` pixels of the camera that sees them from nearest, along each of their axes.
pub(super) fn widen(splats: &mut Splats<f32>, views: &[TrainView], least: f64) {
    let width = splats.width();
    splats.rows_mut().par_chunks_exact_mut(width).for_each(|row| {
        let mean = [0, 1, 2].map(|i| f64::from(row[i]));
        let pixels = views.iter().filter_map(|view| pixel(view, mean));
        let finest = pixels.fold(f64::INFINITY, f64::min);
        if finest.is_finite() {
            let bound = (least * finest).ln() as f32;
            for scale in &mut row[LOG_SCALE..LOG_SCALE + 3] {
                *scale = scale.max(bound);
            }
        }
    });
}

/// The size of a pixel at a place, in units of the scene; `None` if the view does not see it.
fn pixel(view: &TrainView, mean: [f64; 3]) -> Option<f64> {
    let camera = &view.camera;
    let seen = camera.to_camera(mean);
    let inside = |axis: usize, side: usize| {
        let at = camera.focal[axis] * seen[axis] / seen[2] + camera.centre[axis];
        let side = side as f64;
        (-MARGIN * side..(1.0 + MARGIN) * side).contains(&at)
    };
    (seen[2] > 0.0 && inside(0, camera.width) && inside(1, camera.height))
        .then(|| seen[2] / camera.focal[0].max(camera.focal[1]))
}
