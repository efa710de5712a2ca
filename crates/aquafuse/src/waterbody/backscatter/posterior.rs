//! How likely each optical depth, each floor and each veiling light is, given the dark envelope of a channel.

use super::envelope::Point;
use super::veils::Veils;
use crate::image::Encoding;
use crate::simd;

/// How dark the darkest things are, seen through no water (encoded), and how often: black, shadow, dark grey.
const FLOORS: [f32; 5] = [0.0, 0.02, 0.05, 0.1, 0.2];
const FREQUENCY: [f32; 5] = [0.35, 0.25, 0.2, 0.12, 0.08];
/// How far above the curve the darkest thing of a bin usually lies when none of it is dark (encoded, near by).
const EXCESS: f32 = 0.06;
/// Half squared deviations at which a bin is an outlier and says no more.
const OUTLIER: f32 = 8.0;

/// How far a bin may be trusted.
#[derive(Clone, Copy, Debug)]
pub(super) struct Trust {
    /// Deviation of a bin from the curve (encoded).
    pub(super) deviation: f32,
    /// Weight of all bins together against the prior: 1 if each errs on its own, less if all err alike.
    pub(super) weight: f32,
}

/// A bell over a logarithm.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bell {
    pub(super) mean: f32,
    pub(super) deviation: f32,
}

impl Bell {
    /// What both say together.
    pub(super) fn and(self, other: Self) -> Self {
        let [a, b] = [self, other].map(|bell| bell.deviation.powi(-2));
        Self { mean: (a * self.mean + b * other.mean) / (a + b), deviation: (a + b).powf(-0.5) }
    }

    /// -ln of how likely a value is, up to what does not depend on it.
    pub(super) fn cost(self, value: f32) -> f32 {
        0.5 * ((value - self.mean) / self.deviation).powi(2)
    }

    /// Mean and deviation of `values` by their weights.
    fn of(values: impl Iterator<Item = f32>, weights: &[f32]) -> Self {
        let (mut sum, mut first, mut second) = (0.0, 0.0, 0.0);
        for (value, weight) in values.zip(weights) {
            sum += weight;
            first += weight * value;
            second += weight * value * value;
        }
        let mean = first / sum;
        Self { mean, deviation: (second / sum - mean * mean).max(0.0).sqrt() }
    }
}

/// e^-cost, the largest 1.
fn weights(mut costs: Vec<f32>) -> Vec<f32> {
    let least = costs.iter().copied().fold(f32::INFINITY, f32::min);
    costs.iter_mut().for_each(|cost| *cost = (least - *cost).exp());
    costs
}

/// Optical depths that are tried, and what each leaves of a thing's own light in each bin.
pub(super) struct Grid {
    ln_taus: Vec<f32>,
    /// e^(-τ z), bin after bin for each optical depth.
    factors: Vec<f32>,
}

impl Grid {
    /// The grid of these optical depths (as logarithms) for bins at these z, in units of z95.
    pub(super) fn new(ln_taus: Vec<f32>, bins: &[f32]) -> Self {
        let factors = ln_taus.iter().map(|ln_tau| ln_tau.exp());
        let factors = factors.flat_map(|tau| bins.iter().map(move |z| (-tau * z).exp())).collect();
        Self { ln_taus, factors }
    }

    /// Each optical depth (as a logarithm) with what it leaves in each bin.
    pub(super) fn iter(&self) -> impl Iterator<Item = (f32, &[f32])> {
        let bins = self.factors.len() / self.ln_taus.len();
        self.ln_taus.iter().enumerate().map(move |(i, &ln_tau)| (ln_tau, &self.factors[i * bins..][..bins]))
    }
}

/// What the envelope of a channel says.
#[derive(Clone, Copy, Debug)]
pub(super) struct Posterior {
    /// ln of the optical depth β_B z95.
    pub(super) ln_tau: Bell,
    /// ln of the factor by which the veiling light differs from the one supposed.
    pub(super) ln_veil: Bell,
    /// Expected floor (encoded).
    pub(super) floor: f32,
    /// Share of the bins that lie on the likeliest curve.
    pub(super) on_curve: f32,
}

