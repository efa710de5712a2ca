//! The small image that the network sees, its top edge up, and maps turned back.

use crate::image::{ImageRef, TopEdge};
use crate::simd::{self, Work};

/// About as many pixels as the network sees, of the image's proportions, in steps of sides that can be halved four times.
const AREA: f64 = 128.0 * 96.0;
const STEP: usize = 16;
/// Steps along a side at least and at most: of a narrower strip it sees a distorted image.
const STEPS: [f64; 2] = [4.0, 12.0];
/// Rows of the image that are read for a row of what the network sees.
const ROWS: usize = 4;

/// Red, green and blue in `[0, 1]`, row by row.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Small {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) pixels: Vec<[f32; 3]>,
}

impl Small {
    /// Of an image whose edge `top` is up.
    pub(super) fn of(image: ImageRef<'_, u8>, top: TopEdge) -> Self {
        let (width, height) = size(image.size());
        let mut pixels = Vec::with_capacity(width * height);
        for y in 0..height {
            pixels.extend(row(image, y, (width, height)));
        }
        let upright = Turn { width, height, top };
        let (width, height) = upright.size();
        Self { width, height, pixels: upright.turned(&pixels) }
    }

    /// The same from right to left.
    pub(super) fn mirrored(&self) -> Self {
        let rows = self.pixels.chunks_exact(self.width);
        Self { pixels: rows.flat_map(|row| row.iter().rev().copied()).collect(), ..*self }
    }
}

/// Columns and rows of what the network sees of an image of this size.
pub(super) fn size((width, height): (usize, usize)) -> (usize, usize) {
    let steps = |wanted: f64| wanted.round().clamp(STEPS[0], STEPS[1]);
    let step = STEP as f64;
    let columns = steps((AREA * width as f64 / height as f64).sqrt() / step);
    let rows = steps(AREA / (step * step) / columns);
    (columns as usize * STEP, rows as usize * STEP)
}

/// The means of a row of rectangles of the image. Sums are of whole numbers, so that an image and its mirror image agree.
fn row(image: ImageRef<'_, u8>, y: usize, (columns, rows): (usize, usize)) -> Vec<[f32; 3]> {
    let (width, height) = image.size();
    let from = y * height / rows;
    let to = ((y + 1) * height).div_ceil(rows).max(from + 1);
    let step = ((to - from) / ROWS).max(1);
    let mut down = vec![0_u32; 3 * width];
    let mut weight = 0;
    for source in (from + (step - 1) / 2..to).step_by(step) {
        // Rows at the border of two rectangles count in both, each by its part.
        let part = ((source + 1) * rows).min((y + 1) * height) - (source * rows).max(y * height);
        weight += part as u64;
        let values = image.row(source).as_flattened();
        simd::widest(AddRow { sums: &mut down, values, part: part as u32 });
    }
    let down = down.as_chunks::<3>().0;
    let scale = 1.0 / (255.0 * weight as f64 * width as f64);
    let mean = |x: usize| {
        let (first, last) = (x * width / columns, ((x + 1) * width).div_ceil(columns));
        let part =
            |column: usize| ((column + 1) * columns).min((x + 1) * width) - (column * columns).max(x * width);
        let mut sums = [0_u64; 3];
        for inner in &down[first + 1..last.max(first + 2) - 1] {
            (0..3).for_each(|c| sums[c] += u64::from(inner[c]));
        }
        let ends = [first, last - 1];
        let mut sums = sums.map(|sum| sum * columns as u64);
        for &end in &ends[..if last - first > 1 { 2 } else { 1 }] {
            (0..3).for_each(|c| sums[c] += part(end) as u64 * u64::from(down[end][c]));
        }
        sums.map(|sum| (sum as f64 * scale) as f32)
    };
    (0..columns).map(mean).collect()
}

/// Adds a part of each value of a row.
struct AddRow<'a> {
    sums: &'a mut [u32],
    values: &'a [u8],
    part: u32,
}

impl Work for AddRow<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        for (sum, value) in self.sums.iter_mut().zip(self.values) {
            *sum += self.part * u32::from(*value);
        }
    }
}

