//! Spherical harmonics up to degree 3, and how they change with the direction.

use crate::scalar::Scalar;
use crate::splats::FLAT;

/// The most there are.
pub(crate) const MOST: usize = 16;

const FIRST: f64 = 0.488_602_511_902_919_9;
const SECOND: [f64; 3] = [1.092_548_430_592_079_2, 0.315_391_565_252_520_05, 0.546_274_215_296_039_6];
const THIRD: [f64; 5] = [
    0.590_043_589_926_643_5,
    2.890_611_442_640_554,
    0.457_045_799_464_465_8,
    0.373_176_332_590_115_4,
    1.445_305_721_320_277,
];

/// The harmonics of a unit direction, in the order and with the signs of the published scenes; zeros beyond `degree`.
#[inline]
pub(crate) fn basis<T: Scalar>(degree: u8, [x, y, z]: [T; 3]) -> [T; MOST] {
    let k = T::of;
    let mut basis = [T::ZERO; MOST];
    basis[0] = k(FLAT);
    if degree >= 1 {
        basis[1] = -k(FIRST) * y;
        basis[2] = k(FIRST) * z;
        basis[3] = -k(FIRST) * x;
    }
    let (xx, yy, zz) = (x * x, y * y, z * z);
    if degree >= 2 {
        basis[4] = k(SECOND[0]) * x * y;
        basis[5] = -k(SECOND[0]) * y * z;
        basis[6] = k(SECOND[1]) * (zz + zz - xx - yy);
        basis[7] = -k(SECOND[0]) * x * z;
        basis[8] = k(SECOND[2]) * (xx - yy);
    }
    if degree >= 3 {
        basis[9] = -k(THIRD[0]) * y * (k(3.0) * xx - yy);
        basis[10] = k(THIRD[1]) * x * y * z;
        basis[11] = -k(THIRD[2]) * y * (k(4.0) * zz - xx - yy);
        basis[12] = k(THIRD[3]) * z * (k(2.0) * zz - k(3.0) * xx - k(3.0) * yy);
        basis[13] = -k(THIRD[2]) * x * (k(4.0) * zz - xx - yy);
        basis[14] = k(THIRD[4]) * z * (xx - yy);
        basis[15] = -k(THIRD[0]) * x * (xx - k(3.0) * yy);
    }
    basis
}

/// How each harmonic changes with x, y and z, the direction taken as three free numbers.
#[inline]
pub(crate) fn slopes<T: Scalar>(degree: u8, [x, y, z]: [T; 3]) -> [[T; 3]; MOST] {
    let k = T::of;
    let o = T::ZERO;
    let mut slopes = [[o; 3]; MOST];
    if degree >= 1 {
        slopes[1] = [o, -k(FIRST), o];
        slopes[2] = [o, o, k(FIRST)];
        slopes[3] = [-k(FIRST), o, o];
    }
    if degree >= 2 {
        let [a, b, c] = SECOND.map(k);
        let two = k(2.0);
        slopes[4] = [a * y, a * x, o];
        slopes[5] = [o, -a * z, -a * y];
        slopes[6] = [-two * b * x, -two * b * y, k(4.0) * b * z];
        slopes[7] = [-a * z, o, -a * x];
        slopes[8] = [two * c * x, -two * c * y, o];
    }
    if degree >= 3 {
        let [a, b, c, d, e] = THIRD.map(k);
        let (xx, yy, zz) = (x * x, y * y, z * z);
        let (two, three, six, eight) = (k(2.0), k(3.0), k(6.0), k(8.0));
        slopes[9] = [-six * a * x * y, -three * a * (xx - yy), o];
        slopes[10] = [b * y * z, b * x * z, b * x * y];
        slopes[11] = [two * c * x * y, -c * (k(4.0) * zz - xx - three * yy), -eight * c * y * z];
        slopes[12] = [-six * d * x * z, -six * d * y * z, three * d * (two * zz - xx - yy)];
        slopes[13] = [-c * (k(4.0) * zz - three * xx - yy), two * c * x * y, -eight * c * x * z];
        slopes[14] = [two * e * x * z, -two * e * y * z, e * (xx - yy)];
        slopes[15] = [-three * a * (xx - yy), six * a * x * y, o];
    }
    slopes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_are_those_of_the_harmonics() {
        let at = [0.36, -0.48, 0.8];
        let slopes = slopes(3, at);
        for axis in 0..3 {
            let moved = |by: f64| {
                let mut direction = at;
                direction[axis] += by;
                basis(3, direction)
            };
            let (above, below) = (moved(1e-5), moved(-1e-5));
            for k in 0..MOST {
                let slope = (above[k] - below[k]) / 2e-5;
                assert!((slope - slopes[k][axis]).abs() < 1e-8, "harmonic {k}, axis {axis}");
            }
        }
    }

    #[test]
    fn harmonics_are_orthonormal() {
        // Gauss-Legendre in z (five points: exact to degree nine) times sixteen even steps around.
        let nodes = [0.0_f64, 0.538_469_310_105_683, 0.906_179_845_938_664];
        let weights = [0.568_888_888_888_889, 0.478_628_670_499_366, 0.236_926_885_056_189];
        let mut products = [[0.0; MOST]; MOST];
        for (node, weight) in nodes.into_iter().zip(weights) {
            for z in if node == 0.0 { vec![0.0] } else { vec![node, -node] } {
                for step in 0..16_u8 {
                    let angle = std::f64::consts::TAU * f64::from(step) / 16.0;
                    let across = (1.0 - z * z).sqrt();
                    let b = basis(3, [across * angle.cos(), across * angle.sin(), z]);
                    for i in 0..MOST {
                        for j in 0..MOST {
                            products[i][j] += weight * std::f64::consts::TAU / 16.0 * b[i] * b[j];
                        }
                    }
                }
            }
        }
        for i in 0..MOST {
            for j in 0..MOST {
                let expected = if i == j { 1.0 } else { 0.0 };
                assert!((products[i][j] - expected).abs() < 1e-12, "{i} {j}: {}", products[i][j]);
            }
        }
    }
}
