//! Borrowed images: anybody's pixels, with padding between the rows if there is any.

use std::borrow::Cow;
use std::marker::PhantomData;

use super::{Encoded, Encoding, Image, ImageError, Sample, check_same_size};

/// An RGB image in memory that belongs to somebody else, for reading.
///
/// Rows run from the top, and a pixel is three interleaved samples: red, green, blue. From the first sample of a row
/// to the first of the next it is [`stride`](Self::stride) **samples**; what lies between the last pixel of a row and
/// the next row is padding, which is never read. A stride in bytes, as cameras and video libraries give it, is
/// divided by `size_of::<T>()`: by 1 for bytes, 2 for 16-bit samples, 4 for floats.
///
/// Every function of this crate that reads an image takes `impl Into<ImageRef>`: this view, or `&`[`Image`].
///
/// # Examples
///
/// Two pixels a row, and two bytes of padding:
///
/// ```
/// use aquafuse::image::ImageRef;
///
/// let buffer: Vec<u8> = vec![1, 2, 3, 4, 5, 6, 0, 0, 7, 8, 9, 10, 11, 12, 0, 0];
/// let image: ImageRef<'_, u8> = ImageRef::with_stride(2, 2, 8, &buffer)?;
/// assert_eq!(image.row(1), [[7, 8, 9], [10, 11, 12]]);
/// # Ok::<(), aquafuse::image::ImageError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct ImageRef<'a, T, E: Encoding = Encoded> {
    shape: Shape,
    /// From the first sample of the first row to the last of the last.
    samples: &'a [T],
    encoding: PhantomData<E>,
}

/// [`ImageRef`] for reading and writing. Padding is never written either.
///
/// Every function that changes or fills an image takes `impl Into<ImageMut>`: this view, `&mut` of it, or `&mut`
/// [`Image`].
///
/// # Examples
///
/// ```
/// use aquafuse::image::ImageMut;
///
/// let mut buffer = vec![0_u8; 15];
/// let mut image: ImageMut<'_, u8> = ImageMut::with_stride(2, 2, 8, &mut buffer)?;
/// image.row_mut(1)[0] = [7, 8, 9];
/// assert_eq!(buffer[8..11], [7, 8, 9]);
/// # Ok::<(), aquafuse::image::ImageError>(())
/// ```
#[derive(Debug)]
pub struct ImageMut<'a, T, E: Encoding = Encoded> {
    shape: Shape,
    samples: &'a mut [T],
    encoding: PhantomData<E>,
}

/// Where the pixels of a view lie in its samples.
#[derive(Clone, Copy, Debug)]
struct Shape {
    width: usize,
    height: usize,
    /// Samples from the start of a row to the start of the next, three a pixel at least.
    stride: usize,
}

impl Shape {
    /// A shape within `found` samples, and how many it covers: the padding of the last row is not needed.
    fn new(width: usize, height: usize, stride: usize, found: usize) -> Result<(Self, usize), ImageError> {
        if width == 0 || height == 0 {
            return Err(ImageError::Empty { width, height });
        }
        let row = width.checked_mul(3).filter(|&row| row <= stride);
        let row = row.ok_or(ImageError::Stride { width, stride })?;
        let above = (height - 1).checked_mul(stride).and_then(|above| above.checked_add(row));
        match above {
            Some(covered) if covered <= found => Ok((Self { width, height, stride }, covered)),
            _ => Err(ImageError::Buffer { width, height, expected: above.unwrap_or(usize::MAX), found }),
        }
    }

    fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// Samples of a row.
    fn row(&self) -> usize {
        3 * self.width
    }

    /// Of samples that begin with a row: from the start of a run of pixels without padding to the start of the next, and
    /// the samples in it. It is a row, or everything where nothing lies between the rows.
    fn run(&self, samples: usize) -> (usize, usize) {
        if self.stride == self.row() { (samples, samples) } else { (self.stride, self.row()) }
    }
}

impl<'a, T: Sample, E: Encoding> ImageRef<'a, T, E> {
    /// An image without padding: exactly `width * height * 3` samples.
    ///
    /// # Errors
    ///
    /// [`ImageError`] when a side is zero or the buffer has another length.
    pub fn new(width: usize, height: usize, samples: &'a [T]) -> Result<Self, ImageError> {
        super::check_size(width, height, 3, samples.len())?;
        Self::with_stride(width, height, 3 * width, samples)
    }

    /// An image whose rows begin `stride` samples apart. The last row needs no padding, and what follows it is
    /// ignored.
    ///
    /// # Errors
    ///
    /// [`ImageError`] when a side is zero, the stride is shorter than a row, or the buffer than the image.
    pub fn with_stride(
        width: usize,
        height: usize,
        stride: usize,
        samples: &'a [T],
    ) -> Result<Self, ImageError> {
        let (shape, covered) = Shape::new(width, height, stride, samples.len())?;
        Ok(Self { shape, samples: &samples[..covered], encoding: PhantomData })
    }

