//! Images in memory: rows of RGB samples whose encoding is part of their type.
//!
//! The paper works on the encoded (sRGB) values a camera writes, so [`Encoded`] is the default
//! everywhere. Linear light is a named choice and another type: [`Image::to_linear`] is the only way
//! there, and an image of one encoding cannot meet the water of the other.

mod encoding;
mod sample;
mod top_edge;
mod view;

use std::convert::Infallible;
use std::marker::PhantomData;

use crate::scene_area::BorderError;

pub use encoding::{Encoded, Encoding, Linear};
pub use sample::Sample;
pub(crate) use sample::kernels::Kernels;
pub use top_edge::TopEdge;
pub(crate) use view::runs_mut;
pub use view::{ImageMut, ImageRef};

/// An RGB image, rows from the top, three interleaved samples a pixel.
///
/// `T` is the stored sample ([`u8`], [`u16`] or [`f32`]) and `E` its encoding. Whatever `T` is, the
/// physics reads colours in `[0, 1]`; see [`Sample`].
///
/// # Examples
///
/// ```
/// use aquafuse::image::Image;
///
/// let image: Image<u8> = Image::from_raw(2, 1, vec![255, 0, 0, 0, 0, 255])?;
/// assert_eq!(image.pixels()[1], [0, 0, 255]);
/// # Ok::<(), aquafuse::image::ImageError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Image<T, E: Encoding = Encoded> {
    width: usize,
    height: usize,
    samples: Vec<T>,
    encoding: PhantomData<E>,
}

/// The sizes of two things that belong together do not match.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ImageError {
    /// A buffer does not hold exactly the values its width and height ask for.
    #[error("{width}x{height} needs {expected} values, but the buffer holds {found}")]
    Buffer {
        /// Columns asked for.
        width: usize,
        /// Rows asked for.
        height: usize,
        /// Values that size needs.
        expected: usize,
        /// Values found.
        found: usize,
    },
    /// Rows overlap: the next begins before one has ended.
    #[error("rows {stride} samples apart cannot hold {width} pixels of three samples")]
    Stride {
        /// Columns asked for.
        width: usize,
        /// Samples from the start of a row to the start of the next.
        stride: usize,
    },
    /// Pixels have another number of samples than red, green and blue.
    #[error("a pixel has three samples, not {found}: an array's shape is (height, width, 3)")]
    Channels {
        /// Samples a pixel.
        found: usize,
    },
    /// The samples of an array do not lie row by row, pixel by pixel, without gaps.
    #[error(
        "the array is not contiguous in standard layout; copy it first, by `as_standard_layout()` for example"
    )]
    Layout,
    /// An image has no pixels at all.
    #[error("an image of {width}x{height} has no pixels")]
    Empty {
        /// Columns found.
        width: usize,
        /// Rows found.
        height: usize,
    },
    /// A border leaves no pixel.
    #[error(transparent)]
    Border(BorderError),
    /// Two inputs of one operation differ in size.
    #[error("the sizes differ: {}x{} and {}x{}", .left.0, .left.1, .right.0, .right.1)]
    Mismatch {
        /// Width and height of the first.
        left: (usize, usize),
        /// Width and height of the second.
        right: (usize, usize),
    },
}

/// The border of an image leaves nothing of it.
impl From<BorderError> for ImageError {
    fn from(error: BorderError) -> Self {
        Self::Border(error)
    }
}

/// What converts without fail converts without error: for functions that take whatever converts to a view.
impl From<Infallible> for ImageError {
    fn from(never: Infallible) -> Self {
        match never {}
    }
}

/// Checks that `values` fill `width` x `height` places of `per_place` values, and that there is a place.
pub(crate) fn check_size(
    width: usize,
    height: usize,
    per_place: usize,
    found: usize,
) -> Result<(), ImageError> {
    if width == 0 || height == 0 {
        return Err(ImageError::Empty { width, height });
    }
    let expected = width.checked_mul(height).and_then(|n| n.checked_mul(per_place)).unwrap_or(usize::MAX);
    if expected == found { Ok(()) } else { Err(ImageError::Buffer { width, height, expected, found }) }
}

/// Checks that two inputs of one operation share one size.
pub(crate) fn check_same_size(left: (usize, usize), right: (usize, usize)) -> Result<(), ImageError> {
    if left == right { Ok(()) } else { Err(ImageError::Mismatch { left, right }) }
}

