//! Monge–Kantorovich: of all linear maps that take mean and covariance to the reference's, that of least effort.

use aquafuse::image::Image;

use super::matrix::{Matrix, product, root, root_and_inverse};
use super::unit;

/// Mean and covariance of RGB.
#[derive(Clone, Debug)]
pub(super) struct Moments {
    pub(super) mean: [f64; 3],
    pub(super) covariance: Matrix,
}

impl Moments {
    pub(super) fn of(image: &Image<u8>) -> Self {
        let count = image.pixels().len() as f64;
        let mut sum = [0.0; 3];
        for rgb in image.pixels().iter().map(unit) {
            (0..3).for_each(|c| sum[c] += rgb[c]);
        }
        let mean = sum.map(|sum| sum / count);
        let mut covariance = [[0.0; 3]; 3];
        for rgb in image.pixels().iter().map(unit) {
            for i in 0..3 {
                (0..3).for_each(|j| covariance[i][j] += (rgb[i] - mean[i]) * (rgb[j] - mean[j]) / count);
            }
        }
        Self { mean, covariance }
    }
}

pub(super) fn transfer(content: &Image<u8>, own: &Moments, other: &Moments) -> Vec<[f32; 3]> {
    let map = map(&own.covariance, &other.covariance);
    let changed = |pixel: &[u8; 3]| {
        let rgb = unit(pixel);
        let off: [f64; 3] = std::array::from_fn(|c| rgb[c] - own.mean[c]);
        std::array::from_fn(|i| (other.mean[i] + (0..3).map(|j| map[i][j] * off[j]).sum::<f64>()) as f32)
    };
    content.pixels().iter().map(changed).collect()
}

/// `A^(-1/2) (A^(1/2) B A^(1/2))^(1/2) A^(-1/2)`, which takes covariance A to B; in directions in which nothing varies,
/// nothing is changed.
fn map(from: &Matrix, to: &Matrix) -> Matrix {
    let (half, inverse_half, still) = root_and_inverse(from);
    let between = root(&product(&product(&half, to), &half));
    let moved = product(&product(&inverse_half, &between), &inverse_half);
    std::array::from_fn(|i| std::array::from_fn(|j| moved[i][j] + still[i][j]))
}