/// Weighs every optical depth that is tried with every factor of `veils` on the veiling light `read`.
///
/// The curve of a floor s is `B∞ (1 - e^(-τ z)) + s e^(-τ z)`. A bin below it contradicts it by noise alone; a
/// bin above it may merely hold nothing dark, which is the likelier the more of a thing's own light is left.
pub(super) fn weigh<E: Encoding>(
    points: &[Point],
    read: f32,
    trust: Trust,
    prior: Bell,
    tried: &Grid,
    veils: Veils,
) -> Posterior {
    let floors = FLOORS.map(|floor| E::from_encoded(floor));
    let lanes = std::array::from_fn(|lane| floors[lane.min(FLOORS.len() - 1)]);
    let rarities = FREQUENCY.map(f32::ln);
    // The excess shrinks with the encoding as the largest floor does.
    let excess = EXCESS / FLOORS[4] * floors[4];
    let ln_factors = veils.ln_factors();
    let cells = tried.ln_taus.len() * ln_factors.len();
    let (mut together, mut of_floor) = (Vec::with_capacity(cells), Vec::with_capacity(cells * FLOORS.len()));
    let mut best = (f32::INFINITY, 0.0);
    let mut terms = Vec::with_capacity(points.len());
    for (ln_tau, factors) in tried.iter() {
        terms.clear();
        let each = points.iter().zip(factors);
        terms.extend(each.map(|(point, &factor)| Term::new(point, factor, trust.deviation, excess)));
        let prior = prior.cost(ln_tau);
        // z95 is the unit of z: there is the far end.
        let left = (-ln_tau.exp()).exp();
        for &ln_factor in ln_factors {
            let veil = (read * ln_factor.exp()).min(1.0);
            let veil_cost = veils.cost::<E>(read, ln_factor, left);
            let misfits = simd::widest(Misfits { terms: &terms, veil, floors: lanes });
            let mut sum = Sum::default();
            for ((floor, rarity), misfit) in floors.into_iter().zip(rarities).zip(misfits) {
                let cost = trust.weight * misfit - rarity + prior + veil_cost;
                if cost < best.0 {
                    let on = terms.iter().filter(|term| term.is_on(veil, floor)).count();
                    best = (cost, on as f32 / points.len().max(1) as f32);
                }
                sum.add(cost);
                of_floor.push(cost);
            }
            together.push(sum.cost());
        }
    }
    let (together, of_floor) = (weights(together), weights(of_floor));
    let ln_taus = tried.ln_taus.iter().flat_map(|&ln_tau| ln_factors.iter().map(move |_| ln_tau));
    Posterior {
        ln_tau: Bell::of(ln_taus, &together),
        ln_veil: Bell::of(ln_factors.iter().copied().cycle(), &together),
        floor: Bell::of(FLOORS.into_iter().cycle(), &of_floor).mean,
        on_curve: best.1,
    }
}

/// -ln of a sum of e^-cost, added up without overflow.
struct Sum {
    least: f32,
    sum: f32,
}

impl Default for Sum {
    fn default() -> Self {
        Self { least: f32::INFINITY, sum: 0.0 }
    }
}

impl Sum {
    fn add(&mut self, cost: f32) {
        if cost < self.least {
            self.sum = self.sum * (cost - self.least).exp() + 1.0;
            self.least = cost;
        } else {
            self.sum += (self.least - cost).exp();
        }
    }

    fn cost(&self) -> f32 {
        self.least - self.sum.ln()
    }
}

/// A bin at one optical depth.
struct Term {
    dark: f32,
    factor: f32,
    /// 1 / deviation.
    sharpness: f32,
    /// 1 / (deviation + excess).
    slack: f32,
    /// ln of excess against deviation.
    rarity: f32,
}

impl Term {
    fn new(point: &Point, factor: f32, deviation: f32, excess: f32) -> Self {
        let deviation = deviation * point.slope;
        let scale = deviation + excess * factor;
        Self {
            dark: point.dark,
            factor,
            sharpness: deviation.recip(),
            slack: scale.recip(),
            rarity: (scale / deviation).ln(),
        }
    }

    /// How far the bin lies above the curve.
    #[inline(always)]
    fn off(&self, veil: f32, floor: f32) -> f32 {
        self.dark - (veil + (floor - veil) * self.factor)
    }

    fn is_on(&self, veil: f32, floor: f32) -> bool {
        (self.off(veil, floor) * self.sharpness).abs() < 2.0
    }
}

/// Floors that are weighed side by side, as a vector holds them: those of [`FLOORS`], and the last one again.
const LANES: usize = 8;

/// What all bins together cost with one veil, for each floor.
struct Misfits<'a> {
    terms: &'a [Term],
    veil: f32,
    floors: [f32; LANES],
}

impl simd::Work for Misfits<'_> {
    type Output = [f32; LANES];

    #[inline(always)]
    fn run(self) -> [f32; LANES] {
        let Self { terms, veil, floors } = self;
        let mut sums = [0.0; LANES];
        for term in terms {
            let bound = OUTLIER + term.rarity;
            for (sum, floor) in sums.iter_mut().zip(floors) {
                let off = term.off(veil, floor);
                let squared = 0.5 * (off * term.sharpness).powi(2);
                let above = (term.rarity + 0.7 + off * term.slack).min(bound);
                *sum += squared.min(if off < 0.0 { OUTLIER } else { above });
            }
        }
        sums
    }
}
