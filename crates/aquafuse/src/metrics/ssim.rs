//! Structural similarity.

use crate::image::{ImageError, ImageRef, Sample, check_same_size};

/// Deviation of the Gaussian window, and its reach to either side: 11 x 11 as in the publication.
const SIGMA: f64 = 1.5;
const REACH: usize = 5;
/// Constants that keep flat places from dividing by nothing, for values in `[0, 1]`.
const C1: f64 = 0.01 * 0.01;
const C2: f64 = 0.03 * 0.03;

/// Structural similarity index of the luma of two encoded images, 1 for equal ones.
///
/// Z. Wang et al., "Image quality assessment: from error visibility to structural similarity" (2004): a
/// Gaussian window of 11 x 11, σ 1.5, K1 = .01, K2 = .03, the mean over all windows inside the image. Luma is
/// .299 R + .587 G + .114 B of the encoded values. None for images smaller than a window.
///
/// # Errors
///
/// [`ImageError`] when the images differ in size.
///
/// # Examples
///
/// ```
/// use aquafuse::{image::Image, metrics::ssim};
///
/// let image = Image::<u8>::from_raw(16, 16, (0..=255).flat_map(|v| [v, v / 2, 255 - v]).collect())?;
/// assert!((ssim(&image, &image)?.unwrap() - 1.0).abs() < 1e-12);
/// # Ok::<(), aquafuse::image::ImageError>(())
/// ```
pub fn ssim<'a, 'b, T: Sample, U: Sample>(
    a: impl Into<ImageRef<'a, T>>,
    b: impl Into<ImageRef<'b, U>>,
) -> Result<Option<f64>, ImageError> {
    let (a, b) = (a.into(), b.into());
    check_same_size(a.size(), b.size())?;
    let (width, height) = a.size();
    if width <= 2 * REACH || height <= 2 * REACH {
        return Ok(None);
    }
    let mut sum = 0.0;
    let mut window = Window::new(width);
    for (x, y) in a.rows().zip(b.rows()) {
        window.push(x, y);
        if window.rows > 2 * REACH {
            sum += window.indices().sum::<f64>();
        }
    }
    let windows = (width - 2 * REACH) * (height - 2 * REACH);
    Ok(Some(sum / windows as f64))
}

/// Rows that a window covers.
const ROWS: usize = 2 * REACH + 1;
/// Blurred by the window: luma of both images, the two squares, the product.
const QUANTITIES: usize = 5;

/// The last rows of what is blurred, along rows already: however large the images, nothing else is kept.
struct Window {
    bell: [f64; ROWS],
    /// Values at every pixel of the row that came last.
    row: [Vec<f64>; QUANTITIES],
    /// Blurred along the row, a ring of rows.
    ring: [[Vec<f64>; QUANTITIES]; ROWS],
    /// Rows that have come.
    rows: usize,
}

impl Window {
    fn new(width: usize) -> Self {
        let bell: [f64; ROWS] = std::array::from_fn(|i| {
            let distance = i as f64 - REACH as f64;
            (-0.5 * (distance / SIGMA).powi(2)).exp()
        });
        let total: f64 = bell.iter().sum();
        let values = |count: usize| std::array::from_fn(|_| vec![0.0; count]);
        Self {
            bell: bell.map(|weight| weight / total),
            row: values(width),
            ring: std::array::from_fn(|_| values(width - 2 * REACH)),
            rows: 0,
        }
    }

    fn push<T: Sample, U: Sample>(&mut self, a: &[[T; 3]], b: &[[U; 3]]) {
        for (i, (a, b)) in a.iter().zip(b).enumerate() {
            let (x, y) = (luma(a), luma(b));
            for (values, value) in self.row.iter_mut().zip([x, y, x * x, y * y, x * y]) {
                values[i] = value;
            }
        }
        for (blurred, values) in self.ring[self.rows % ROWS].iter_mut().zip(&self.row) {
            blurred.fill(0.0);
            for (weight, values) in self.bell.iter().zip(values.windows(blurred.len())) {
                blurred.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
            }
        }
        self.rows += 1;
    }

    /// The index at each place of the row of windows that ends with the row that came last.
    fn indices(&self) -> impl Iterator<Item = f64> {
        let mut blurred: [Vec<f64>; QUANTITIES] = std::array::from_fn(|q| vec![0.0; self.ring[0][q].len()]);
        for (k, weight) in self.bell.iter().enumerate() {
            // The oldest row is the one that would be overwritten next.
            for (sums, values) in blurred.iter_mut().zip(&self.ring[(self.rows + k) % ROWS]) {
                sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
            }
        }
        (0..blurred[0].len()).map(move |i| {
            let [mx, my, xx, yy, xy] = [0, 1, 2, 3, 4].map(|q| blurred[q][i]);
            let (vx, vy, covariance) = (xx - mx * mx, yy - my * my, xy - mx * my);
            ((2.0 * mx * my + C1) * (2.0 * covariance + C2)) / ((mx * mx + my * my + C1) * (vx + vy + C2))
        })
    }
}

fn luma<T: Sample>(pixel: &[T; 3]) -> f64 {
    let [r, g, b] = pixel.map(|value| f64::from(value.to_unit()));
    0.299 * r + 0.587 * g + 0.114 * b
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Image;

    #[test]
    fn an_image_smaller_than_the_window_has_no_index() {
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
