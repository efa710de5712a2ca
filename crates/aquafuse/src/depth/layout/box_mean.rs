//! The mean over a square around each pixel.

/// Mean of whole numbers over the `2 * reach + 1` square around each place, cut off at the borders and
/// rounded to whole numbers, so that it does not depend on the side from which it is summed.
pub(super) fn box_mean(width: usize, height: usize, reach: usize, values: &[i32]) -> Vec<i32> {
    let (columns, rows) = (Windows::new(width, reach), Windows::new(height, reach));
    // Sums of the columns around one row, moved down a row at a time.
    let mut sums = vec![0_i64; width];
    let mut means = Vec::with_capacity(values.len());
    let mut within = 0..0;
    for y in 0..height {
        let wanted = rows.around(y);
        let row = |y: usize| &values[y * width..][..width];
        for y in within.end..wanted.end {
            sums.iter_mut().zip(row(y)).for_each(|(sum, &value)| *sum += i64::from(value));
        }
        for y in within.start..wanted.start {
            sums.iter_mut().zip(row(y)).for_each(|(sum, &value)| *sum -= i64::from(value));
        }
        within = wanted.clone();
        let mut sum = 0;
        let mut summed = 0..0;
        for x in 0..width {
            let window = columns.around(x);
            sum += sums[summed.end..window.end].iter().sum::<i64>();
            sum -= sums[summed.start..window.start].iter().sum::<i64>();
            let count = (window.len() * wanted.len()) as i64;
            means.push((sum + count / 2).div_euclid(count) as i32);
            summed = window;
        }
    }
    means
}

/// The places within reach along one side.
struct Windows {
    length: usize,
    reach: usize,
}

impl Windows {
    fn new(length: usize, reach: usize) -> Self {
        Self { length, reach }
    }

    fn around(&self, place: usize) -> std::ops::Range<usize> {
        place.saturating_sub(self.reach)..(place + self.reach + 1).min(self.length)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn running_sums_equal_the_plain_mean(
            (width, values) in (1..9_usize).prop_flat_map(|width| {
                (Just(width), prop::collection::vec(-70_000..70_000_i32, width..width * 9))
            }),
            reach in 0..5_usize,
        ) {
            let height = values.len() / width;
            let values = &values[..width * height];
            let found = box_mean(width, height, reach, values);
            for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
                let near = |a: usize, b: usize| a.abs_diff(b) <= reach;
                let inside: Vec<f64> = (0..values.len())
                    .filter(|i| near(i % width, x) && near(i / width, y))
                    .map(|i| f64::from(values[i]))
                    .collect();
                let mean = inside.iter().sum::<f64>() / inside.len() as f64;
                prop_assert!((f64::from(found[y * width + x]) - mean).abs() <= 0.5 + 1e-6);
            }
        }
    }
}
