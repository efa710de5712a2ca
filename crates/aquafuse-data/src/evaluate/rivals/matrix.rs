//! Symmetric matrices of 3 x 3, and their roots.

pub(super) type Matrix = [[f64; 3]; 3];

/// An eigenvalue smaller than this share of the largest is a direction in which nothing varies: roots of what varies less
/// would be roots of rounding.
const NOTHING: f64 = 1e-8;
/// Jacobi's method ends with all digits after five or six rounds.
const ROUNDS: usize = 12;

pub(super) fn product(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

/// The square root of a matrix without negative eigenvalues.
pub(super) fn root(of: &Matrix) -> Matrix {
    let (values, vectors) = eigen(of);
    composed(values.map(|value| value.max(0.0).sqrt()), &vectors)
}

/// The square root and its inverse, both nothing in directions in which nothing varies, and what takes from a colour its
/// part in those.
pub(super) fn root_and_inverse(of: &Matrix) -> (Matrix, Matrix, Matrix) {
    let (values, vectors) = eigen(of);
    let least = NOTHING * values.into_iter().fold(0.0, f64::max);
    let kept = values.map(|value| if value > least { value.sqrt() } else { 0.0 });
    let inverse = kept.map(|value| if value > 0.0 { 1.0 / value } else { 0.0 });
    let still = kept.map(|value| if value > 0.0 { 0.0 } else { 1.0 });
    (composed(kept, &vectors), composed(inverse, &vectors), composed(still, &vectors))
}

/// The matrix of these eigenvalues and eigenvectors (columns).
fn composed(values: [f64; 3], vectors: &Matrix) -> Matrix {
    let element = |i: usize, j: usize| (0..3).map(|k| vectors[i][k] * values[k] * vectors[j][k]).sum();
    std::array::from_fn(|i| std::array::from_fn(|j| element(i, j)))
}

/// Eigenvalues and eigenvectors (columns) of a symmetric matrix, by Jacobi's rotations.
fn eigen(of: &Matrix) -> ([f64; 3], Matrix) {
    let (mut left, mut vectors) = (*of, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    for (p, q) in [(0, 1), (0, 2), (1, 2)].into_iter().cycle().take(3 * ROUNDS) {
        if left[p][q] == 0.0 {
            continue;
        }
        let slope = (left[q][q] - left[p][p]) / (2.0 * left[p][q]);
        let tangent = slope.signum() / (slope.abs() + slope.hypot(1.0));
        let cosine = 1.0 / tangent.hypot(1.0);
        let mut turn = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        (turn[p][p], turn[q][q]) = (cosine, cosine);
        (turn[p][q], turn[q][p]) = (tangent * cosine, -tangent * cosine);
        let back: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| turn[j][i]));
        left = product(&product(&back, &left), &turn);
        vectors = product(&vectors, &turn);
    }
    ([left[0][0], left[1][1], left[2][2]], vectors)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_root_times_itself_is_the_matrix(entries in prop::array::uniform9(-1.0..1.0_f64)) {
            let any: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| entries[3 * i + j]));
            let transposed: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| any[j][i]));
            let matrix = product(&any, &transposed);
            let (half, inverse, still) = root_and_inverse(&matrix);
            let (squared, same) = (product(&half, &half), product(&half, &inverse));
            for i in 0..3 {
                for j in 0..3 {
                    prop_assert!((squared[i][j] - matrix[i][j]).abs() < 1e-7, "{squared:?} is not {matrix:?}");
                    prop_assert!((root(&matrix)[i][j] - half[i][j]).abs() < 1e-3);
                    let one = if i == j { 1.0 } else { 0.0 };
                    prop_assert!((same[i][j] + still[i][j] - one).abs() < 1e-9);
                }
            }
        }
    }
}
