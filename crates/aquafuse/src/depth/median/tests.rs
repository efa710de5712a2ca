use super::network::{SELECT, SORT_6, SORT_7, middle_of};
use super::*;
use proptest::prelude::*;

/// The definition: collect, sort, take the middle.
fn by_sorting<T: Value>(width: usize, values: &[T]) -> Vec<T> {
    let height = values.len() / width;
    let near = |i: usize, d: usize, length: usize| (i + d).saturating_sub(REACH).min(length - 1);
    let median = |x: usize, y: usize| {
        let mut window: Vec<T> = (0..SIDE)
            .flat_map(|dy| (0..SIDE).map(move |dx| (dx, dy)))
            .map(|(dx, dy)| values[near(y, dy, height) * width + near(x, dx, width)])
            .collect();
        window.sort_unstable();
        window[window.len() / 2]
    };
    (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| median(x, y)).collect()
}

fn filtered_by<T: Value>(level: Level, width: usize, values: &[T]) -> Vec<T> {
    let mut filtered = vec![T::default(); values.len()];
    filter_by(level, width, &mut filtered, |y, row| row.copy_from_slice(&values[y * width..][..width]));
    filtered
}

/// Values without a pattern.
fn scattered(count: usize) -> Vec<u8> {
    let mut state = 1_u32;
    let next = |_| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 24) as u8
    };
    (0..count).map(next).collect()
}

fn words_of(bytes: &[u8]) -> Vec<u16> {
    bytes.iter().rev().zip(bytes).map(|(&a, &b)| u16::from_be_bytes([a, b])).collect()
}

#[test]
fn the_selection_is_right_on_every_window_of_zeros_and_ones_with_sorted_columns() {
    // By the 0-1 principle that makes it right on every window of bytes. A value here is 64 windows, one a bit;
    // minimum and maximum are then "and" and "or".
    let windows = SIDE.pow(SIDE as u32);
    for first in (0..windows).step_by(64) {
        let (mut core, mut wanted) = ([0_u64; CORE * SIDE], [0_u64; SIDE + 1]);
        for window in first..windows.min(first + 64) {
            let (bit, mut code, mut sum) = (1 << (window - first), window, 0);
            for column in 0..SIDE {
                // Of its six values this many are one: the last.
                let ones = code % SIDE;
                (code, sum) = (code / SIDE, sum + ones);
                (CORE - ones..CORE).for_each(|k| core[SIDE * k + column] |= bit);
            }
            // The eight are those that seven more can bring to place 24 of 49.
            (0..=SIDE).filter(|k| 17 + k >= CORE * SIDE - sum).for_each(|k| wanted[k] |= bit);
        }
        for (low, high) in SELECT {
            (core[low], core[high]) = (core[low] & core[high], core[low] | core[high]);
        }
        assert_eq!(middle_of!(core), wanted);
    }
}

#[test]
fn six_and_seven_values_are_sorted() {
    fn sorts<const N: usize>(network: &[(usize, usize)]) {
        for bits in 0..1 << N {
            let mut values: [plain::Lanes<u8>; N] =
                std::array::from_fn(|k| [(bits >> k & 1) as u8; plain::LANES]);
            plain::run(network, &mut values);
            assert!(values.is_sorted());
        }
    }
    sorts::<6>(&SORT_6);
    sorts::<7>(&SORT_7);
}

#[test]
fn every_instruction_set_gives_the_same_on_odd_sizes() {
    for (width, height) in
        [(1, 1), (1, 9), (9, 1), (2, 2), (7, 7), (6, 8), (33, 65), (64, 64), (65, 129), (257, 131)]
    {
        let bytes = scattered(width * height);
        let words = words_of(&bytes);
        let (of_bytes, of_words) = (by_sorting(width, &bytes), by_sorting(width, &words));
        for level in Level::all() {
            assert_eq!(filtered_by(level, width, &bytes), of_bytes, "{level:?}, bytes of {width}x{height}");
            assert_eq!(filtered_by(level, width, &words), of_words, "{level:?}, words of {width}x{height}");
        }
    }
}

#[cfg(feature = "threads")]
#[test]
fn threads_change_no_bit() {
    let bytes = scattered(520 * 300);
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| filtered_by(Level::best(), 520, &bytes))
    };
    assert_eq!(on(1), on(3));
}

proptest! {
    #[test]
    fn the_network_equals_sorting(
        (width, bytes) in (1..80_usize, 1..12_usize).prop_flat_map(|(width, height)| {
            (Just(width), prop::collection::vec(any::<u8>(), width * height))
        })
    ) {
        let words = words_of(&bytes);
        for level in Level::all() {
            prop_assert_eq!(filtered_by(level, width, &bytes), by_sorting(width, &bytes));
            prop_assert_eq!(filtered_by(level, width, &words), by_sorting(width, &words));
        }
    }
}