/// How rows of values of an image are turned until its top edge is the first row.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turn {
    /// Columns and rows as stored.
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) top: TopEdge,
}

impl Turn {
    /// Columns and rows once it is upright.
    pub(super) fn size(self) -> (usize, usize) {
        match self.top {
            TopEdge::First | TopEdge::Last => (self.width, self.height),
            TopEdge::Left | TopEdge::Right => (self.height, self.width),
        }
    }

    /// Where the value at column `x`, row `y` of the stored image is once it is upright.
    fn place(self, x: usize, y: usize) -> usize {
        let (right, bottom) = (self.width - 1, self.height - 1);
        let (column, row) = match self.top {
            TopEdge::First => (x, y),
            TopEdge::Last => (right - x, bottom - y),
            TopEdge::Left => (bottom - y, x),
            TopEdge::Right => (y, right - x),
        };
        row * self.size().0 + column
    }

    fn stored(self) -> impl Iterator<Item = (usize, usize)> {
        (0..self.height).flat_map(move |y| (0..self.width).map(move |x| (x, y)))
    }

    /// Stored values, upright.
    pub(super) fn turned<T: Copy + Default>(self, values: &[T]) -> Vec<T> {
        let mut turned = vec![T::default(); values.len()];
        for (value, (x, y)) in values.iter().zip(self.stored()) {
            turned[self.place(x, y)] = *value;
        }
        turned
    }

    /// Upright values, as stored.
    pub(super) fn back<T: Copy>(self, values: &[T]) -> Vec<T> {
        self.stored().map(|(x, y)| values[self.place(x, y)]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Image;
    use proptest::prelude::*;

    fn image(width: usize, height: usize) -> Image<u8> {
        let bytes = (0..3 * width * height).map(|i| (i * 37 % 251) as u8).collect();
        Image::from_raw(width, height, bytes).unwrap()
    }

    proptest! {
        #[test]
        fn sides_can_be_halved_and_the_work_is_bounded(width in 1..9000_usize, height in 1..9000_usize) {
            let (columns, rows) = size((width, height));
            prop_assert!(columns.is_multiple_of(STEP) && rows.is_multiple_of(STEP));
            prop_assert!((columns * rows) as f64 <= 1.2 * AREA, "{} x {}", columns, rows);
        }

        #[test]
        fn the_mirror_image_gives_the_mirrored_input(width in 1..300_usize, height in 1..120_usize) {
            let image = image(width, height);
            let pixels = image.pixels().chunks(width).flat_map(|row| row.iter().rev().copied());
            let mirror = Image::from_raw(width, height, pixels.flatten().collect()).unwrap();
            let own = Small::of(image.view(), TopEdge::First);
            prop_assert_eq!(Small::of(mirror.view(), TopEdge::First), own.mirrored());
        }

        #[test]
        fn means_stay_within_the_colours(width in 1..300_usize, height in 1..300_usize, grey in 0..=255_u8) {
            let image = Image::from_raw(width, height, vec![grey; 3 * width * height]).unwrap();
            let small = Small::of(image.view(), TopEdge::First);
            let wanted = f32::from(grey) / 255.0;
            prop_assert!(small.pixels.iter().flatten().all(|value| (value - wanted).abs() < 1e-6));
        }
    }

    #[test]
    fn what_is_turned_upright_is_turned_back() {
        // 1 2 3
        // 4 5 6
        let values = [1, 2, 3, 4, 5, 6];
        let cases = [
            (TopEdge::First, [1, 2, 3, 4, 5, 6]),
            (TopEdge::Last, [6, 5, 4, 3, 2, 1]),
            // The left edge, from below, becomes the first row.
            (TopEdge::Left, [4, 1, 5, 2, 6, 3]),
            (TopEdge::Right, [3, 6, 2, 5, 1, 4]),
        ];
        for (top, upright) in cases {
            let turn = Turn { width: 3, height: 2, top };
            assert_eq!(turn.turned(&values), upright, "{top:?}");
            assert_eq!(turn.back(&upright), values, "{top:?}");
        }
    }
}