    /// Columns.
    pub fn width(&self) -> usize {
        self.shape.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.shape.height
    }

    /// Columns and rows.
    pub fn size(&self) -> (usize, usize) {
        self.shape.size()
    }

    /// Samples from the start of a row to the start of the next.
    pub fn stride(&self) -> usize {
        self.shape.stride
    }

    /// The pixels of row `y`, counted from the top.
    ///
    /// # Panics
    ///
    /// When there is no such row.
    #[inline]
    pub fn row(&self, y: usize) -> &'a [[T; 3]] {
        self.samples[y * self.shape.stride..][..self.shape.row()].as_chunks().0
    }

    /// The rows, from the top.
    pub fn rows(&self) -> impl ExactSizeIterator<Item = &'a [[T; 3]]> + use<'a, T, E> {
        let row = self.shape.row();
        self.samples.chunks(self.shape.stride).map(move |samples| samples[..row].as_chunks().0)
    }

    /// The pixels, row by row from the top.
    pub fn pixels(&self) -> impl Iterator<Item = &'a [T; 3]> + use<'a, T, E> {
        self.runs().flatten()
    }

    /// A copy without padding.
    #[must_use]
    pub fn to_image(&self) -> Image<T, E> {
        let mut samples = Vec::with_capacity(self.shape.row() * self.shape.height);
        self.runs().for_each(|run| samples.extend_from_slice(run.as_flattened()));
        let (width, height) = self.size();
        Image { width, height, samples, encoding: PhantomData }
    }

    /// Whole rows of about so many pixels, evenly spread, each with its number: the mirror image has the same pixels.
    pub(crate) fn sampled_rows(self, pixels: usize) -> impl Iterator<Item = (usize, &'a [[T; 3]])> {
        let (width, height) = self.size();
        let rows = (pixels / width).clamp(1, height);
        // The middle of each of so many bands.
        (0..rows).map(move |row| (2 * row + 1) * height / (2 * rows)).map(move |y| (y, self.row(y)))
    }

    /// A copy in floats, as they are: values outside `[0, 1]` stay outside.
    pub(crate) fn to_unit(self) -> Image<f32, E> {
        let (width, height) = self.size();
        let samples = self.runs().flat_map(<[_]>::as_flattened).map(|sample| sample.to_unit());
        Image { width, height, samples: samples.collect(), encoding: PhantomData }
    }

    /// The same image if its samples are bytes: bytes have faster ways.
    pub(crate) fn as_bytes(&self) -> Option<ImageRef<'a, u8, E>> {
        T::bytes(self.samples).map(|samples| ImageRef { shape: self.shape, samples, encoding: PhantomData })
    }

    /// The longest runs of pixels without padding between them: all pixels, or each row. What is done by runs costs
    /// no more on an image without padding than on a slice.
    #[inline]
    pub(crate) fn runs(&self) -> impl Iterator<Item = &'a [[T; 3]]> + use<'a, T, E> {
        let (step, run) = self.shape.run(self.samples.len());
        self.samples.chunks(step).map(move |samples| samples[..run].as_chunks().0)
    }
}

impl<'a, T: Sample, E: Encoding> ImageMut<'a, T, E> {
    /// An image without padding: exactly `width * height * 3` samples.
    ///
    /// # Errors
    ///
    /// [`ImageError`] when a side is zero or the buffer has another length.
    pub fn new(width: usize, height: usize, samples: &'a mut [T]) -> Result<Self, ImageError> {
        super::check_size(width, height, 3, samples.len())?;
        Self::with_stride(width, height, 3 * width, samples)
    }

    /// An image whose rows begin `stride` samples apart. The last row needs no padding, and what follows it is
    /// left alone.
    ///
    /// # Errors
    ///
    /// [`ImageError`] when a side is zero, the stride is shorter than a row, or the buffer than the image.
    pub fn with_stride(
        width: usize,
        height: usize,
        stride: usize,
        samples: &'a mut [T],
    ) -> Result<Self, ImageError> {
        let (shape, covered) = Shape::new(width, height, stride, samples.len())?;
        Ok(Self { shape, samples: &mut samples[..covered], encoding: PhantomData })
    }

    /// Columns.
    pub fn width(&self) -> usize {
        self.shape.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.shape.height
    }

    /// Columns and rows.
    pub fn size(&self) -> (usize, usize) {
        self.shape.size()
    }

    /// Samples from the start of a row to the start of the next.
    pub fn stride(&self) -> usize {
        self.shape.stride
    }

