//! a and b of the types nobody measured: Solonenko and Mobley 2015, Tables 4 to 8.
//!
//! The authors found them from Jerlov's K_d. Of these types every row of theirs is sound; the rows they print
//! twice are of 3C and 5C.

use super::{Curve, Optics};

const SOURCE: &str = "Solonenko and Mobley 2015, Tables 4 to 8";

/// A column of the tables: 400 to 700 nm, per metre.
const fn column(values: &'static [f64]) -> Curve {
    Curve { from: 400.0, step: 25.0, values, source: SOURCE }
}

#[rustfmt::skip]
pub(super) static I: Optics = Optics {
    absorption: column(&[
        0.022, 0.017, 0.018, 0.019, 0.026, 0.046, 0.062, 0.082, 0.228, 0.295, 0.334, 0.434, 0.582,
    ]),
    scattering: column(&[
        0.0062, 0.00482, 0.00381, 0.00306, 0.00249, 0.00205, 0.0017, 0.00143, 0.00122, 0.00104, 0.000899,
        0.000782, 0.000685,
    ]),
};

#[rustfmt::skip]
pub(super) static IA: Optics = Optics {
    absorption: column(&[
        0.0295, 0.0225, 0.0221, 0.0216, 0.0282, 0.0468, 0.0622, 0.0821, 0.228, 0.295, 0.334, 0.435, 0.582,
    ]),
    scattering: column(&[
        0.0092, 0.00755, 0.00631, 0.00536, 0.00461, 0.00402, 0.00354, 0.00315, 0.00283, 0.00256, 0.00234,
        0.00214, 0.00198,
    ]),
};

#[rustfmt::skip]
pub(super) static COASTAL_7C: Optics = Optics {
    absorption: column(&[
        1.03, 0.753, 0.542, 0.388, 0.29, 0.233, 0.195, 0.175, 0.301, 0.367, 0.403, 0.559, 0.621,
    ]),
    scattering: column(&[
        4.02, 3.63, 3.3, 3.01, 2.76, 2.54, 2.35, 2.18, 2.03, 1.89, 1.77, 1.66, 1.56,
    ]),
};

#[rustfmt::skip]
pub(super) static COASTAL_9C: Optics = Optics {
    absorption: column(&[
        1.613, 1.242, 0.943, 0.709, 0.543, 0.43, 0.348, 0.291, 0.39, 0.436, 0.456, 0.604, 0.651,
    ]),
    scattering: column(&[
        5.36, 4.84, 4.39, 4.01, 3.67, 3.38, 3.12, 2.89, 2.69, 2.51, 2.35, 2.2, 2.07,
    ]),
};
