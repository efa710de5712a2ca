//! How to train, and when splats, opacities and the water are looked at again.

use serde::{Deserialize, Serialize};

/// How to train. The defaults are the values published by Kerbl et al., with times in proportion to the number of steps,
/// except for what says so; the learning rates are [`Rates::quick`], since fewer steps must be longer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Options {
    /// Steps, each of one view, > 0. Default: 2,000.
    pub iterations: u32,
    /// Random seed: decides which view each step takes and where split splats go. Default: 0.
    pub seed: u64,
    /// λ, the weight of 1 - SSIM beside L1. At .4, views held out are as good, but a learned water is worse. Default: .2.
    pub lambda: f64,
    /// Weight of the loss of the transmittance T, which asks for 0 on things and for 1 in open water. Without it, surfaces let a
    /// few per cent of the light through, which shows once the water is removed. Not published: ours. Default: .03.
    pub transmittance_reg: f64,
    /// The most splats there may be (`cap_max` of gsplat): the cost of a step grows with them. Default: 100,000.
    pub max_splats: usize,
    /// Learning rates.
    pub rates: Rates,
    /// Density control: when splats are added and removed.
    pub density: DensityOptions,
}

/// Learning rates of Adam, by the names that gsplat and nerfstudio use.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rates {
    /// Of means at the first and the last step, in extents of the scene; the logarithm falls evenly.
    pub means: [f64; 2],
    /// Of the logarithms of scales.
    pub scales: f64,
    /// Of quaternions.
    pub quats: f64,
    /// Of the logits of opacities.
    pub opacities: f64,
    /// Of the spherical harmonic of degree 0; the others take a twentieth.
    pub sh0: f64,
    /// Of the logit of B∞. Open water shows it in every image, so it must not wait until splats stand there. The logarithms
    /// of β_B and β_D take a sixth: only things seen from near and from far determine them. Not published: ours.
    pub water: f64,
    /// All of these but the rate of means end at this share of themselves, in (0, 1]: the logarithm falls evenly over the second
    /// half of the steps. While they stay high, each step forgets some of the views before it.
    pub last: f64,
}

impl Rates {
    /// The published rates, for 30,000 steps.
    pub fn published() -> Self {
        Self {
            means: [1.6e-4, 1.6e-6],
            scales: 0.005,
            quats: 0.001,
            opacities: 0.05,
            sh0: 0.0025,
            water: 0.03,
            last: 1.0,
        }
    }

    /// Our rates for a few thousand steps: four to ten times the published rates, except for opacities. `docs/results.md`
    /// compares both.
    pub fn quick() -> Self {
        Self {
            means: [1.6e-3, 1.6e-5],
            scales: 0.02,
            quats: 0.008,
            opacities: 0.05,
            sh0: 0.02,
            water: 0.03,
            last: 0.1,
        }
    }
}

/// Thresholds of density control, by the names and with the defaults of gsplat's `DefaultStrategy`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DensityOptions {
    /// A splat is duplicated or split from this mean gradient of the loss by its projected mean on, in units of half an
    /// image. Lower: more splats. Default: 0.0002.
    pub grow_grad2d: f64,
    /// Such a splat is duplicated if its largest scale is at most this, in extents of the scene, and split if it is larger.
    /// Default: 0.01.
    pub grow_scale3d: f64,
    /// Splats of a lower opacity are removed. Higher: fewer splats. Default: 0.005.
    pub prune_opa: f64,
    /// Splats of a larger scale, in extents of the scene, are removed once opacities have been reset. Default: 0.1.
    pub prune_scale3d: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            iterations: 2000,
            seed: 0,
            lambda: 0.2,
            transmittance_reg: 0.03,
            max_splats: 100_000,
            rates: Rates::quick(),
            density: DensityOptions {
                grow_grad2d: 2e-4,
                grow_scale3d: 0.01,
                prune_opa: 0.005,
                prune_scale3d: 0.1,
            },
        }
    }
}

/// The steps that the published times belong to.
const PUBLISHED: f64 = 30_000.0;
/// Steps between two density controls, at least: fewer would not show every view. Published: 100 of 30,000.
const LEAST_INTERVAL: u32 = 100;
/// Steps between two resets of opacity, at least: what is reset must grow again first. Published: 3,000 of 30,000.
const LEAST_RESET: u32 = 3000;

/// When the water is estimated again: once distances are about right, and once more when they are better, early enough for
/// colours to follow. Not published: ours.
const WATER_AT: [f64; 2] = [9_000.0, 18_000.0];

impl Options {
    /// A published time as one of this run.
    fn time(&self, published: f64) -> u32 {
        (published / PUBLISHED * f64::from(self.iterations)).round() as u32
    }

    /// Whether splats are added and removed after this step.
    pub(crate) fn grows_after(&self, step: u32) -> bool {
        let every = self.time(100.0).max(LEAST_INTERVAL);
        step > self.time(500.0) && step <= self.time(15_000.0) && step.is_multiple_of(every)
    }

    /// Whether a learned water is estimated again after this step, from the distances known by then.
    pub(crate) fn estimates_water_after(&self, step: u32) -> bool {
        WATER_AT.iter().any(|&time| step == self.time(time))
    }

    /// Whether β was estimated from distances before this step.
    pub(crate) fn knows_beta(&self, step: u32) -> bool {
        step > self.time(WATER_AT[0])
    }

    /// Whether surfaces are closed at this step: once distances, B∞ and β are about right, and no splat is added any more.
    pub(crate) fn closes_surfaces(&self, step: u32) -> bool {
        step >= self.time(15_000.0)
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

    /// The spherical-harmonics degree at this step: one more every 1,000 published steps.
    pub(crate) fn degree(&self, step: u32, most: u8) -> u8 {
        let degree = step / self.time(1000.0).max(1);
        u8::try_from(degree).unwrap_or(most).min(most)
    }

    /// The rate of means at this step, in extents.
    pub(crate) fn means_rate(&self, step: u32) -> f64 {
        let [first, last] = self.rates.means;
        let along = f64::from(step) / f64::from(self.iterations.max(1));
        (first.ln() + along.min(1.0) * (last.ln() - first.ln())).exp()
    }

    /// The share of all rates, except the rate of means, that is left at this step.
    pub(crate) fn share(&self, step: u32) -> f64 {
        let along = f64::from(step) / f64::from(self.iterations.max(1));
        self.rates.last.powf((2.0 * along - 1.0).clamp(0.0, 1.0))
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
        assert!((options.means_rate(0) - 1.6e-4).abs() < 1e-12);
        assert!((options.means_rate(30_000) - 1.6e-6).abs() < 1e-12);
        assert_eq!([0, 15_000, 30_000].map(|step| options.share(step)), [1.0; 3]);
        let quick = Options::default();
        assert_eq!([0, 1000].map(|step| quick.share(step)), [1.0; 2]);
        assert!((quick.share(2000) - 0.1).abs() < 1e-12 && quick.share(1500) < 0.5);
    }
}
