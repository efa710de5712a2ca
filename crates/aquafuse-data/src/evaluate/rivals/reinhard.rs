//! Reinhard's transfer: mean and deviation of each channel of lαβ are made those of the reference.

use aquafuse::image::Image;

use super::unit;

/// RGB to LMS and its inverse, as printed in the publication.
const LMS: [[f64; 3]; 3] = [[0.3811, 0.5783, 0.0402], [0.1967, 0.7244, 0.0782], [0.0241, 0.1288, 0.8444]];
const RGB: [[f64; 3]; 3] = [[4.4679, -3.5873, 0.1193], [-1.2186, 2.3809, -0.1624], [0.0497, -0.2439, 1.2045]];
/// The logarithm of black is not defined: half a step of a byte stands for it.
const BLACK: f64 = 0.5 / 255.0;

/// Mean and deviation of each channel of lαβ.
#[derive(Clone, Debug)]
pub(super) struct Moments {
    mean: [f64; 3],
    deviation: [f64; 3],
}

impl Moments {
    pub(super) fn of(image: &Image<u8>) -> Self {
        let count = image.pixels().len() as f64;
        let sum_of = |value: &dyn Fn([f64; 3]) -> [f64; 3]| {
            image.pixels().iter().fold([0.0; 3], |sum: [f64; 3], pixel| {
                let of_pixel = value(to_lab(pixel));
                std::array::from_fn(|c| sum[c] + of_pixel[c])
            })
        };
        let mean = sum_of(&|lab| lab).map(|sum| sum / count);
        let squares = sum_of(&|lab| std::array::from_fn(|c| (lab[c] - mean[c]).powi(2)));
        Self { mean, deviation: squares.map(|sum| (sum / count).sqrt()) }
    }
}

pub(super) fn transfer(content: &Image<u8>, own: &Moments, other: &Moments) -> Vec<[f32; 3]> {
    let gain = |c: usize| if own.deviation[c] > 0.0 { other.deviation[c] / own.deviation[c] } else { 1.0 };
    let gains: [f64; 3] = std::array::from_fn(gain);
    let changed = |pixel: &[u8; 3]| {
        let lab = to_lab(pixel);
        let given = std::array::from_fn(|c| (lab[c] - own.mean[c]) * gains[c] + other.mean[c]);
        from_lab(given).map(|value| value as f32)
    };
    content.pixels().iter().map(changed).collect()
}

fn times(matrix: &[[f64; 3]; 3], [a, b, c]: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row[0] * a + row[1] * b + row[2] * c)
}

fn to_lab(pixel: &[u8; 3]) -> [f64; 3] {
    let [l, m, s] = times(&LMS, unit(pixel).map(|value| value.max(BLACK))).map(f64::log10);
    [(l + m + s) / 3_f64.sqrt(), (l + m - 2.0 * s) / 6_f64.sqrt(), (l - m) / 2_f64.sqrt()]
}

fn from_lab([l, a, b]: [f64; 3]) -> [f64; 3] {
    let (l, a, b) = (l / 3_f64.sqrt(), a / 6_f64.sqrt(), b / 2_f64.sqrt());
    times(&RGB, [l + a + b, l + a - b, l - 2.0 * a].map(|log| 10_f64.powf(log)))
}
