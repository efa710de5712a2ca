//! Means over a square of cells around each cell.

/// Mean over the `2 * reach + 1` square around each of the `columns` wide rows of values, cut off at the rim.
///
/// To the bit the same from left and right: places equally far to either side are added to one another first.
pub(crate) fn mean_around(columns: usize, reach: usize, values: &[f32]) -> Vec<f32> {
    let rows = values.len() / columns;
    let mut across = vec![0.0; values.len()];
    let row_of = |y: usize| y * columns..(y + 1) * columns;
    // A row, padded by nothing at both ends, which adds nothing.
    let mut padded = vec![0.0; columns + 2 * reach];
    for y in 0..rows {
        let (row, sums) = (&values[row_of(y)], &mut across[row_of(y)]);
        padded[reach..reach + columns].copy_from_slice(row);
        sums.copy_from_slice(row);
        for step in 1..=reach {
            let (left, right) = (&padded[reach - step..], &padded[reach + step..]);
            for ((sum, left), right) in sums.iter_mut().zip(left).zip(right) {
                *sum += left + right;
            }
        }
    }
    let within = |place: usize, length: usize| place.saturating_sub(reach)..(place + reach + 1).min(length);
    let shares: Vec<f32> = (0..columns).map(|x| (within(x, columns).len() as f32).recip()).collect();
    let mut means = vec![0.0; values.len()];
    for y in 0..rows {
        let means = &mut means[row_of(y)];
        let around = within(y, rows);
        let share = (around.len() as f32).recip();
        for other in around {
            means.iter_mut().zip(&across[row_of(other)]).for_each(|(mean, sum)| *mean += sum);
        }
        means.iter_mut().zip(&shares).for_each(|(mean, of_row)| *mean *= of_row * share);
    }
    means
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn it_is_the_plain_mean_and_mirrored_it_is_the_mirror(
            (columns, values) in (1..9_usize).prop_flat_map(|columns| {
                (Just(columns), prop::collection::vec(-1.0..1.0_f32, columns..columns * 9))
            }),
            reach in 0..5_usize,
        ) {
            let rows = values.len() / columns;
            let values = &values[..columns * rows];
            let found = mean_around(columns, reach, values);
            for i in 0..values.len() {
                let near = |a: usize, b: usize| a.abs_diff(b) <= reach;
                let inside: Vec<f32> = (0..values.len())
                    .filter(|j| near(i % columns, j % columns) && near(i / columns, j / columns))
                    .map(|j| values[j])
                    .collect();
                let mean = inside.iter().sum::<f32>() / inside.len() as f32;
                prop_assert!((found[i] - mean).abs() < 1e-5);
            }
            let mirrored = |values: &[f32]| -> Vec<f32> {
                values.chunks(columns).flat_map(|row| row.iter().rev().copied()).collect()
            };
            prop_assert_eq!(mean_around(columns, reach, &mirrored(values)), mirrored(&found));
        }
    }
}
