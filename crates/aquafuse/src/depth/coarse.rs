//! A coarse map of depth, as of a network, brought to the size of its image by the refinement of depth from colour.

use std::ops::Range;

use super::DepthMap;
use super::refine::FLAT;
use crate::bands;
use crate::grid::Grid;
use crate::guided::Guided;
use crate::image::{Encoded, ImageRef};

impl DepthMap {
    /// A coarse map of the scene of `image`, as of a network, at the image's size: smooth where the image is smooth, with
    /// edges where the image has edges (guided filter, He, Sun and Tang 2013, with colour as guide).
    ///
    /// The map may have any size; of the image's own size it is returned as it is. No distance leaves the range of the map.
    ///
    /// # Examples
    ///
    /// ```
    /// use aquafuse::{depth::{DepthKind, DepthMap}, image::Image};
    ///
    /// // Dark things on the left, bright water on the right; four distances for 32 x 32 pixels.
    /// let row = |_| (0..32).flat_map(|x| if x < 16 { [20; 3] } else { [40, 120, 200] });
    /// let image = Image::<u8>::from_raw(32, 32, (0..32).flat_map(row).collect())?;
    /// let coarse = DepthMap::from_distances(2, 2, DepthKind::Metres, vec![2.0, 6.0, 2.0, 6.0])?;
    /// let fine = coarse.refined_by(&image);
    /// assert_eq!((fine.size(), fine.kind()), ((32, 32), DepthKind::Metres));
    /// assert!(fine.at(2, 9) < 3.0 && fine.at(29, 9) > 5.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn refined_by<'a>(&self, image: impl Into<ImageRef<'a, u8>>) -> Self {
        let image = image.into();
        if image.size() == self.size() {
            return self.clone();
        }
        self.with_distances(image.size(), fine(image, self))
    }
}

/// z of a coarse map at the pixels of an image, within the ends of the map: around each of its values it is fitted to the colours.
fn fine(image: ImageRef<'_, u8>, map: &DepthMap) -> Vec<f32> {
    let (width, height) = image.size();
    let (columns, rows) = map.size();
    let values = map.distances();
    let grid = Grid::new(image.size(), columns.min(rows), 1.0);
    let scale = [columns as f32 / width as f32, rows as f32 / height as f32];
    let mut cells = Vec::new();
    for rows in grid.rows().windows(2) {
        for columns in grid.columns().windows(2) {
            let colour = mean_colour(image, columns[0]..columns[1], rows[0]..rows[1]);
            let from = [columns[0] as f32 * scale[0], rows[0] as f32 * scale[1]];
            let to = [columns[1] as f32 * scale[0], rows[1] as f32 * scale[1]];
            cells.push((colour, mean_value(&values, map.size(), from, to)));
        }
    }
    let (colours, means): (Vec<[f32; 3]>, Vec<f32>) = cells.into_iter().unzip();
    let guided = Guided::new(&grid, &colours, &means, FLAT);
    let least = values.iter().copied().fold(f32::INFINITY, f32::min);
    let most = values.iter().copied().fold(0.0, f32::max);
    let mut distances = vec![0.0; width * height];
    bands::for_each(&mut distances, width, |first, band| {
        let mut rows = guided.rows();
        for (y, line) in (first..).zip(band.chunks_mut(width)) {
            let found = &*rows.row::<u8, Encoded>(y, image.row(y));
            line.iter_mut().zip(found).for_each(|(z, found)| *z = found.clamp(least, most));
        }
    });
    distances
}

fn mean_colour(image: ImageRef<'_, u8>, columns: Range<usize>, rows: Range<usize>) -> [f32; 3] {
    let count = (columns.len() * rows.len()) as f32;
    let mut sums = [0_u32; 3];
    for y in rows {
        for pixel in &image.row(y)[columns.clone()] {
            (0..3).for_each(|c| sums[c] += u32::from(pixel[c]));
        }
    }
    sums.map(|sum| sum as f32 / (255.0 * count))
}

/// The mean of a map between two places, in its own columns and rows.
fn mean_value(values: &[f32], (columns, rows): (usize, usize), from: [f32; 2], to: [f32; 2]) -> f32 {
    // Between the middles of values the map is linear: one place for each value suffices.
    let places = |k: usize| {
        let count = (to[k] - from[k]).ceil().max(1.0) as usize;
        let step = (to[k] - from[k]) / count as f32;
        (0..count).map(move |i| from[k] + (i as f32 + 0.5) * step - 0.5)
    };
    let beside = |place: f32, count: usize| {
        let place = place.clamp(0.0, (count - 1) as f32);
        let before = place as usize;
        (before, (before + 1).min(count - 1), place - before as f32)
    };
    let (mut sum, mut count) = (0.0, 0.0);
    for y in places(1) {
        let (above, below, down) = beside(y, rows);
        for x in places(0) {
            let (left, right, across) = beside(x, columns);
            let at = |row: usize| {
                let line = &values[row * columns..][..columns];
                line[left] + across * (line[right] - line[left])
            };
            sum += at(above) + down * (at(below) - at(above));
            count += 1.0;
        }
    }
    sum / count
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::depth::DepthKind;
    use crate::image::Image;
    use proptest::prelude::*;

    fn image(width: usize, height: usize) -> Image<u8> {
        let bytes = (0..3 * width * height).map(|i| (i * 37 % 251) as u8).collect();
        Image::from_raw(width, height, bytes).unwrap()
    }

    proptest! {
        #[test]
        fn no_distance_leaves_the_range_of_the_map(
            (width, height) in (1..40_usize, 1..40_usize),
            (columns, rows) in (1..60_usize, 1..60_usize),
        ) {
            let values: Vec<f32> = (0..columns * rows).map(|i| 1.0 + (i * 13 % 17) as f32).collect();
            let coarse = DepthMap::from_distances(columns, rows, DepthKind::Metres, values.clone()).unwrap();
            let fine = coarse.refined_by(&image(width, height));
            prop_assert_eq!(fine.size(), (width, height));
            let most = values.iter().copied().fold(0.0, f32::max);
            prop_assert!(fine.distances().iter().all(|z| (1.0..=most).contains(z)));
        }
    }

    #[test]
    fn of_the_images_own_size_a_map_is_returned_as_it_is() {
        let values: Vec<f32> = (0..12 * 9).map(|i| i as f32 / 200.0).collect();
        let map = DepthMap::from_distances(12, 9, DepthKind::Relative, values).unwrap();
        assert_eq!(map.refined_by(&image(12, 9)), map);
    }

    #[test]
    fn a_slope_stays_a_slope_where_colours_do_not_guide() {
        let grey = Image::<u8>::from_raw(160, 120, vec![90; 160 * 120 * 3]).unwrap();
        let values = (0..40 * 30).map(|i| (i % 40) as f32 / 40.0).collect();
        let fine = DepthMap::from_distances(40, 30, DepthKind::Relative, values).unwrap().refined_by(&grey);
        for x in 20..140 {
            let expected = ((x as f32 + 0.5) / 4.0 - 0.5) / 40.0;
            assert!((fine.at(x, 60) - expected).abs() < 0.01, "{} is not {expected}", fine.at(x, 60));
        }
    }
}
