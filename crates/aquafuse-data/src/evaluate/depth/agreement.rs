//! One map of depth beside another.

use aquafuse::depth::SuppliedKind;
use aquafuse::metrics::spearman;

/// What of a map's distances is not known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unit {
    /// Nothing: they are metres.
    Metres,
    /// Their scale.
    Scaled,
    /// Scale and shift.
    Shifted,
    /// Scale and shift of 1 / z, for which 1 less the value stands.
    Inverse,
}

impl Unit {
    pub(super) fn of(kind: SuppliedKind) -> Self {
        match kind {
            SuppliedKind::Metres | SuppliedKind::Millimetres => Self::Metres,
            SuppliedKind::Disparity => Self::Scaled,
            SuppliedKind::Inverse => Self::Inverse,
            _ => Self::Shifted,
        }
    }
}

/// How far a map agrees with known depth; none where the units leave nothing to compare.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Agreement {
    /// Rank correlation.
    pub(super) spearman: Option<f64>,
    /// After the best scale and shift, where the known depth is in metres.
    pub(super) rmse_metres: Option<f64>,
    /// The same in percent of the mean known depth, where that has a true zero.
    pub(super) rmse_percent: Option<f64>,
    /// Pixels within a factor of 1.25 after the best scale and shift, in percent, where known depth has a true zero.
    pub(super) delta_percent: Option<f64>,
}

/// The factor.
const DELTA: f64 = 1.25;

impl Agreement {
    /// Compares where both are known (not NaN); none where fewer than two pixels are.
    pub(super) fn of(map: &[f32], unit: Unit, known: &[f32], known_unit: Unit) -> Option<Self> {
        let both = map.iter().zip(known).filter(|(a, b)| a.is_finite() && b.is_finite());
        let (map, known): (Vec<f32>, Vec<f32>) = both.map(|(a, b)| (*a, *b)).unzip();
        if known.len() < 2 {
            return None;
        }
        let spearman = spearman(&map, &known);
        let none = Self { spearman, rmse_metres: None, rmse_percent: None, delta_percent: None };
        if known_unit == Unit::Inverse {
            return Some(none);
        }
        let fitted = fitted(&map, unit, &known);
        let count = known.len() as f64;
        let pairs = || fitted.iter().zip(&known).map(|(fitted, known)| (*fitted, f64::from(*known)));
        let squares = pairs().fold(0.0, |sum, (fitted, known)| sum + (fitted - known) * (fitted - known));
        let rmse = (squares / count).sqrt();
        let mean = mean(&known);
        let within = pairs().filter(|(fitted, known)| {
            *fitted > 0.0 && *known > 0.0 && (fitted / known).max(known / fitted) < DELTA
        });
        Some(Self {
            rmse_metres: (known_unit == Unit::Metres).then_some(rmse),
            rmse_percent: (mean > 0.0).then_some(100.0 * rmse / mean),
            delta_percent: Some(100.0 * within.count() as f64 / count),
            ..none
        })
    }
}

/// The distances that a map means, after the scale and shift by which they are nearest to the known ones.
fn fitted(map: &[f32], unit: Unit, known: &[f32]) -> Vec<f64> {
    if unit != Unit::Inverse {
        let line = Line::through(map.iter().map(|v| f64::from(*v)), known.iter().map(|v| f64::from(*v)));
        return map.iter().map(|value| line.at(f64::from(*value))).collect();
    }
    let nearness = |value: &f32| 1.0 - f64::from(*value);
    let positive = |value: &&f32| **value > 0.0;
    let farthest = known.iter().copied().fold(0.0_f32, f32::max);
    let inverse = map.iter().zip(known).filter(|(_, known)| positive(known));
    let line = Line::through(
        inverse.clone().map(|(value, _)| nearness(value)),
        inverse.map(|(_, known)| 1.0 / f64::from(*known)),
    );
    // What would lie beyond everything that is known is taken for the farthest.
    let distance = |value: &f32| 1.0 / line.at(nearness(value)).max(1.0 / f64::from(farthest));
    map.iter().map(distance).collect()
}