impl<T: Sample, E: Encoding> Image<T, E> {
    /// Takes a buffer of `width * height * 3` samples as an image.
    ///
    /// # Errors
    ///
    /// [`ImageError`] when a side is zero or the buffer has another length.
    pub fn from_raw(width: usize, height: usize, samples: Vec<T>) -> Result<Self, ImageError> {
        check_size(width, height, 3, samples.len())?;
        Ok(Self { width, height, samples, encoding: PhantomData })
    }

    /// Columns.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Columns and rows.
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// All pixels, row by row from the top.
    pub fn pixels(&self) -> &[[T; 3]] {
        self.samples.as_chunks().0
    }

    /// All pixels for writing, row by row from the top.
    pub fn pixels_mut(&mut self) -> &mut [[T; 3]] {
        self.samples.as_chunks_mut().0
    }

    /// The rows, from the top.
    pub fn rows(&self) -> impl ExactSizeIterator<Item = &[[T; 3]]> {
        self.pixels().chunks_exact(self.width)
    }

    /// The pixels of row `y`, counted from the top.
    ///
    /// # Panics
    ///
    /// When there is no such row.
    pub fn row(&self, y: usize) -> &[[T; 3]] {
        &self.pixels()[y * self.width..][..self.width]
    }

    /// All samples, interleaved.
    pub fn as_raw(&self) -> &[T] {
        &self.samples
    }

    /// Gives the samples back.
    pub fn into_raw(self) -> Vec<T> {
        self.samples
    }

    /// The same image in floats, as they are: values outside `[0, 1]` stay outside.
    #[must_use]
    pub fn to_unit(&self) -> Image<f32, E> {
        self.map(T::to_unit)
    }

    /// The same image with another sample type, each value clipped to `[0, 1]` and rounded to the
    /// nearest that type can hold.
    #[must_use]
    pub fn convert<U: Sample>(&self) -> Image<U, E> {
        self.map(|sample| U::from_unit(sample.to_unit()))
    }

    fn map<U, F: Encoding>(&self, change: impl Fn(T) -> U) -> Image<U, F> {
        Image {
            width: self.width,
            height: self.height,
            samples: self.samples.iter().map(|&sample| change(sample)).collect(),
            encoding: PhantomData,
        }
    }
}

impl<T: Sample> Image<T, Encoded> {
    /// Decodes to linear light by the sRGB transfer function (IEC 61966-2-1).
    #[must_use]
    pub fn to_linear(&self) -> Image<f32, Linear> {
        self.map(|sample| Linear::from_encoded(sample.to_unit()))
    }
}

impl<E: Encoding> Image<f32, E> {
    /// Encodes light by the sRGB transfer function; undoes [`Image::to_linear`]. What is encoded stays as it is.
    #[must_use]
    pub fn to_encoded(&self) -> Image<f32, Encoded> {
        self.map(E::to_encoded)
    }
}

/// Values that left `[0, 1]` and were clipped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Clipping {
    /// Clipped values of red, green and blue.
    pub values: [u64; 3],
    /// Pixels in the image.
    pub pixels: u64,
}

impl Clipping {
    /// Share of all values that were clipped.
    pub fn share(&self) -> f64 {
        self.values.iter().sum::<u64>() as f64 / (3 * self.pixels.max(1)) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_buffer_of_the_wrong_length_is_refused() {
        let error = Image::<u8>::from_raw(2, 2, vec![0; 11]).unwrap_err();
        assert_eq!(error, ImageError::Buffer { width: 2, height: 2, expected: 12, found: 11 });
    }

    #[test]
    fn an_image_without_pixels_is_refused() {
        assert!(matches!(Image::<u8>::from_raw(0, 5, vec![]), Err(ImageError::Empty { .. })));
    }

    #[test]
    fn a_size_that_overflows_is_refused() {
        assert!(Image::<u8>::from_raw(usize::MAX, 2, vec![0; 6]).is_err());
    }

    #[test]
    fn every_byte_survives_the_way_to_linear_light_and_back() {
        let bytes: Vec<u8> = (0..=255).flat_map(|v| [v, v, v]).collect();
        let image = Image::<u8>::from_raw(256, 1, bytes).unwrap();
        assert_eq!(image.to_linear().to_encoded().convert::<u8>(), image);
    }

    #[test]
    fn sixteen_bits_hold_every_byte() {
        let bytes: Vec<u8> = (0..=255).flat_map(|v| [v, 255 - v, v]).collect();
        let image = Image::<u8>::from_raw(256, 1, bytes).unwrap();
        assert_eq!(image.convert::<u16>().convert::<u8>(), image);
    }
}
