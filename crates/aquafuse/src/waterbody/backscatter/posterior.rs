//! How likely each optical depth, each floor and each veiling light is, given the dark envelope of a channel.

use super::envelope::Point;
use crate::image::Encoding;

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
    let mut terms: Vec<Term> = Vec::with_capacity(points.len());
    for &ln_tau in taus {
        terms.clear();
        terms.extend(points.iter().map(|point| Term::new(point, ln_tau.exp(), trust.deviation, excess)));
        for &(ln_veil, veil_cost) in veils {
            let veil = (veil * ln_veil.exp()).min(1.0);
            let mut together = Sum::default();
            let misfits = misfits(&terms, veil, &floors);
            for ((floor, frequency), misfit) in floors.into_iter().zip(FREQUENCY).zip(misfits) {
                let cost = trust.weight * misfit - frequency.ln() + prior.cost(ln_tau) + veil_cost;
                if cost < best.0 {
                    let on = terms.iter().filter(|term| term.is_on(veil, floor)).count();
                    best = (cost, on as f32 / terms.len().max(1) as f32);
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

/// What the bins cost together for each floor: side by side, so that no sum waits for itself alone.
fn misfits(terms: &[Term], veil: f32, floors: &[f32; FLOORS.len()]) -> [f32; FLOORS.len()] {
    let mut sums = [0.0; FLOORS.len()];
    for term in terms {
        for (sum, &floor) in sums.iter_mut().zip(floors) {
            *sum += term.cost(veil, floor);
        }
    }
    sums
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
    fn new(point: &Point, tau: f32, deviation: f32, excess: f32) -> Self {
        let factor = (-tau * point.z).exp();
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

    #[inline]
    fn off(&self, veil: f32, floor: f32) -> f32 {
        self.dark - (veil + (floor - veil) * self.factor)
    }

    #[inline]
    fn cost(&self, veil: f32, floor: f32) -> f32 {
        let off = self.off(veil, floor);
        let squared = 0.5 * (off * self.sharpness).powi(2);
        let above = self.rarity + 0.7 + off * self.slack;
        let bound = if off < 0.0 { OUTLIER } else { above.min(OUTLIER + self.rarity) };
        squared.min(bound)
    }

    fn is_on(&self, veil: f32, floor: f32) -> bool {
        (self.off(veil, floor) * self.sharpness).abs() < 2.0
    }
}