/// `scale x + shift`.
#[derive(Clone, Copy)]
struct Line {
    scale: f64,
    shift: f64,
}

impl Line {
    /// The line with the least squares, of those that do not fall: a map inverted gets no credit.
    fn through(x: impl Iterator<Item = f64> + Clone, y: impl Iterator<Item = f64> + Clone) -> Self {
        let count = x.clone().count().max(1) as f64;
        let mean_x = x.clone().fold(0.0, |sum, value| sum + value) / count;
        let mean_y = y.clone().fold(0.0, |sum, value| sum + value) / count;
        let (mut covariance, mut variance) = (0.0, 0.0);
        for (x, y) in x.zip(y) {
            covariance += (x - mean_x) * (y - mean_y);
            variance += (x - mean_x) * (x - mean_x);
        }
        let scale = if variance > 0.0 { (covariance / variance).max(0.0) } else { 0.0 };
        Self { scale, shift: mean_y - scale * mean_x }
    }

    fn at(&self, x: f64) -> f64 {
        self.scale * x + self.shift
    }
}

fn mean(values: &[f32]) -> f64 {
    values.iter().fold(0.0, |sum, value| sum + f64::from(*value)) / values.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const KNOWN: [f32; 6] = [1.0, 1.5, 2.0, 4.0, 3.0, 8.0];

    fn of(map: &[f32], unit: Unit) -> Agreement {
        Agreement::of(map, unit, &KNOWN, Unit::Metres).unwrap()
    }

    #[test]
    fn scale_and_shift_do_not_matter_to_any_score() {
        let found = of(&KNOWN.map(|z| 0.1 * z + 0.05), Unit::Shifted);
        assert!(found.rmse_metres.unwrap() < 1e-6 && found.spearman == Some(1.0));
        assert_eq!(found.delta_percent, Some(100.0));
    }

    #[test]
    fn inverse_depth_is_fitted_as_one_over_z() {
        // As the reader turns it: 1 less something linear in 1 / z.
        let turned = KNOWN.map(|z| 1.0 - (0.7 / z + 0.1));
        let right = of(&turned, Unit::Inverse);
        assert!(right.rmse_metres.unwrap() < 1e-5, "{right:?}");
        assert!(of(&turned, Unit::Shifted).rmse_metres.unwrap() > 0.5);
    }

    #[test]
    fn a_map_turned_round_is_worth_no_more_than_its_mean() {
        let found = of(&KNOWN.map(|z| 10.0 - z), Unit::Shifted);
        let deviation = {
            let mean = mean(&KNOWN);
            (KNOWN.iter().map(|z| (f64::from(*z) - mean).powi(2)).sum::<f64>() / 6.0).sqrt()
        };
        assert_eq!(found.spearman, Some(-1.0));
        assert!((found.rmse_metres.unwrap() - deviation).abs() < 1e-6);
    }

    #[test]
    fn what_is_not_known_does_not_count_and_inverse_truth_tells_order_alone() {
        let known = [1.0, f32::NAN, 2.0, 3.0];
        let found = Agreement::of(&[1.0, 900.0, 2.0, f32::NAN], Unit::Shifted, &known, Unit::Metres).unwrap();
        assert!(found.rmse_metres.unwrap() < 1e-9);
        assert_eq!(Agreement::of(&[1.0; 4], Unit::Shifted, &[f32::NAN; 4], Unit::Metres), None);
        let order = Agreement::of(&KNOWN, Unit::Shifted, &KNOWN, Unit::Inverse).unwrap();
        assert_eq!((order.spearman, order.rmse_percent, order.delta_percent), (Some(1.0), None, None));
    }

    proptest! {
        #[test]
        fn no_map_is_worse_than_the_mean_of_what_is_known(map in prop::array::uniform6(0.0..1.0_f32)) {
            let flat = of(&[0.5; 6], Unit::Shifted).rmse_metres.unwrap();
            prop_assert!(of(&map, Unit::Shifted).rmse_metres.unwrap() <= flat + 1e-9);
        }
    }
}
