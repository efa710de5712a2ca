//! How likely each optical depth, each floor and each veiling light is, given the dark envelope of a channel.

use super::envelope::Point;
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

    fn cost(self, value: f32) -> f32 {
        0.5 * ((value - self.mean) / self.deviation).powi(2)
    }

    /// Mean and deviation of `values` weighted by e^-cost.
    fn of(values: &[f32], costs: &[f32]) -> Self {
        let least = costs.iter().copied().fold(f32::INFINITY, f32::min);
        let (mut sum, mut first, mut second) = (0.0, 0.0, 0.0);
        for (value, cost) in values.iter().zip(costs) {
            let weight = (least - cost).exp();
            sum += weight;
            first += weight * value;
            second += weight * value * value;
        }
        let mean = first / sum;
        Self { mean, deviation: (second / sum - mean * mean).max(0.0).sqrt() }
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

/// Weighs every optical depth of `taus` (as logarithms) with every factor of `veils` on the veiling light `veil`.
///
/// The curve of a floor s is `B∞ (1 - e^(-τ z)) + s e^(-τ z)`. A bin below it contradicts it by noise alone; a
/// bin above it may merely hold nothing dark, which is the likelier the more of a thing's own light is left.
pub(super) fn weigh<E: Encoding>(
    points: &[Point],
    veil: f32,
    trust: Trust,
    prior: Bell,
    taus: &[f32],
    veils: &[(f32, f32)],
) -> Posterior {
    let floors = FLOORS.map(|floor| E::from_encoded(floor));
    // The excess shrinks with the encoding as the largest floor does.
    let excess = EXCESS / FLOORS[4] * floors[4];
    let cells = taus.len() * veils.len();
    let (mut of_tau, mut of_veil, mut of_floor) =
        (Vec::with_capacity(cells), Vec::with_capacity(cells), Vec::with_capacity(cells * FLOORS.len()));
    let (mut ln_taus, mut ln_veils) = (Vec::with_capacity(cells), Vec::with_capacity(cells));
    let mut best = (f32::INFINITY, 0.0);
    let mut terms = Terms::default();
    let mut costs = vec![0.0; points.len()];
    for &ln_tau in taus {
        terms.clear();
        points.iter().for_each(|point| terms.push(point, ln_tau.exp(), trust.deviation, excess));
        for &(ln_veil, veil_cost) in veils {
            let veil = (veil * ln_veil.exp()).min(1.0);
            let mut together = Sum::default();
            for (floor, frequency) in floors.into_iter().zip(FREQUENCY) {
                simd::widest(Costs { terms: &terms, veil, floor, costs: &mut costs });
                let misfit: f32 = costs.iter().sum();
                let cost = trust.weight * misfit - frequency.ln() + prior.cost(ln_tau) + veil_cost;
                if cost < best.0 {
                    let on = (0..points.len()).filter(|&i| terms.is_on(i, veil, floor)).count();
                    best = (cost, on as f32 / points.len().max(1) as f32);
                }
                together.add(cost);
                of_floor.push(cost);
            }
            ln_taus.push(ln_tau);
            ln_veils.push(ln_veil);
            of_tau.push(together.cost());
            of_veil.push(together.cost());
        }
    }
    let floor_values: Vec<f32> = FLOORS.iter().copied().cycle().take(of_floor.len()).collect();
    Posterior {
        ln_tau: Bell::of(&ln_taus, &of_tau),
        ln_veil: Bell::of(&ln_veils, &of_veil),
        floor: Bell::of(&floor_values, &of_floor).mean,
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

/// The bins at one optical depth, each quantity by itself.
#[derive(Default)]
struct Terms {
    dark: Vec<f32>,
    factor: Vec<f32>,
    /// 1 / deviation.
    sharpness: Vec<f32>,
    /// 1 / (deviation + excess).
    slack: Vec<f32>,
    /// ln of excess against deviation.
    rarity: Vec<f32>,
}

impl Terms {
    fn clear(&mut self) {
        for quantity in
            [&mut self.dark, &mut self.factor, &mut self.sharpness, &mut self.slack, &mut self.rarity]
        {
            quantity.clear();
        }
    }

    fn push(&mut self, point: &Point, tau: f32, deviation: f32, excess: f32) {
        let factor = (-tau * point.z).exp();
        let deviation = deviation * point.slope;
        let scale = deviation + excess * factor;
        self.dark.push(point.dark);
        self.factor.push(factor);
        self.sharpness.push(deviation.recip());
        self.slack.push(scale.recip());
        self.rarity.push((scale / deviation).ln());
    }

    fn is_on(&self, i: usize, veil: f32, floor: f32) -> bool {
        (off(self.dark[i], self.factor[i], veil, floor) * self.sharpness[i]).abs() < 2.0
    }
}

/// How far a bin lies above the curve.
#[inline(always)]
fn off(dark: f32, factor: f32, veil: f32, floor: f32) -> f32 {
    dark - (veil + (floor - veil) * factor)
}

/// What each bin costs with one veil and one floor. All at once; the sum then keeps its order.
struct Costs<'a> {
    terms: &'a Terms,
    veil: f32,
    floor: f32,
    costs: &'a mut [f32],
}

impl simd::Work for Costs<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { terms, veil, floor, costs } = self;
        let of_curve = terms.dark.iter().zip(&terms.factor).zip(&terms.sharpness);
        let of_bound = terms.slack.iter().zip(&terms.rarity);
        for ((cost, ((dark, factor), sharpness)), (slack, rarity)) in
            costs.iter_mut().zip(of_curve).zip(of_bound)
        {
            let off = off(*dark, *factor, veil, floor);
            let squared = 0.5 * (off * sharpness).powi(2);
            let above = (rarity + 0.7 + off * slack).min(OUTLIER + rarity);
            *cost = squared.min(if off < 0.0 { OUTLIER } else { above });
        }
    }
}
