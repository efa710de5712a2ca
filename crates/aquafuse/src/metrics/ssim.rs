//! Structural similarity.

use crate::image::{Image, Sample, SizeError, check_same_size};

/// Deviation of the Gaussian window, and its reach to either side: 11 x 11 as in the publication.
const SIGMA: f64 = 1.5;
const REACH: usize = 5;
/// Constants that keep flat places from dividing by nothing, for values in `[0, 1]`.
const C1: f64 = 0.01 * 0.01;
const C2: f64 = 0.03 * 0.03;

/// Structural similarity index of the luma of two encoded pictures, 1 for equal ones.
///
/// Z. Wang et al., "Image quality assessment: from error visibility to structural similarity" (2004): a
/// Gaussian window of 11 x 11, σ 1.5, K1 = .01, K2 = .03, the mean over all windows inside the picture. Luma is
/// .299 R + .587 G + .114 B of the encoded values. None for pictures smaller than a window.
///
/// # Errors
///
/// [`SizeError`] when the pictures differ in size.
///
/// # Examples
///
/// ```
/// use aquafuse::{image::Image, metrics::ssim};
///
/// let image = Image::<u8>::from_raw(16, 16, (0..=255).flat_map(|v| [v, v / 2, 255 - v]).collect())?;
/// assert!((ssim(&image, &image)?.unwrap() - 1.0).abs() < 1e-12);
/// # Ok::<(), aquafuse::image::SizeError>(())
/// ```
pub fn ssim<T: Sample, U: Sample>(a: &Image<T>, b: &Image<U>) -> Result<Option<f64>, SizeError> {
    check_same_size(a.size(), b.size())?;
    let (width, height) = a.size();
    if width <= 2 * REACH || height <= 2 * REACH {
        return Ok(None);
    }
    let (x, y) = (luma(a), luma(b));
    let blurred = |values: Vec<f64>| blur(&values, width, height);
    let product = |a: &[f64], b: &[f64]| blurred(a.iter().zip(b).map(|(a, b)| a * b).collect());
    let (xx, yy, xy) = (product(&x, &x), product(&y, &y), product(&x, &y));
    let (mean_x, mean_y) = (blurred(x), blurred(y));
    let index = |i: usize| {
        let (mx, my) = (mean_x[i], mean_y[i]);
        let (vx, vy, covariance) = (xx[i] - mx * mx, yy[i] - my * my, xy[i] - mx * my);
        ((2.0 * mx * my + C1) * (2.0 * covariance + C2)) / ((mx * mx + my * my + C1) * (vx + vy + C2))
    };
    Ok(Some((0..mean_x.len()).map(index).sum::<f64>() / mean_x.len() as f64))
}

fn luma<T: Sample>(image: &Image<T>) -> Vec<f64> {
    let of = |pixel: &[T; 3]| {
        let [r, g, b] = pixel.map(|value| f64::from(value.to_unit()));
        0.299 * r + 0.587 * g + 0.114 * b
    };
    image.pixels().iter().map(of).collect()
}

/// The Gaussian window at every place where it fits, first along rows, then along columns.
fn blur(values: &[f64], width: usize, height: usize) -> Vec<f64> {
    let bell: [f64; 2 * REACH + 1] = std::array::from_fn(|i| {
        let distance = i as f64 - REACH as f64;
        (-0.5 * (distance / SIGMA).powi(2)).exp()
    });
    let total: f64 = bell.iter().sum();
    let weights = bell.map(|weight| weight / total);
    let inner = width - 2 * REACH;
    let along_row = |row: &[f64], x: usize| weights.iter().zip(&row[x..]).map(|(w, v)| w * v).sum::<f64>();
    let rows: Vec<f64> =
        values.chunks_exact(width).flat_map(|row| (0..inner).map(move |x| along_row(row, x))).collect();
    let along_column =
        |x: usize, y: usize| (0..weights.len()).map(|k| weights[k] * rows[(y + k) * inner + x]).sum();
    (0..height - 2 * REACH)
        .flat_map(|y| (0..inner).map(move |x| (x, y)))
        .map(|(x, y)| along_column(x, y))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_smaller_than_the_window_has_no_index() {
        let image = Image::<u8>::from_raw(10, 20, vec![0; 600]).unwrap();
        assert_eq!(ssim(&image, &image).unwrap(), None);
    }

    #[test]
    fn a_negative_is_less_alike_than_a_darker_copy() {
        let image: Image<u8> =
            Image::from_raw(32, 32, (0..3072).map(|i| (i * 37 % 251) as u8).collect()).unwrap();
        let changed = |change: fn(f32) -> f32| {
            let values = image.as_raw().iter().map(|v| change(f32::from(*v) / 255.0)).collect();
            ssim(&image, &Image::<f32>::from_raw(32, 32, values).unwrap()).unwrap().unwrap()
        };
        let (darker, negative) = (changed(|v| 0.9 * v), changed(|v| 1.0 - v));
        assert!(darker > 0.9 && negative < 0.0, "{darker}, {negative}");
    }
}
