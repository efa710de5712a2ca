//! How to train, and when what happens.

use serde::{Deserialize, Serialize};

/// How to train. The defaults are those published by Kerbl et al., their times in proportion to the number of steps; but
/// for the rates, which are [`Rates::quick`], since fewer steps must be longer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Options {
    /// Steps, each of one view, > 0. Default: 2,000.
    pub iterations: u32,
    /// Replays a run: which view is shown when, where split splats go. Default: 0.
    pub seed: u64,
    /// λ, the weight of 1 - SSIM beside L1. Default: .2.
    pub lambda: f64,
    /// The most splats there may be: what a step costs grows with them. Default: 100,000.
    pub most_splats: usize,
    /// How fast what is learned.
    pub rates: Rates,
    /// When splats are added and taken away.
    pub density: DensityOptions,
}

/// Learning rates of Adam.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rates {
    /// Of positions at the first and the last step, in extents of the scene; it falls evenly in its logarithm.
    pub position: [f64; 2],
    /// Of logarithms of deviations.
    pub scale: f64,
    /// Of quaternions.
    pub rotation: f64,
    /// Of the logit of opacity.
    pub opacity: f64,
    /// Of the harmonic of degree 0; the others take a twentieth.
    pub colour: f64,
    /// Of the logit of B∞, which open water in every image tells, so that it must not wait until splats stand there; the
    /// logarithms of the betas, which only the same thing near and far tells, take a sixth. Not published: ours.
    pub water: f64,
}

impl Rates {
    /// The published ones, for 30,000 steps.
    pub fn published() -> Self {
        Self {
            position: [1.6e-4, 1.6e-6],
            scale: 0.005,
            rotation: 0.001,
            opacity: 0.05,
            colour: 0.0025,
            water: 0.03,
        }
    }

    /// Ours for a few thousand steps: four to ten times the published ones, but for opacity. `docs/results.md` has both side
    /// by side.
    pub fn quick() -> Self {
        Self {
            position: [1.6e-3, 1.6e-5],
            scale: 0.02,
            rotation: 0.008,
            opacity: 0.05,
            colour: 0.02,
            water: 0.03,
        }
    }
}

/// When splats are added and taken away.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DensityOptions {
    /// Mean drift of a splat's place on the image, in half images, from which it is doubled.
    pub drift: f64,
    /// Splats up to this, in extents of the scene, are doubled where they are; larger ones are split.
    pub small: f64,
    /// Splats fainter than this are taken away.
    pub faintest: f64,
    /// Splats larger than this, in extents of the scene, are taken away once opacities were reset.
    pub largest: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            iterations: 2000,
            seed: 0,
            lambda: 0.2,
            most_splats: 100_000,
            rates: Rates::quick(),
            density: DensityOptions { drift: 2e-4, small: 0.01, faintest: 0.005, largest: 0.1 },
        }
    }
}

/// The steps that the published times belong to.
const PUBLISHED: f64 = 30_000.0;
/// Steps between two looks at the density, and the first of them: fewer would not show every view. Published: 100 of 30,000.
const LEAST_INTERVAL: u32 = 100;
/// Steps between two resets of opacity, at least: what is reset must grow again first. Published: 3,000 of 30,000.
const LEAST_RESET: u32 = 3000;

/// When a water is told again: once distances are about right, and once more when they are better, early enough for colours
/// to follow. Not published: ours.
const WATER_AT: [f64; 2] = [9_000.0, 18_000.0];

impl Options {
    /// A published time as one of this run.
    fn time(&self, published: f64) -> u32 {
        (published / PUBLISHED * f64::from(self.iterations)).round() as u32
    }

    /// Whether splats are added and taken away after this step.
    pub(crate) fn grows_after(&self, step: u32) -> bool {
        let every = self.time(100.0).max(LEAST_INTERVAL);
        step > self.time(500.0) && step <= self.time(15_000.0) && step.is_multiple_of(every)
    }

    /// Whether a water that is learned is told again after this step, from the distances there are by then.
    pub(crate) fn looks_at_water_after(&self, step: u32) -> bool {
        WATER_AT.iter().any(|&time| step == self.time(time))
    }

    /// Whether opacities are reset after this step.
    pub(crate) fn resets_after(&self, step: u32) -> bool {
        let every = self.time(3000.0).max(LEAST_RESET);
        step < self.time(15_000.0) && step.is_multiple_of(every)
    }

    /// Whether opacities were reset before this step.
    pub(crate) fn was_reset(&self, step: u32) -> bool {
        step > self.time(3000.0).max(LEAST_RESET)
    }

    /// The degree of harmonics at this step: one more every 1,000 published ones.
    pub(crate) fn degree(&self, step: u32, most: u8) -> u8 {
        let degree = step / self.time(1000.0).max(1);
        u8::try_from(degree).unwrap_or(most).min(most)
    }

    /// The rate of positions at this step, in extents.
    pub(crate) fn position_rate(&self, step: u32) -> f64 {
        let [first, last] = self.rates.position;
        let along = f64::from(step) / f64::from(self.iterations.max(1));
        (first.ln() + along.min(1.0) * (last.ln() - first.ln())).exp()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_published_run_has_the_published_times() {
        let options = Options { iterations: 30_000, rates: Rates::published(), ..Options::default() };
        assert!(!options.grows_after(500) && options.grows_after(600) && options.grows_after(15_000));
        assert!(!options.grows_after(15_100) && !options.grows_after(650));
        assert!(options.resets_after(3000) && options.resets_after(12_000) && !options.resets_after(15_000));
        assert_eq!(
            [0, 999, 1000, 2999, 3000, 29_000].map(|step| options.degree(step, 3)),
            [0, 0, 1, 2, 3, 3]
        );
        assert!((options.position_rate(0) - 1.6e-4).abs() < 1e-12);
        assert!((options.position_rate(30_000) - 1.6e-6).abs() < 1e-12);
    }
}
