//! All that a run of training has to keep.

use super::adam::Moments;
use super::density::Density;
use crate::medium::{Medium, PARAMETERS, Water};
use crate::random::Random;
use crate::splats::Splats;

/// The state of a run: resumed from a checkpoint of it, a run continues as if it had never stopped.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct State {
    /// Steps done.
    pub(crate) step: u32,
    pub(crate) splats: Splats<f32>,
    pub(crate) moments: Moments,
    pub(crate) water: Option<(Water<f32>, Moments)>,
    pub(crate) density: Density,
    pub(crate) random: Random,
    /// Views still to be shown in this round.
    pub(crate) queue: Vec<u32>,
}

impl State {
    pub(crate) fn new(splats: Splats<f32>, water: Option<Water<f32>>, seed: u64) -> Self {
        Self {
            step: 0,
            moments: Moments::new(splats.rows().len()),
            density: Density::new(splats.len()),
            splats,
            water: water.map(|water| (water, Moments::new(PARAMETERS))),
            random: Random(seed),
            queue: Vec::new(),
        }
    }

    pub(crate) fn medium(&self) -> Medium<f32> {
        self.water.as_ref().map_or(Medium::Air, |(water, _)| Medium::Learned(water.clone()))
    }

    /// Adds a splat without a past.
    pub(crate) fn push(&mut self, row: &[f32]) {
        self.splats.push(row);
        for moment in [&mut self.moments.first, &mut self.moments.second] {
            moment.resize(self.splats.rows().len(), 0.0);
        }
    }

    /// Keeps those splats of which `keep` says so.
    pub(crate) fn retain(&mut self, keep: &[bool]) {
        let width = self.splats.width();
        self.splats.retain(keep);
        for moment in [&mut self.moments.first, &mut self.moments.second] {
            let mut rows = keep.iter().flat_map(|keep| std::iter::repeat_n(*keep, width));
            moment.retain(|_| rows.next().unwrap_or(false));
        }
    }

    /// The view to show next: all in one order by chance, then all in another.
    pub(crate) fn next_view(&mut self, views: usize) -> usize {
        if self.queue.is_empty() {
            self.queue = (0..views as u32).collect();
            for i in (1..views).rev() {
                let other = self.random.below(i + 1);
                self.queue.swap(i, other);
            }
        }
        self.queue.pop().map_or(0, |view| view as usize)
    }
}
