use super::*;
use proptest::prelude::*;

/// The definition: collect, sort, take the middle.
fn by_sorting<T: Copy + Ord>(width: usize, height: usize, bytes: &[T]) -> Vec<T> {
    let near = |i: usize, d: usize, length: usize| (i + d).saturating_sub(REACH).min(length - 1);
    let median = |x: usize, y: usize| {
        let mut window: Vec<T> = (0..SIDE)
            .flat_map(|dy| (0..SIDE).map(move |dx| (dx, dy)))
            .map(|(dx, dy)| bytes[near(y, dy, height) * width + near(x, dx, width)])
            .collect();
        window.sort_unstable();
        window[window.len() / 2]
    };
    (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| median(x, y)).collect()
}

/// Numbers below seven that ascend, one a row: how many of the row's last values are one.
fn ascending_windows(rows: &mut Vec<usize>, visit: &mut impl FnMut(&[usize])) {
    if rows.len() == SIDE {
        return visit(rows);
    }
    for ones in rows.last().copied().unwrap_or(0)..=SIDE {
        rows.push(ones);
        ascending_windows(rows, visit);
        rows.pop();
    }
}

#[test]
fn the_selection_is_right_on_every_ascending_window_of_zeros_and_ones() {
    // By the 0-1 principle that makes it right on every window of bytes.
    let mut tried = 0;
    ascending_windows(&mut Vec::new(), &mut |ones| {
        let mut window = [[0_u8; LANES]; SIDE * SIDE];
        for (k, &ones) in ones.iter().enumerate() {
            for j in SIDE - ones..SIDE {
                window[SIDE * k + j] = [1; LANES];
            }
        }
        for (low, high) in SELECT {
            compare(&mut window, low, high);
        }
        let median = u8::from(2 * ones.iter().sum::<usize>() > SIDE * SIDE);
        assert_eq!(window[MEDIAN], [median; LANES], "{ones:?}");
        tried += 1;
    });
    assert_eq!(tried, 3432);
}

#[test]
fn seven_values_are_sorted() {
    for bits in 0..1 << SIDE {
        let mut values: [Lanes<u8>; SIDE] = std::array::from_fn(|k| [(bits >> k & 1) as u8; LANES]);
        for (low, high) in SORT_7 {
            compare(&mut values, low, high);
        }
        assert!(values.is_sorted());
    }
}

proptest! {
    #[test]
    fn the_network_equals_sorting(
        (width, height, bytes) in (1..80_usize, 1..12_usize).prop_flat_map(|(w, h)| {
            (Just(w), Just(h), prop::collection::vec(any::<u8>(), w * h))
        })
    ) {
        prop_assert_eq!(median_7x7(width, height, &bytes), by_sorting(width, height, &bytes));
        let words: Vec<u16> = bytes.iter().rev().zip(&bytes).map(|(&a, &b)| u16::from_be_bytes([a, b])).collect();
        prop_assert_eq!(median_7x7(width, height, &words), by_sorting(width, height, &words));
    }
}
