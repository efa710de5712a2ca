//! The 7x7 median of bytes or 16-bit words as a network of minima and maxima, the same for every pixel.
//!
//! No branch depends on the data, so one run of the network filters many neighbouring pixels at once, and time
//! does not depend on the image. Two rows are filtered together, for their windows share six of seven rows:
//!
//! 1. sort each column of the six common rows, once for all windows that share it;
//! 2. of the 42 values of seven such columns, bring the eight that can still be a median into order
//!    ([`network`]); the others are too many places from the middle for seven more values to reach them;
//! 3. sort the seven values of the row that only one of the two windows has, and take the middle of eight and seven.
//!
//! After A. Adams, "Fast median filters using separable sorting networks" (ACM TOG, 2021), whose sharing of sorted
//! columns this takes over. Borders repeat the outermost pixel, as OpenCV's `medianBlur` does.

#[cfg(all(feature = "simd", target_arch = "x86_64"))]
mod avx2;
#[cfg(all(feature = "simd", any(target_arch = "x86_64", target_arch = "aarch64")))]
mod kernel;
#[cfg(all(feature = "simd", target_arch = "aarch64"))]
mod neon;
mod network;
mod plain;

use crate::bands;
use crate::simd::Level;

/// Side of the window; the paper's choice. Smaller leaves specks in the depth, larger rounds off objects.
const SIDE: usize = 7;
const REACH: usize = SIDE / 2;
/// Rows that two windows, one below the other, have in common, and rows that they have together.
const CORE: usize = SIDE - 1;
const PAIR_ROWS: usize = SIDE + 1;

/// What can be filtered: bytes and 16-bit words.
pub(super) trait Value: Copy + Default + Ord + Send + Sync {
    /// [`plain::pair`] by the instructions of `level`.
    fn pair(
        level: Level,
        rows: &[&[Self]; PAIR_ROWS],
        planes: &mut [Vec<Self>; CORE],
        above: &mut [Self],
        below: &mut [Self],
    );
}

/// Median of the 7x7 neighbourhood of each place of an image of `width` columns, in the memory of `filtered`.
///
/// `fill` gives a row of what is filtered. It is asked for each row once a band, near the time it is needed, so
/// that what is filtered never exists as a whole.
pub(super) fn filter<T: Value>(
    width: usize,
    mut filtered: Vec<T>,
    fill: impl Fn(usize, &mut [T]) + Sync,
) -> Vec<T> {
    filter_by(Level::best(), width, &mut filtered, fill);
    filtered
}

/// Median of the 7x7 neighbourhood of each of `values`.
pub(super) fn filtered<T: Value>(width: usize, values: &[T]) -> Vec<T> {
    filter(width, vec![T::default(); values.len()], |y, row| {
        row.copy_from_slice(&values[y * width..][..width]);
    })
}

fn filter_by<T: Value>(
    level: Level,
    width: usize,
    filtered: &mut [T],
    fill: impl Fn(usize, &mut [T]) + Sync,
) {
    let height = filtered.len() / width;
    bands::for_each(filtered, width, |first, band| filter_band(level, (width, height), first, band, &fill));
}

fn filter_band<T: Value>(
    level: Level,
    (width, height): (usize, usize),
    first: usize,
    band: &mut [T],
    fill: &impl Fn(usize, &mut [T]),
) {
    let whole = width.next_multiple_of(plain::LANES);
    let mut window = Window::new(width, whole);
    let mut planes: [Vec<T>; CORE] = std::array::from_fn(|_| vec![T::default(); whole + plain::LANES]);
    let (mut above, mut below) = (vec![T::default(); whole], vec![T::default(); whole]);
    let mut filled = first.saturating_sub(REACH);
    for (pair, two) in band.chunks_mut(2 * width).enumerate() {
        let y = first + 2 * pair;
        while filled <= (y + REACH + 1).min(height - 1) {
            window.fill(filled, |row| fill(filled, row));
            filled += 1;
        }
        let rows = std::array::from_fn(|k| window.row((y + k).saturating_sub(REACH).min(height - 1)));
        T::pair(level, &rows, &mut planes, &mut above, &mut below);
        for (row, found) in two.chunks_mut(width).zip([&above, &below]) {
            row.copy_from_slice(&found[..width]);
        }
    }
}

/// The last [`PAIR_ROWS`] rows, each with its outermost values repeated: [`REACH`] times before the first, and
/// to whole vectors behind the last.
struct Window<T> {
    width: usize,
    rows: [Vec<T>; PAIR_ROWS],
}

impl<T: Value> Window<T> {
    fn new(width: usize, whole: usize) -> Self {
        Self { width, rows: std::array::from_fn(|_| vec![T::default(); whole + plain::LANES]) }
    }

    fn fill(&mut self, y: usize, fill: impl FnOnce(&mut [T])) {
        let row = &mut self.rows[y % PAIR_ROWS];
        let inside = REACH..REACH + self.width;
        fill(&mut row[inside.clone()]);
        let (first, last) = (row[inside.start], row[inside.end - 1]);
        row[..inside.start].fill(first);
        row[inside.end..].fill(last);
    }

    fn row(&self, y: usize) -> &[T] {
        &self.rows[y % PAIR_ROWS]
    }
}

macro_rules! value {
    ($value:ty, $pair:ident) => {
        impl Value for $value {
            #[inline]
            fn pair(
                level: Level,
                rows: &[&[Self]; PAIR_ROWS],
                planes: &mut [Vec<Self>; CORE],
                above: &mut [Self],
                below: &mut [Self],
            ) {
                match level {
                    Level::Plain => plain::pair(rows, planes, above, below),
                    #[cfg(all(feature = "simd", target_arch = "x86_64"))]
                    Level::Avx2(proof) => avx2::$pair(proof, rows, planes, above, below),
                    #[cfg(all(feature = "simd", target_arch = "aarch64"))]
                    Level::Neon => neon::$pair(rows, planes, above, below),
                }
            }
        }
    };
}

value!(u8, pair_of_bytes);
value!(u16, pair_of_words);

#[cfg(test)]
mod tests;
