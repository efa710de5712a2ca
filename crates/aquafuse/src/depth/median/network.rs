//! The comparators, each a pair of places: the smaller value comes to the first, the larger to the second.
//!
//! They are macros, so that one list serves as a table and as straight code.

/// The best network known for six values.
macro_rules! sort_6 {
    ($apply:ident $(, $given:ident)*) => {
        $apply! { $($given),*;
            (0, 5) (1, 3) (2, 4) (1, 2) (3, 4) (0, 3) (2, 5) (0, 1) (2, 3) (4, 5) (1, 2) (3, 4)
        }
    };
}

/// The best network known for seven values.
macro_rules! sort_7 {
    ($apply:ident $(, $given:ident)*) => {
        $apply! { $($given),*;
            (0, 6) (2, 3) (4, 5) (0, 2) (1, 4) (3, 6) (0, 1) (2, 5) (3, 4) (1, 2) (4, 6) (2, 3) (4, 5)
            (1, 2) (3, 4) (5, 6)
        }
    };
}

/// Brings ranks 17 to 24 of 42 values, counted from 0, to the places of [`middle_of`]. Value k of column j stands at
/// 7k + j, and the columns are sorted.
///
/// Found by sorting rows and merging them by odd and even places in many orders, and leaving out of each what none
/// of the 7^7 windows of sorted columns of 0 and 1 needs. The tests replay them all.
macro_rules! select {
    ($apply:ident $(, $given:ident)*) => {
        $apply! { $($given),*;
            (0, 6) (2, 3) (4, 5) (0, 2) (1, 4) (3, 6) (0, 1) (2, 5) (3, 4) (1, 2) (4, 6) (2, 3) (4, 5)
            (3, 4) (5, 6) (7, 13) (9, 10) (11, 12) (7, 9) (8, 11) (10, 13) (7, 8) (9, 12) (10, 11) (8, 9)
            (11, 13) (9, 10) (11, 12) (8, 9) (10, 11) (12, 13) (14, 20) (16, 17) (18, 19) (14, 16) (15, 18)
            (17, 20) (14, 15) (16, 19) (17, 18) (15, 16) (18, 20) (16, 17) (18, 19) (15, 16) (17, 18)
            (19, 20) (21, 27) (23, 24) (25, 26) (21, 23) (22, 25) (24, 27) (21, 22) (23, 26) (24, 25)
            (22, 23) (25, 27) (23, 24) (25, 26) (22, 23) (24, 25) (26, 27) (28, 34) (30, 31) (32, 33)
            (28, 30) (29, 32) (31, 34) (28, 29) (30, 33) (31, 32) (29, 30) (32, 34) (30, 31) (32, 33)
            (29, 30) (31, 32) (35, 41) (37, 38) (39, 40) (35, 37) (36, 39) (38, 41) (35, 36) (37, 40)
            (38, 39) (36, 37) (39, 41) (37, 38) (39, 40) (36, 37) (38, 39) (11, 21) (13, 23) (13, 21)
            (23, 25) (12, 22) (10, 12) (24, 22) (12, 13) (24, 21) (22, 23) (4, 14) (6, 16) (6, 14) (16, 18)
            (5, 15) (3, 5) (17, 15) (5, 6) (17, 14) (15, 16) (19, 18) (14, 28) (18, 32) (18, 28) (16, 30)
            (6, 16) (34, 30) (16, 18) (34, 28) (15, 29) (20, 29) (19, 31) (17, 15) (19, 20) (31, 29)
            (15, 16) (19, 18) (20, 34) (31, 28) (21, 35) (25, 35) (23, 37) (13, 23) (13, 21) (23, 25)
            (22, 36) (12, 22) (24, 22) (38, 36) (12, 13) (24, 21) (22, 23) (26, 25) (32, 11) (18, 32)
            (32, 21) (30, 9) (16, 30) (34, 13) (34, 30) (13, 23) (30, 32) (13, 21) (29, 8) (15, 29)
            (20, 12) (20, 29) (12, 22) (33, 10) (19, 33) (31, 38) (31, 24) (31, 33) (24, 26) (31, 29)
            (33, 12) (24, 22) (29, 30) (33, 32) (12, 13) (24, 21)
        }
    };
}

/// The eight values that [`select`] has brought into order.
macro_rules! middle_of {
    ($core:ident) => {
        [$core[29], $core[30], $core[33], $core[32], $core[12], $core[13], $core[24], $core[21]]
    };
}

macro_rules! table {
    (; $(($low:literal, $high:literal))*) => { [$(($low, $high)),*] };
}

pub(super) const SORT_6: [(usize, usize); 12] = sort_6!(table);
pub(super) const SORT_7: [(usize, usize); 16] = sort_7!(table);
pub(super) const SELECT: [(usize, usize); 174] = select!(table);

pub(super) use middle_of;
#[cfg(all(feature = "simd", any(target_arch = "x86_64", target_arch = "aarch64")))]
pub(super) use {select, sort_6, sort_7};
