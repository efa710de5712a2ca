//! Density control: splats are added where the gradient of their projected means is large, and removed where they are
//! transparent or huge.

use super::options::Options;
use super::state::State;
use crate::camera::rotation;
use crate::render::Gradient;
use crate::splats::{LOG_SCALE, MEAN, OPACITY, ROTATION, part};

/// Split splats shrink by this. Published.
const SHRINK: f32 = 1.6;
/// Opacity after a reset, at most. Published.
const RESET: f32 = 0.01;

/// Gradients of each splat since the last density control.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Density {
    /// Sum over views of the length of the gradient by its projected mean, in units of half an image.
    pub(crate) grad2d: Vec<f32>,
    /// Views that it was seen in.
    pub(crate) seen: Vec<u32>,
}

impl Density {
    pub(crate) fn new(splats: usize) -> Self {
        Self { grad2d: vec![0.0; splats], seen: vec![0; splats] }
    }

    pub(crate) fn note(&mut self, gradient: &Gradient<f32>, width: usize, height: usize) {
        let (half_width, half_height) = (0.5 * width as f32, 0.5 * height as f32);
        let noted = self.grad2d.iter_mut().zip(&mut self.seen).zip(&gradient.grad2d);
        for ((sum, seen), grad2d) in noted {
            if let Some([x, y]) = grad2d {
                *sum += (x * half_width).hypot(y * half_height);
                *seen += 1;
            }
        }
    }
}

/// Duplicates and splits splats of large gradients, removes faint and huge splats, and starts the sums again.
pub(super) fn change(state: &mut State, options: &Options, extent: f32) {
    let hot = hottest(state, options);
    let count = state.splats.len();
    let mut keep = vec![true; count];
    let small = options.density.grow_scale3d as f32 * extent;
    for &i in &hot {
        let largest = state.splats.scale(i).into_iter().fold(0.0, f32::max);
        let row = state.splats.row(i).to_vec();
        if largest <= small {
            state.push(&row);
        } else {
            keep[i] = false;
            for _ in 0..2 {
                let child = split(&row, state);
                state.push(&child);
            }
        }
    }
    keep.resize(state.splats.len(), true);
    let huge = options.density.prune_scale3d as f32 * extent;
    let bounded = options.was_reset(state.step);
    for (i, keep) in keep.iter_mut().enumerate() {
        let faint = state.splats.opacity(i) < options.density.prune_opa as f32;
        let too_large = bounded && state.splats.scale(i).into_iter().any(|scale| scale > huge);
        let broken = !state.splats.row(i).iter().all(|v| v.is_finite());
        *keep &= !(faint || too_large || broken);
    }
    state.retain(&keep);
    state.density = Density::new(state.splats.len());
}

/// Splats above `grow_grad2d`, the largest gradient first, as far as `max_splats` allows.
fn hottest(state: &State, options: &Options) -> Vec<usize> {
    let mean = |i: usize| state.density.grad2d[i] / state.density.seen[i].max(1) as f32;
    let threshold = options.density.grow_grad2d as f32;
    let mut hot: Vec<usize> = (0..state.splats.len()).filter(|&i| mean(i) >= threshold).collect();
    hot.sort_by(|&a, &b| mean(b).total_cmp(&mean(a)).then(a.cmp(&b)));
    hot.truncate(options.max_splats.saturating_sub(state.splats.len()));
    hot
}

/// A smaller splat, placed by chance as the large one is distributed.
fn split(row: &[f32], state: &mut State) -> Vec<f32> {
    let mut child = row.to_vec();
    let quaternion: [f32; 4] = part(row, ROTATION);
    let length = quaternion.iter().map(|q| q * q).sum::<f32>().sqrt().max(1e-12);
    let turn = rotation(quaternion.map(|q| q / length));
    let along: [f32; 3] = std::array::from_fn(|k| row[LOG_SCALE + k].exp() * state.random.normal() as f32);
    for i in 0..3 {
        child[MEAN + i] += (0..3).map(|k| turn[i][k] * along[k]).sum::<f32>();
        child[LOG_SCALE + i] -= SHRINK.ln();
    }
    child
}

/// Lowers every opacity, so that splats that are not needed stay faint.
pub(super) fn reset(state: &mut State) {
    let most = (RESET / (1.0 - RESET)).ln();
    let width = state.splats.width();
    for row in state.splats.rows_mut().chunks_exact_mut(width) {
        row[OPACITY] = row[OPACITY].min(most);
    }
    for moment in [&mut state.moments.first, &mut state.moments.second] {
        moment.chunks_exact_mut(width).for_each(|row| row[OPACITY] = 0.0);
    }
}
