//! Smoothing of the fused image, the paper's last step.
//!
//! The paper ends with a bilateral filter and gives no parameters. Here nothing is smoothed unless asked for:
//! what the filter takes for noise is as often texture.

mod bytes;
mod weights;

use crate::bands;
use crate::image::{Encoding, Image, ImageError, ImageMut, ImageRef, Sample, check_same_size, runs_mut};
use weights::{AHEAD, ONE, mirrored, weight};

/// How a fused image is smoothed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Smoothing {
    /// Not at all.
    #[default]
    None,
    /// By [`bilateral`].
    Bilateral,
}

impl Smoothing {
    /// All ways, in the order of the documentation.
    pub const ALL: &'static [Self] = &[Self::None, Self::Bilateral];

    /// The name used on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Bilateral => "bilateral",
        }
    }

    /// The image, smoothed.
    #[must_use]
    pub fn apply<T: Sample, E: Encoding>(self, image: Image<T, E>) -> Image<T, E> {
        match self {
            Self::None => image,
            Self::Bilateral => bilateral(&image),
        }
    }
}

crate::names::named!(Smoothing, "smoothing");

/// Smooths an image but not its edges: each pixel becomes the mean of those within two pixels of it, weighted by
/// `e^(-Δ² / 2σ²)` of how their colours differ.
///
/// d = 5, σ = 75, Δ the sum of the channels' differences in steps of a byte, whatever the samples are. Distance in
/// pixels weighs nothing: with a σ of 75 pixels it would be 4 parts in 10,000. Beyond the border the image is mirrored
/// about its outermost pixels. The filter of C. Tomasi and R. Manduchi, "Bilateral filtering for gray and color images"
/// (1998), as OpenCV's `bilateralFilter` computes it for bytes, to a step of 255.
///
/// # Examples
///
/// An edge of 200 steps stays sharp, one of 8 is worn down:
///
/// ```
/// use aquafuse::{image::Image, smooth::bilateral};
///
/// let row = |left: u8, right: u8| Image::<u8>::from_raw(4, 1, [[left; 6], [right; 6]].concat());
/// assert_eq!(bilateral(&row(20, 220)?), row(20, 220)?);
/// let worn: Vec<u8> = bilateral(&row(20, 28)?).pixels().iter().map(|pixel| pixel[0]).collect();
/// assert!(20 < worn[1] && worn[1] < worn[2] && worn[2] < 28);
/// # Ok::<(), aquafuse::image::ImageError>(())
/// ```
#[must_use]
pub fn bilateral<'a, T: Sample, E: Encoding>(image: impl Into<ImageRef<'a, T, E>>) -> Image<T, E> {
    let image = image.into();
    let mut smoothed = image.to_image();
    smooth_into(image, smoothed.view_mut());
    smoothed
}

/// [`bilateral`] into an image that is there already, which keeps nothing of what it was.
///
/// # Errors
///
/// [`ImageError`] when the two differ in size; `smoothed` is then unchanged.
pub fn bilateral_into<'a, 'b, T: Sample, E: Encoding>(
    image: impl Into<ImageRef<'a, T, E>>,
    smoothed: impl Into<ImageMut<'b, T, E>>,
) -> Result<(), ImageError> {
    let (image, smoothed) = (image.into(), smoothed.into());
    check_same_size(image.size(), smoothed.size())?;
    smooth_into(image, smoothed);
    Ok(())
}

fn smooth_into<T: Sample, E: Encoding>(image: ImageRef<'_, T, E>, mut smoothed: ImageMut<'_, T, E>) {
    if let (Some(image), Some(smoothed)) = (image.as_bytes(), smoothed.reborrow().into_bytes()) {
        return bytes::smooth(image, smoothed);
    }
    let (width, stride) = (smoothed.width(), smoothed.stride());
    bands::for_each(smoothed.into_samples(), stride, |first, band| {
        for (start, run) in runs_mut(band, width, stride) {
            for (i, pixel) in run.as_chunks_mut().0.iter_mut().enumerate() {
                *pixel = mean_around(image, i % width, first + (start + i) / width);
            }
        }
    });
}

/// The weighted mean of the window around one place, rounded; halves go up.
fn mean_around<T: Sample, E: Encoding>(image: ImageRef<'_, T, E>, x: usize, y: usize) -> [T; 3] {
    let (width, height) = image.size();
    let middle = &image.row(y)[x];
    let one = u64::from(ONE);
    let (mut sums, mut total) = (middle.map(|value| one * value.to_steps()), one);
    for (dx, dy) in AHEAD {
        for (dx, dy) in [(dx, dy as isize), (-dx, -(dy as isize))] {
            let column = mirrored(x as isize + dx, width);
            let other = &image.row(mirrored(y as isize + dy, height))[column];
            let off = |c: usize| u16::from(middle[c].to_byte().abs_diff(other[c].to_byte()));
            let weight = weight::<0>(off(0) + off(1) + off(2)) as u64;
            total += weight;
            for c in 0..3 {
                sums[c] += weight * other[c].to_steps();
            }
        }
    }
    sums.map(|sum| T::from_steps((sum + total / 2) / total))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn picture(width: usize, height: usize) -> impl Strategy<Value = Image<u8>> {
        prop::collection::vec(any::<u8>(), 3 * width * height)
            .prop_map(move |samples| Image::from_raw(width, height, samples).unwrap())
    }

    proptest! {
        #[test]
        fn a_flat_image_is_left_as_it_is(rgb: [u8; 3], width in 1..7_usize, height in 1..7_usize) {
            let flat = Image::<u8>::from_raw(width, height, rgb.repeat(width * height)).unwrap();
            prop_assert_eq!(bilateral(&flat), flat);
        }

        #[test]
        fn no_value_leaves_the_range_of_the_image(image in picture(6, 5)) {
            let of = |image: &Image<u8>, c: usize| {
                let values: Vec<u8> = image.pixels().iter().map(|pixel| pixel[c]).collect();
                (values.iter().min().copied(), values.iter().max().copied())
            };
            let smoothed = bilateral(&image);
            for c in 0..3 {
                prop_assert!(of(&smoothed, c).0 >= of(&image, c).0 && of(&smoothed, c).1 <= of(&image, c).1);
            }
        }

        #[test]
        fn the_mirror_image_is_smoothed_to_the_mirror(image in picture(7, 4)) {
            let mirror = |image: &Image<u8>| {
                let samples = image.rows().flat_map(|row| row.iter().rev().copied()).flatten().collect();
                Image::<u8>::from_raw(7, 4, samples).unwrap()
            };
            prop_assert_eq!(bilateral(&mirror(&image)), mirror(&bilateral(&image)));
        }
    }

    #[test]
    fn finer_samples_are_smoothed_as_bytes_are() {
        let image = Image::<u8>::from_raw(9, 5, (0..135).map(|i| (i * 37 % 251) as u8).collect()).unwrap();
        let smoothed = bilateral(&image);
        assert_eq!(bilateral(&image.convert::<u16>()).convert::<u8>(), smoothed);
        assert_eq!(bilateral(&image.to_unit()).convert::<u8>(), smoothed);
    }

    #[cfg(feature = "threads")]
    #[test]
    fn threads_change_no_bit() {
        let image = Image::<u8>::from_raw(64, 40, (0..7680).map(|i| (i * 37 % 251) as u8).collect()).unwrap();
        let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        assert_eq!(alone.install(|| bilateral(&image)), bilateral(&image));
    }
}
