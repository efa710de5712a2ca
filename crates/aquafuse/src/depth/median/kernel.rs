//! The network of [`super`] on vectors: one function for each kind of vector and value.

/// Runs comparators given as pairs of places on an array of vectors. Straight code: the places are known where it
/// is compiled, and so the compiler keeps the values in registers as far as there are any.
macro_rules! comparators {
    ($values:ident, $min:ident, $max:ident; $(($low:literal, $high:literal))*) => {
        $({
            let (a, b) = ($values[$low], $values[$high]);
            $values[$low] = $min(a, b);
            $values[$high] = $max(a, b);
        })*
    };
}

/// A function `$name` as [`super::plain::pair`], for the vectors of one instruction set.
macro_rules! pair_kernel {
    (
        $(#[$attribute:meta])*
        fn $name:ident(values: $value:ty, lanes: $lanes:literal, load: $load:ident, store: $store:ident,
        min: $min:ident, max: $max:ident)
    ) => {
        $(#[$attribute])*
        fn $name(
            rows: &[&[$value]; PAIR_ROWS],
            planes: &mut [Vec<$value>; CORE],
            above: &mut [$value],
            below: &mut [$value],
        ) {
            for x in (0..above.len() + SIDE - 1).step_by($lanes) {
                let mut values = [
                    $load(rows[1], x),
                    $load(rows[2], x),
                    $load(rows[3], x),
                    $load(rows[4], x),
                    $load(rows[5], x),
                    $load(rows[6], x),
                ];
                sort_6!(comparators, values, $min, $max);
                for k in 0..CORE {
                    $store(&mut planes[k], x, values[k]);
                }
            }
            for x in (0..above.len()).step_by($lanes) {
                let mut core = [$load(&planes[0], x); CORE * SIDE];
                for k in 0..CORE {
                    // Cut out once, so that what is loaded is known to be there.
                    let near = &planes[k][x..x + $lanes + SIDE - 1];
                    for j in 0..SIDE {
                        core[SIDE * k + j] = $load(near, j);
                    }
                }
                select!(comparators, core, $min, $max);
                let middle = middle_of!(core);
                for (row, out) in [(rows[0], &mut *above), (rows[PAIR_ROWS - 1], &mut *below)] {
                    let near = &row[x..x + $lanes + SIDE - 1];
                    let mut ends = [$load(near, 0); SIDE];
                    for j in 1..SIDE {
                        ends[j] = $load(near, j);
                    }
                    sort_7!(comparators, ends, $min, $max);
                    // The eighth of fifteen, of which eight and seven are sorted.
                    let mut median = middle[SIDE];
                    for k in 0..SIDE {
                        median = $min(median, $max(middle[k], ends[SIDE - 1 - k]));
                    }
                    $store(out, x, median);
                }
            }
        }
    };
}

pub(super) use {comparators, pair_kernel};
