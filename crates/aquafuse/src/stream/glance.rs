//! Whether a frame follows the last one, and how much brighter it is.

use crate::image::ImageRef;

/// Columns and rows of the blocks whose means are compared, and rows of pixels that are looked at in each: single pixels of a thing
/// that moves say less about exposure.
const BLOCKS: usize = 16;
const ROWS: usize = 4;
/// Means (bytes) outside say nothing about exposure: they are black or white.
const WITHIN: std::ops::RangeInclusive<f32> = 8.0..=247.0;
/// Fewer means than this say nothing either.
const FEWEST: usize = 64;
/// Columns and rows of the pixels whose histograms are compared, and bins of a channel.
const SIDE: usize = 32;
const BINS: usize = 16;
/// Share of the values that lie in other bins after a cut. Frames of a camera that moves are far below, most scenes far above.
const CUT: f32 = 0.3;

/// A frame at some places.
#[derive(Clone, Debug, Default)]
pub(super) struct Glance {
    size: (usize, usize),
    /// The mean of each block in bytes, 0 where there is none.
    means: Vec<[f32; 3]>,
    colours: Vec<[u8; 3]>,
    /// Room for ratios.
    ratios: Vec<f32>,
}

/// What a frame is to the one before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Change {
    /// Another scene, or the first one.
    Cut,
    /// The same scene; encoded values are this many times what they were.
    Goes(f32),
}

impl Glance {
    /// Looks at the next frame.
    ///
    /// The exposure is the median of the ratios of the means of a block, over all blocks and channels. Frames are two scenes if, the
    /// exposure aside, .3 of the values of their histograms lie in other bins.
    pub(super) fn next(&mut self, image: ImageRef<'_, u8>) -> Change {
        let is_first = self.size != image.size();
        if is_first {
            self.size = image.size();
            (self.means, self.colours) = (vec![[0.0; 3]; BLOCKS * BLOCKS], vec![[0; 3]; SIDE * SIDE]);
        }
        let brighter = self.brighter(image);
        let apart = self.apart(image, brighter);
        if is_first || apart > CUT { Change::Cut } else { Change::Goes(brighter) }
    }

    /// How many times brighter the image is.
    fn brighter(&mut self, image: ImageRef<'_, u8>) -> f32 {
        let (width, height) = image.size();
        self.ratios.clear();
        for (row, means) in self.means.chunks_mut(BLOCKS).enumerate() {
            let [top, bottom] = [row, row + 1].map(|row| row * height / BLOCKS);
            let rows = (bottom - top).min(ROWS);
            let rows = (0..rows).map(|i| image.row(top + (2 * i + 1) * (bottom - top) / (2 * rows)));
            let sums: [[u32; 3]; BLOCKS] = std::array::from_fn(|column| {
                let [left, right] = [column, column + 1].map(|column| column * width / BLOCKS);
                sum(rows.clone().map(|pixels| &pixels[left..right]))
            });
            let rows = rows.len();
            for (column, (mean, sum)) in means.iter_mut().zip(sums).enumerate() {
                let columns = (column + 1) * width / BLOCKS - column * width / BLOCKS;
                let count = (rows * columns).max(1) as f32;
                let now = sum.map(|sum| sum as f32 / count);
                for (&before, &now) in mean.iter().zip(&now) {
                    if WITHIN.contains(&before) && WITHIN.contains(&now) {
                        self.ratios.push(now / before);
                    }
                }
                *mean = now;
            }
        }
        match self.ratios.len() {
            ..FEWEST => 1.0,
            count => *self.ratios.select_nth_unstable_by(count / 2, f32::total_cmp).1,
        }
    }

    /// The share of the values that lie in other bins than those of the frame before, in so many times the light.
    fn apart(&mut self, image: ImageRef<'_, u8>, brighter: f32) -> f32 {
        let (width, height) = image.size();
        let middle = |place: usize, length: usize| (2 * place + 1) * length / (2 * SIDE);
        let bin = |value: f32| (value * (BINS as f32 / 256.0)).min((BINS - 1) as f32) as usize;
        let mut counts = [[0_i32; BINS]; 3];
        for (i, colour) in self.colours.iter_mut().enumerate() {
            let now = image.row(middle(i / SIDE, height))[middle(i % SIDE, width)];
            for c in 0..3 {
                counts[c][bin(f32::from(now[c]))] += 1;
                counts[c][bin(f32::from(colour[c]) * brighter)] -= 1;
            }
            *colour = now;
        }
        // A value that has left one bin has come into another.
        let apart: i32 = counts.as_flattened().iter().map(|count| count.abs()).sum();
        apart as f32 / (2 * 3 * SIDE * SIDE) as f32
    }
}

/// Sums of red, green and blue over pieces of rows.
fn sum<'a>(pieces: impl Iterator<Item = &'a [[u8; 3]]>) -> [u32; 3] {
    let (mut red, mut green, mut blue) = (0, 0, 0);
    for piece in pieces {
        for &[r, g, b] in piece {
            red += u32::from(r);
            green += u32::from(g);
            blue += u32::from(b);
        }
    }
    [red, green, blue]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Image;
    use crate::truth::{Pose, Scene, Size, View, waters};

    const SIZE: Size = Size { width: 120, height: 80 };

    fn seen(seed: u64, moved: f32, light: f32) -> Image<u8> {
        let pose = Pose { moved: [moved, 0.0, moved], yaw: 0.1 * moved, ..Pose::default() };
        let seen = Scene::from(View::default(), seed, &pose, SIZE).seen_through(&waters()[0].water);
        let lit = seen.as_raw().iter().map(|value| light * value).collect();
        Image::<f32>::from_raw(SIZE.width, SIZE.height, lit).unwrap().convert()
    }

    fn change(from: &Image<u8>, to: &Image<u8>) -> Change {
        let mut glance = Glance::default();
        assert_eq!(glance.next(from.view()), Change::Cut);
        glance.next(to.view())
    }

    #[test]
    fn a_camera_that_moves_in_changing_light_shows_one_scene_and_says_how_bright() {
        assert_eq!(change(&seen(1, 0.0, 1.0), &seen(1, 0.0, 1.0)), Change::Goes(1.0));
        for light in [0.7, 1.0, 1.3] {
            let Change::Goes(brighter) = change(&seen(1, 0.0, 0.7), &seen(1, 0.2, light * 0.7)) else {
                panic!("no cut in light {light}")
            };
            assert!((brighter / light - 1.0).abs() < 0.02, "{brighter} in light {light}");
        }
    }

    #[test]
    fn another_scene_in_another_water_is_a_cut_and_so_is_another_size() {
        let other = Scene::new(2, SIZE).seen_through(&waters()[3].water).convert();
        assert_eq!(change(&seen(1, 0.0, 1.0), &other), Change::Cut);
        let small = Scene::new(1, Size { width: 7, height: 5 }).clear.convert();
        assert_eq!(change(&seen(1, 0.0, 1.0), &small), Change::Cut);
        assert_eq!(change(&small, &small), Change::Goes(1.0));
    }
}
