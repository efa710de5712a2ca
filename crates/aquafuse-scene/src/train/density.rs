//! Adaptive density: splats are added where their places drift, and taken away where they hide nothing.

use super::options::Options;
use super::state::State;
use crate::camera::rotation;
use crate::render::Gradient;
use crate::splats::{LOG_SCALE, OPACITY, POSITION, ROTATION, part};

/// Split splats shrink by this. Published.
const SHRINK: f32 = 1.6;
/// Opacity after a reset, at most. Published.
const RESET: f32 = 0.01;

/// What was seen of each splat since the last look.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Density {
    /// Sum over views of how far the loss would have its place move, in half images.
    pub(crate) drift: Vec<f32>,
    /// Views it was seen in.
    pub(crate) seen: Vec<u32>,
}

impl Density {
    pub(crate) fn new(splats: usize) -> Self {
        Self { drift: vec![0.0; splats], seen: vec![0; splats] }
    }

    pub(crate) fn note(&mut self, gradient: &Gradient<f32>, width: usize, height: usize) {
        let (half_width, half_height) = (0.5 * width as f32, 0.5 * height as f32);
        let noted = self.drift.iter_mut().zip(&mut self.seen).zip(&gradient.drift);
        for ((sum, seen), drift) in noted {
            if let Some([x, y]) = drift {
                *sum += (x * half_width).hypot(y * half_height);
                *seen += 1;
            }
        }
    }
}

/// Adds splats where places drift, takes faint and huge ones away, and begins to look again.
pub(super) fn change(state: &mut State, options: &Options, extent: f32) {
    let hot = hottest(state, options);
    let count = state.splats.len();
    let mut keep = vec![true; count];
    let small = options.density.small as f32 * extent;
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
    let huge = options.density.largest as f32 * extent;
    let bounded = options.was_reset(state.step);
    for (i, keep) in keep.iter_mut().enumerate() {
        let faint = state.splats.opacity(i) < options.density.faintest as f32;
        let too_large = bounded && state.splats.scale(i).into_iter().any(|scale| scale > huge);
        let broken = !state.splats.row(i).iter().all(|v| v.is_finite());
        *keep &= !(faint || too_large || broken);
    }
    state.retain(&keep);
    state.density = Density::new(state.splats.len());
}

/// Those whose places drift beyond the threshold, the hottest first, as far as there is room.
fn hottest(state: &State, options: &Options) -> Vec<usize> {
    let mean = |i: usize| state.density.drift[i] / state.density.seen[i].max(1) as f32;
    let threshold = options.density.drift as f32;
    let mut hot: Vec<usize> = (0..state.splats.len()).filter(|&i| mean(i) >= threshold).collect();
    hot.sort_by(|&a, &b| mean(b).total_cmp(&mean(a)).then(a.cmp(&b)));
    hot.truncate(options.most_splats.saturating_sub(state.splats.len()));
    hot
}

/// A smaller splat somewhere in a large one, by its own bell.
fn split(row: &[f32], state: &mut State) -> Vec<f32> {
    let mut child = row.to_vec();
    let quaternion: [f32; 4] = part(row, ROTATION);
    let length = quaternion.iter().map(|q| q * q).sum::<f32>().sqrt().max(1e-12);
    let turn = rotation(quaternion.map(|q| q / length));
    let along: [f32; 3] = std::array::from_fn(|k| row[LOG_SCALE + k].exp() * state.random.normal() as f32);
    for i in 0..3 {
        child[POSITION + i] += (0..3).map(|k| turn[i][k] * along[k]).sum::<f32>();
        child[LOG_SCALE + i] -= SHRINK.ln();
    }
    child
}

/// Takes every opacity down, so that what is not needed stays faint.
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
