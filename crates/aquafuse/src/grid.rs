//! A grid of cells over an image, whose borders are mirrored with it.

mod window;

pub(crate) use window::{BLOCK, Window, mean_around};

/// Where the cells of an image begin and end.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Grid {
    columns: Vec<usize>,
    rows: Vec<usize>,
}

impl Grid {
    /// About `cells` along the shorter side of an image of this size, of `least_side` pixels or more.
    pub(crate) fn new((width, height): (usize, usize), cells: usize, least_side: f32) -> Self {
        let side = (width.min(height) as f32 / cells as f32).max(least_side);
        Self { columns: borders(width, side), rows: borders(height, side) }
    }

    /// How many cells there are in a row, and how many rows.
    pub(crate) fn size(&self) -> (usize, usize) {
        (self.columns.len() - 1, self.rows.len() - 1)
    }

    /// The borders of columns in pixels, from 0 to the image's width.
    pub(crate) fn columns(&self) -> &[usize] {
        &self.columns
    }

    /// The borders of rows in pixels, from 0 to the image's height.
    pub(crate) fn rows(&self) -> &[usize] {
        &self.rows
    }
}

/// Where cells of about `side` begin and end along `length`: the same from both ends.
fn borders(length: usize, side: f32) -> Vec<usize> {
    let wanted = ((length as f32 / side) as usize).clamp(1, length);
    // An odd length has a middle pixel: only an odd number of cells can be even about it.
    let count = if wanted % 2 == length % 2 || wanted == 1 { wanted } else { wanted - 1 };
    let from_start = |i: usize| (2 * i * length + count) / (2 * count);
    (0..=count).map(|i| if 2 * i <= count { from_start(i) } else { length - from_start(count - i) }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn borders_are_the_same_from_both_ends(length in 1..3000_usize, side in 1.0..40.0_f32) {
            let found = borders(length, side);
            prop_assert_eq!((found[0], found[found.len() - 1]), (0, length));
            prop_assert!(found.windows(2).all(|pair| pair[0] < pair[1]));
            let mirrored: Vec<usize> = found.iter().rev().map(|border| length - border).collect();
            prop_assert_eq!(found, mirrored);
        }
    }
}
