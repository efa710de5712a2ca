//! The 7x7 median of bytes or 16-bit words as a network of minima and maxima, the same for every pixel.
//!
//! No branch depends on the data, so one run of the network filters [`LANES`] neighbouring pixels at once
//! and the compiler turns each comparator into two vector instructions. Three steps:
//!
//! 1. sort each column of seven, once for all windows that share it;
//! 2. in each window, sort the seven k-th values of its columns, for each k: now the 49 values ascend
//!    along rows and columns, and all but 29 of them are too early or too late to be the median;
//! 3. select the median of those by [`SELECT`].
//!
//! After A. Adams, "Fast median filters using separable sorting networks" (ACM TOG, 2021), whose first step this
//! shares. Borders repeat the outermost pixel, as OpenCV's `medianBlur` does.

/// Side of the window; the paper's choice. Smaller leaves specks in the depth, larger rounds off objects.
const SIDE: usize = 7;
const REACH: usize = SIDE / 2;

/// Pixels filtered at once. Fewer than 64 pay more for each comparator's start than for its work; with more
/// the 49 values of a window outgrow the nearest cache of a small processor.
const LANES: usize = 64;
type Lanes<T> = [T; LANES];

/// The best network known for seven values (16 comparators).
const SORT_7: [(usize, usize); 16] = [
    (0, 6),
    (2, 3),
    (4, 5),
    (0, 2),
    (1, 4),
    (3, 6),
    (0, 1),
    (2, 5),
    (3, 4),
    (1, 2),
    (4, 6),
    (2, 3),
    (4, 5),
    (1, 2),
    (3, 4),
    (5, 6),
];

/// Brings the median of a window whose values ascend along rows and columns to [`MEDIAN`]; value k of
/// column j stands at 7k + j. Found by pruning Batcher's merge sort of the 29 candidates in many orders:
/// a comparator goes when none of the 3,432 ascending 0-1 windows needs it. The tests replay them all.
#[rustfmt::skip]
const SELECT: [(usize, usize); 74] = [
    (10, 4), (16, 22), (28, 11), (42, 29), (17, 23), (18, 43), (25, 44), (10, 16), (4, 22), (42, 6),
    (29, 13), (4, 16), (11, 30), (29, 6), (43, 25), (10, 28), (35, 5), (36, 12), (37, 19), (38, 20),
    (42, 17), (29, 23), (6, 24), (13, 31), (16, 28), (22, 11), (37, 5), (38, 12), (6, 17), (13, 23),
    (25, 26), (22, 28), (36, 37), (38, 5), (12, 19), (29, 6), (13, 17), (23, 24), (32, 20), (28, 35),
    (11, 36), (30, 37), (32, 38), (17, 18), (23, 43), (24, 25), (30, 35), (32, 36), (37, 5), (38, 12),
    (6, 17), (13, 23), (24, 18), (32, 35), (36, 37), (38, 5), (12, 19), (29, 6), (13, 17), (23, 24),
    (35, 42), (36, 29), (37, 6), (38, 13), (5, 17), (12, 23), (19, 24), (32, 38), (5, 42), (12, 29),
    (19, 6), (38, 12), (19, 42), (12, 19),
];
const MEDIAN: usize = 19;

/// Median of the 7x7 neighbourhood of each of `width * height` values.
pub(super) fn median_7x7<T: Copy + Default + Ord>(width: usize, height: usize, values: &[T]) -> Vec<T> {
    let mut filtered = Vec::with_capacity(values.len());
    let mut columns = SortedColumns::new(width);
    let mut window = [[T::default(); LANES]; SIDE * SIDE];
    for y in 0..height {
        columns.sort_around(y, height, values);
        for x in (0..width).step_by(LANES) {
            columns.gather(x, &mut window);
            select_median(&mut window);
            filtered.extend_from_slice(&window[MEDIAN][..LANES.min(width - x)]);
        }
    }
    filtered
}

/// The columns of seven around one row, sorted: plane k holds every column's k-th smallest value.
struct SortedColumns<T> {
    width: usize,
    /// Each plane begins [`REACH`] places before column 0 and is long enough for whole lanes.
    planes: [Vec<T>; SIDE],
}

impl<T: Copy + Default + Ord> SortedColumns<T> {
    fn new(width: usize) -> Self {
        let length = width.next_multiple_of(LANES) + 2 * REACH;
        Self { width, planes: std::array::from_fn(|_| vec![T::default(); length]) }
    }

    fn sort_around(&mut self, y: usize, height: usize, all: &[T]) {
        let width = self.width;
        let rows: [&[T]; SIDE] = std::array::from_fn(|k| {
            let row = (y + k).saturating_sub(REACH).min(height - 1);
            &all[row * width..][..width]
        });
        for x in (0..width).step_by(LANES) {
            let mut values: [Lanes<T>; SIDE] = std::array::from_fn(|k| load(rows[k], x));
            for (low, high) in SORT_7 {
                compare(&mut values, low, high);
            }
            for (plane, sorted) in self.planes.iter_mut().zip(&values) {
                plane[REACH + x..][..LANES].copy_from_slice(sorted);
            }
        }
        for plane in &mut self.planes {
            let (first, last) = (plane[REACH], plane[REACH + width - 1]);
            plane[..REACH].fill(first);
            plane[REACH + width..].fill(last);
        }
    }

    /// The windows centred at `x` and the lanes after it: value k of column j at 7k + j.
    fn gather(&self, x: usize, window: &mut [Lanes<T>; SIDE * SIDE]) {
        for (row, plane) in window.chunks_exact_mut(SIDE).zip(&self.planes) {
            for (j, values) in row.iter_mut().enumerate() {
                values.copy_from_slice(&plane[x + j..][..LANES]);
            }
        }
    }
}

/// Brings the median of windows with sorted columns to [`MEDIAN`].
fn select_median<T: Copy + Ord>(window: &mut [Lanes<T>; SIDE * SIDE]) {
    for row in window.chunks_exact_mut(SIDE) {
        for (low, high) in SORT_7 {
            compare(row, low, high);
        }
    }
    for (low, high) in SELECT {
        compare(window, low, high);
    }
}

/// The lanes from `x` on; past the end of `values` they hold nothing that is kept.
#[inline(always)]
fn load<T: Copy + Default>(values: &[T], x: usize) -> Lanes<T> {
    let mut lanes = [T::default(); LANES];
    let rest = &values[x..];
    match rest.first_chunk() {
        Some(whole) => lanes = *whole,
        None => lanes[..rest.len()].copy_from_slice(rest),
    }
    lanes
}

/// Puts the smaller of two values at `low` and the larger at `high`, lane by lane.
///
/// A loop over two slices known not to overlap: this form, and not one over copies, becomes vector code.
#[inline(always)]
fn compare<T: Copy + Ord>(values: &mut [Lanes<T>], low: usize, high: usize) {
    let Ok([low, high]) = values.get_disjoint_mut([low, high]) else {
        unreachable!("a comparator joins two different values")
    };
    for (a, b) in low.iter_mut().zip(high) {
        (*a, *b) = ((*a).min(*b), (*a).max(*b));
    }
}

#[cfg(test)]
mod tests;
