//! Rank correlation.

/// Spearman's rank correlation of two series, in `[-1, 1]`: whether they rise together, whatever their scale.
///
/// Equal values share the mean of their ranks. None for fewer than two pairs, for a series of one value, and
/// for values that are no numbers. Relative depth has no unit, so against metres only its order can be right.
///
/// # Panics
///
/// When the series differ in length.
///
/// # Examples
///
/// ```
/// use aquafuse::metrics::spearman;
///
/// assert_eq!(spearman(&[1.0, 2.0, 3.0], &[10.0, 20.0, 1000.0]), Some(1.0));
/// assert_eq!(spearman(&[1.0, 2.0, 3.0], &[3.0, 2.0, 1.0]), Some(-1.0));
/// ```
pub fn spearman(a: &[f32], b: &[f32]) -> Option<f64> {
    assert_eq!(a.len(), b.len(), "each value of one series belongs to one of the other");
    if a.iter().chain(b).any(|value| value.is_nan()) {
        return None;
    }
    let (a, b) = (ranks(a), ranks(b));
    // Mean ranks are the same for both, ties or not.
    let mean = (a.len() as f64 + 1.0) / 2.0;
    let covariance =
        |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| (x - mean) * (y - mean)).sum::<f64>();
    let spread = (covariance(&a, &a) * covariance(&b, &b)).sqrt();
    (spread > 0.0).then(|| covariance(&a, &b) / spread)
}

/// Ranks from 1, equal values sharing the mean of theirs.
pub(crate) fn ranks(values: &[f32]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&i, &j| values[i].total_cmp(&values[j]));
    let mut ranks = vec![0.0; values.len()];
    let mut first = 0;
    for equal in order.chunk_by(|&i, &j| values[i] == values[j]) {
        let rank = first as f64 + (equal.len() as f64 + 1.0) / 2.0;
        equal.iter().for_each(|&i| ranks[i] = rank);
        first += equal.len();
    }
    ranks
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn equal_values_share_their_rank() {
        assert_eq!(ranks(&[5.0, 1.0, 5.0, 0.0]), [3.5, 2.0, 3.5, 1.0]);
    }

    #[test]
    fn what_has_no_order_has_no_correlation() {
        assert_eq!(spearman(&[1.0], &[2.0]), None);
        assert_eq!(spearman(&[1.0, 1.0], &[2.0, 3.0]), None);
        assert_eq!(spearman(&[1.0, f32::NAN], &[2.0, 3.0]), None);
    }

    proptest! {
        #[test]
        fn a_rising_function_changes_nothing(
            pairs in prop::collection::vec((-8.0..8.0_f32, -8.0..8.0_f32), 3..40),
        ) {
            let (a, b): (Vec<f32>, Vec<f32>) = pairs.into_iter().unzip();
            // Doubling keeps every order exactly.
            let doubled: Vec<f32> = a.iter().map(|value| 2.0 * value).collect();
            prop_assert_eq!(spearman(&a, &b), spearman(&doubled, &b));
            prop_assert_eq!(spearman(&a, &b), spearman(&b, &a));
        }
    }
}
