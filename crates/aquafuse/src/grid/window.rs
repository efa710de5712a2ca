//! Means over a square of cells around each cell.

use std::ops::Range;

use crate::simd::{self, Work};

/// Mean over the `2 * reach + 1` square around each of the `columns` wide rows of values, cut off at the rim.
///
/// To the bit the same from left and right: places equally far to either side are added to one another first.
pub(crate) fn mean_around(columns: usize, reach: usize, values: &[f32]) -> Vec<f32> {
    simd::widest(MeanAround { columns, reach, values })
}

struct MeanAround<'a> {
    columns: usize,
    reach: usize,
    values: &'a [f32],
}

impl Work for MeanAround<'_> {
    type Output = Vec<f32>;

    #[inline(always)]
    fn run(self) -> Vec<f32> {
        let Self { columns, reach, values } = self;
        let mut means = vec![0.0; values.len()];
        let mut window = Window::new(1, (columns, values.len() / columns), reach);
        for turn in window.turns() {
            if let Some(row) = values.chunks_exact(columns).nth(turn) {
                window.next(0).copy_from_slice(row);
                window.add(turn);
            }
            if let Some(y) = window.average(turn) {
                means[y * columns..][..columns].copy_from_slice(window.mean(0));
            }
        }
        means
    }
}

/// Cells that are computed with at once.
pub(crate) const BLOCK: usize = 16;

/// Means around each cell of several quantities, of which a few rows are kept at a time: they stay in the nearest memory.
///
/// In each of its [turns](Self::turns) the next row is written and [added](Self::add), and an earlier one can be
/// [averaged](Self::average). The quantities of a row lie one behind the other, so that one loop does for all.
pub(crate) struct Window {
    quantities: usize,
    columns: usize,
    rows: usize,
    reach: usize,
    /// The next row of each quantity, with `reach` times nothing at both ends, which adds nothing.
    next: Vec<f32>,
    /// Sums over the columns around each cell, of the rows that are still needed.
    across: Vec<f32>,
    /// One over the number of columns around a cell.
    shares: Vec<f32>,
    means: Vec<f32>,
}

impl Window {
    #[inline(always)]
    pub(crate) fn new(quantities: usize, (columns, rows): (usize, usize), reach: usize) -> Self {
        let all = quantities * (columns + 2 * reach);
        let mut shares = vec![0.0; all];
        for row in shares.chunks_exact_mut(columns + 2 * reach) {
            for (x, share) in row[..columns].iter_mut().enumerate() {
                *share = (around(x, reach, columns).len() as f32).recip();
            }
        }
        Self {
            quantities,
            columns,
            rows,
            reach,
            next: vec![0.0; all + 2 * reach],
            across: vec![0.0; all * (2 * reach + 1)],
            shares,
            means: vec![0.0; all + BLOCK],
        }
    }

    /// One turn for each row, and as many more as the last means wait for.
    pub(crate) fn turns(&self) -> Range<usize> {
        0..self.rows + self.reach
    }

    /// What all quantities of a row take.
    #[inline(always)]
    fn all(&self) -> usize {
        self.quantities * (self.columns + 2 * self.reach)
    }

    /// Where the next row of a quantity is written.
    #[inline(always)]
    pub(crate) fn next(&mut self, quantity: usize) -> &mut [f32] {
        let from = quantity * (self.columns + 2 * self.reach) + self.reach;
        &mut self.next[from..][..self.columns]
    }

    /// Writes the product of two quantities of the next row for a third one, behind them.
    #[inline(always)]
    pub(crate) fn multiply(&mut self, quantity: usize, a: usize, b: usize) {
        let row = self.columns + 2 * self.reach;
        let (before, product) = self.next.split_at_mut(quantity * row + self.reach);
        let [a, b] = [a, b].map(|factor| &before[factor * row + self.reach..][..self.columns]);
        let product = &mut product[..self.columns];
        for x in 0..product.len() {
            product[x] = a[x] * b[x];
        }
    }

    /// Adds the row that was written.
    #[inline(always)]
    pub(crate) fn add(&mut self, turn: usize) {
        let (all, reach) = (self.all(), self.reach);
        let sums = &mut self.across[turn % (2 * reach + 1) * all..][..all];
        sums.copy_from_slice(&self.next[reach..][..all]);
        for step in 1..=reach {
            let (left, right) = (&self.next[reach - step..][..all], &self.next[reach + step..][..all]);
            for x in 0..all {
                sums[x] += left[x] + right[x];
            }
        }
    }

    /// Averages the row all of whose neighbours have been added by now, and says which it is.
    #[inline(always)]
    pub(crate) fn average(&mut self, turn: usize) -> Option<usize> {
        let (all, reach) = (self.all(), self.reach);
        let y = turn.checked_sub(reach)?;
        let around = around(y, reach, self.rows);
        let share = (around.len() as f32).recip();
        let (means, shares) = (&mut self.means[..all], &self.shares[..all]);
        means.fill(0.0);
        for row in around {
            let sums = &self.across[row % (2 * reach + 1) * all..][..all];
            for x in 0..all {
                means[x] += sums[x];
            }
        }
        for x in 0..all {
            means[x] *= shares[x] * share;
        }
        Some(y)
    }

    /// The means of a quantity in the row that was averaged last.
    #[inline(always)]
    pub(crate) fn mean(&self, quantity: usize) -> &[f32] {
        &self.means[quantity * (self.columns + 2 * self.reach)..][..self.columns]
    }

    /// A block of them, from some column on; beyond the last column it holds anything.
    #[inline(always)]
    pub(crate) fn block(&self, quantity: usize, from: usize) -> [f32; BLOCK] {
        let means = &self.means[quantity * (self.columns + 2 * self.reach) + from..];
        *means.first_chunk().expect("a block follows the last quantity")
    }
}

/// The places around one, of so many.
#[inline(always)]
fn around(place: usize, reach: usize, length: usize) -> Range<usize> {
    place.saturating_sub(reach)..(place + reach + 1).min(length)
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
