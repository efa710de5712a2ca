//! The median of many values at once without special instructions: what the others are tested against.

use super::network::{SELECT, SORT_6, SORT_7, middle_of};
use super::{CORE, PAIR_ROWS, SIDE};

/// Values filtered at once. Fewer than 64 pay more for each comparator's start than for its work; with more
/// the values of a window outgrow the nearest cache of a small processor.
pub(super) const LANES: usize = 64;
pub(super) type Lanes<T> = [T; LANES];

/// Filters the two rows between `rows[3]` and `rows[4]`, of which the first sees rows 0 to 6, the second 1 to 7.
///
/// The rows begin [`super::REACH`] places before the first column. `planes` is scratch as long as they are.
pub(super) fn pair<T: Copy + Default + Ord>(
    rows: &[&[T]; PAIR_ROWS],
    planes: &mut [Vec<T>; CORE],
    above: &mut [T],
    below: &mut [T],
) {
    for x in (0..above.len() + SIDE - 1).step_by(LANES) {
        let mut values: [Lanes<T>; CORE] = std::array::from_fn(|k| load(rows[k + 1], x));
        run(&SORT_6, &mut values);
        for (plane, sorted) in planes.iter_mut().zip(&values) {
            plane[x..][..LANES].copy_from_slice(sorted);
        }
    }
    let mut core = [[T::default(); LANES]; CORE * SIDE];
    for x in (0..above.len()).step_by(LANES) {
        for (k, plane) in planes.iter().enumerate() {
            for j in 0..SIDE {
                core[SIDE * k + j] = load(plane, x + j);
            }
        }
        run(&SELECT, &mut core);
        let middle = middle_of!(core);
        for (row, out) in [(rows[0], &mut *above), (rows[PAIR_ROWS - 1], &mut *below)] {
            let mut ends: [Lanes<T>; SIDE] = std::array::from_fn(|j| load(row, x + j));
            run(&SORT_7, &mut ends);
            for (lane, median) in out[x..][..LANES].iter_mut().enumerate() {
                // The eighth of fifteen, of which eight and seven are sorted.
                let larger = (0..SIDE).map(|k| middle[k][lane].max(ends[SIDE - 1 - k][lane]));
                *median = larger.fold(middle[SIDE][lane], T::min);
            }
        }
    }
}

/// The values from `x` on.
#[inline(always)]
fn load<T: Copy>(values: &[T], x: usize) -> Lanes<T> {
    *values[x..].first_chunk().expect("rows are long enough for whole lanes")
}

/// Puts the smaller of two values at the first place of each comparator and the larger at the second, lane by lane.
///
/// A loop over two slices known not to overlap: this form, and not one over copies, becomes vector code.
#[inline(always)]
pub(super) fn run<T: Copy + Ord>(comparators: &[(usize, usize)], values: &mut [Lanes<T>]) {
    for &(low, high) in comparators {
        let Ok([low, high]) = values.get_disjoint_mut([low, high]) else {
            unreachable!("a comparator joins two different values")
        };
        for (a, b) in low.iter_mut().zip(high) {
            (*a, *b) = ((*a).min(*b), (*a).max(*b));
        }
    }
}
