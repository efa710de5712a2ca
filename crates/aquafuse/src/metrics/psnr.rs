//! Peak signal-to-noise ratio.

use crate::image::{Encoding, ImageError, ImageRef, Sample, check_same_size};

/// Peak signal-to-noise ratio of two images in dB, over all pixels and channels.
///
/// `10 log10(1 / MSE)` of values in `[0, 1]`, computed in floating point; infinite for equal images.
///
/// # Errors
///
/// [`ImageError`] when the images differ in size.
///
/// # Examples
///
/// ```
/// use aquafuse::{image::Image, metrics::psnr};
///
/// let grey = |value| Image::<f32>::from_raw(1, 1, vec![value; 3]);
/// assert!((psnr(&grey(0.5)?, &grey(0.6)?)? - 20.0).abs() < 1e-5);
/// # Ok::<(), aquafuse::image::ImageError>(())
/// ```
pub fn psnr<'a, 'b, T: Sample, U: Sample, E: Encoding>(
    a: impl Into<ImageRef<'a, T, E>>,
    b: impl Into<ImageRef<'b, U, E>>,
) -> Result<f64, ImageError> {
    let (a, b) = (a.into(), b.into());
    check_same_size(a.size(), b.size())?;
    let squares = a.pixels().flatten().zip(b.pixels().flatten());
    let squares = squares.map(|(a, b)| f64::from(a.to_unit() - b.to_unit()).powi(2));
    let mean = squares.sum::<f64>() / (3 * a.width() * a.height()) as f64;
    Ok(-10.0 * mean.log10())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Image;

    #[test]
    fn equal_images_are_infinitely_alike() {
        let image = Image::<u8>::from_raw(2, 1, vec![7; 6]).unwrap();
        assert_eq!(psnr(&image, &image.convert::<u16>()).unwrap(), f64::INFINITY);
    }

    #[test]
    fn a_difference_of_the_whole_range_is_zero_decibels() {
        let (black, white) = ([0_u8; 3], [255_u8; 3]);
        let image = |value: [u8; 3]| Image::<u8>::from_raw(1, 1, value.to_vec()).unwrap();
        assert_eq!(psnr(&image(black), &image(white)).unwrap(), 0.0);
    }

    #[test]
    fn sizes_that_differ_are_an_error() {
        let image = |width| Image::<u8>::from_raw(width, 1, vec![0; 3 * width]).unwrap();
        assert!(psnr(&image(1), &image(2)).is_err());
    }
}