    /// The same image for reading.
    pub fn as_ref(&self) -> ImageRef<'_, T, E> {
        ImageRef { shape: self.shape, samples: self.samples, encoding: PhantomData }
    }

    /// The same image for a shorter time.
    pub fn reborrow(&mut self) -> ImageMut<'_, T, E> {
        ImageMut { shape: self.shape, samples: self.samples, encoding: PhantomData }
    }

    /// The pixels of row `y` for writing, counted from the top.
    ///
    /// # Panics
    ///
    /// When there is no such row.
    pub fn row_mut(&mut self, y: usize) -> &mut [[T; 3]] {
        self.samples[y * self.shape.stride..][..self.shape.row()].as_chunks_mut().0
    }

    /// The rows for writing, from the top.
    pub fn rows_mut(&mut self) -> impl ExactSizeIterator<Item = &mut [[T; 3]]> {
        let row = self.shape.row();
        self.samples.chunks_mut(self.shape.stride).map(move |samples| samples[..row].as_chunks_mut().0)
    }

    /// Copies the pixels of an image of the same size.
    ///
    /// # Errors
    ///
    /// [`ImageError`] when the two differ in size; this image is then unchanged.
    pub fn copy_from<'b>(&mut self, image: impl Into<ImageRef<'b, T, E>>) -> Result<(), ImageError> {
        let image = image.into();
        check_same_size(self.size(), image.size())?;
        self.rows_mut().zip(image.rows()).for_each(|(to, from)| to.copy_from_slice(from));
        Ok(())
    }

    /// [`ImageRef::as_bytes`] for writing.
    pub(crate) fn into_bytes(self) -> Option<ImageMut<'a, u8, E>> {
        let shape = self.shape;
        T::bytes_mut(self.samples).map(|samples| ImageMut { shape, samples, encoding: PhantomData })
    }

    /// All samples from the first of the first row to the last of the last, rows [`stride`](Self::stride) apart.
    pub(crate) fn into_samples(self) -> &'a mut [T] {
        self.samples
    }
}

/// The runs of pixels without padding (see `ImageRef::runs`) in samples that begin with a row of an image of `width`
/// columns whose rows are `stride` samples apart: each with the number of its first pixel among them.
#[inline]
pub(crate) fn runs_mut<T>(
    samples: &mut [T],
    width: usize,
    stride: usize,
) -> impl Iterator<Item = (usize, &mut [T])> {
    let (step, run) = Shape { width, height: 1, stride }.run(samples.len());
    samples.chunks_mut(step).enumerate().map(move |(i, samples)| (i * width, &mut samples[..run]))
}

impl<'a, T: Sample, E: Encoding> From<&'a Image<T, E>> for ImageRef<'a, T, E> {
    fn from(image: &'a Image<T, E>) -> Self {
        image.view()
    }
}

impl<'a, T: Sample, E: Encoding> From<&'a Cow<'_, Image<T, E>>> for ImageRef<'a, T, E> {
    fn from(image: &'a Cow<'_, Image<T, E>>) -> Self {
        image.view()
    }
}

impl<'a, T: Sample, E: Encoding> From<&'a mut Image<T, E>> for ImageMut<'a, T, E> {
    fn from(image: &'a mut Image<T, E>) -> Self {
        image.view_mut()
    }
}

impl<T: Sample, E: Encoding> From<&Self> for ImageRef<'_, T, E> {
    fn from(image: &Self) -> Self {
        *image
    }
}

impl<'a, T: Sample, E: Encoding> From<ImageMut<'a, T, E>> for ImageRef<'a, T, E> {
    fn from(image: ImageMut<'a, T, E>) -> Self {
        Self { shape: image.shape, samples: image.samples, encoding: PhantomData }
    }
}

impl<'a, T: Sample, E: Encoding> From<&'a ImageMut<'_, T, E>> for ImageRef<'a, T, E> {
    fn from(image: &'a ImageMut<'_, T, E>) -> Self {
        image.as_ref()
    }
}

impl<'a, T: Sample, E: Encoding> From<&'a mut ImageMut<'_, T, E>> for ImageMut<'a, T, E> {
    fn from(image: &'a mut ImageMut<'_, T, E>) -> Self {
        image.reborrow()
    }
}

impl<T: Sample, E: Encoding> Image<T, E> {
    /// This image as a view, for reading.
    #[inline]
    pub fn view(&self) -> ImageRef<'_, T, E> {
        let shape = Shape { width: self.width, height: self.height, stride: 3 * self.width };
        ImageRef { shape, samples: &self.samples, encoding: PhantomData }
    }

    /// This image as a view, for writing.
    #[inline]
    pub fn view_mut(&mut self) -> ImageMut<'_, T, E> {
        let shape = Shape { width: self.width, height: self.height, stride: 3 * self.width };
        ImageMut { shape, samples: &mut self.samples, encoding: PhantomData }
    }
}

#[cfg(test)]
mod tests;
