//! Arrays of the crate `ndarray`, of shape (height, width, 3): views of contiguous ones without a copy, and images
//! made of any.
//!
//! Their values are taken as encoded (sRGB).

use ::ndarray::{Array3, ArrayBase, ArrayView3, ArrayViewMut3, Data, DataMut, Ix3};

use crate::image::{Image, ImageError, ImageMut, ImageRef, Sample};

/// Columns and rows of an array of pixels.
fn size((height, width, channels): (usize, usize, usize)) -> Result<(usize, usize), ImageError> {
    if channels == 3 { Ok((width, height)) } else { Err(ImageError::Channels { found: channels }) }
}

/// A view of an array in standard layout; [`ImageError::Layout`] where it is sliced, transposed or reversed.
impl<'a, T: Sample> TryFrom<ArrayView3<'a, T>> for ImageRef<'a, T> {
    type Error = ImageError;

    fn try_from(array: ArrayView3<'a, T>) -> Result<Self, ImageError> {
        let (width, height) = size(array.dim())?;
        Self::new(width, height, array.to_slice().ok_or(ImageError::Layout)?)
    }
}

/// The same of an array that is borrowed.
impl<'a, T: Sample, S: Data<Elem = T>> TryFrom<&'a ArrayBase<S, Ix3>> for ImageRef<'a, T> {
    type Error = ImageError;

    fn try_from(array: &'a ArrayBase<S, Ix3>) -> Result<Self, ImageError> {
        array.view().try_into()
    }
}

/// The same for writing.
impl<'a, T: Sample> TryFrom<ArrayViewMut3<'a, T>> for ImageMut<'a, T> {
    type Error = ImageError;

    fn try_from(array: ArrayViewMut3<'a, T>) -> Result<Self, ImageError> {
        let (width, height) = size(array.dim())?;
        Self::new(width, height, array.into_slice().ok_or(ImageError::Layout)?)
    }
}

/// The same for writing into an array that is borrowed.
impl<'a, T: Sample, S: DataMut<Elem = T>> TryFrom<&'a mut ArrayBase<S, Ix3>> for ImageMut<'a, T> {
    type Error = ImageError;

    fn try_from(array: &'a mut ArrayBase<S, Ix3>) -> Result<Self, ImageError> {
        array.view_mut().try_into()
    }
}

/// A copy of an array in any layout.
impl<T: Sample> TryFrom<ArrayView3<'_, T>> for Image<T> {
    type Error = ImageError;

    fn try_from(array: ArrayView3<'_, T>) -> Result<Self, ImageError> {
        let (width, height) = size(array.dim())?;
        Self::from_raw(width, height, array.iter().copied().collect())
    }
}

impl<T: Sample> From<Image<T>> for Array3<T> {
    fn from(image: Image<T>) -> Self {
        let shape = (image.height(), image.width(), 3);
        Self::from_shape_vec(shape, image.into_raw()).expect("an image holds three samples a pixel")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fuser::Fuser;
    use crate::truth::{Scene, Size, waters};
    use ::ndarray::{Axis, s};

    fn seen(seed: u64) -> Image<f32> {
        Scene::new(seed, Size { width: 40, height: 30 }).seen_through(&waters()[0].water)
    }

    #[test]
    fn arrays_are_fused_as_images_are_and_without_a_copy() {
        let (content, reference) = (seen(1).convert::<u8>(), seen(2).convert::<u8>());
        let expected = Fuser::new(&reference).unwrap().fuse(&content).unwrap();
        let [mut content, reference] = [content, reference].map(Array3::from);
        assert_eq!(content.dim(), (30, 40, 3));
        let fuser = Fuser::new(reference.view()).unwrap();
        assert_eq!(fuser.fuse(&content).unwrap(), expected);
        let place = content.as_ptr();
        assert_eq!(fuser.fuse_mut(content.view_mut()), Ok(expected.report));
        assert_eq!(content.as_ptr(), place);
        assert_eq!(content, Array3::from(expected.image));
    }

    #[test]
    fn what_does_not_lie_row_by_row_is_an_error_and_can_be_copied() {
        let array = Array3::from(seen(1));
        let part = array.slice(s![.., ..20, ..]);
        assert_eq!(ImageRef::try_from(part).unwrap_err(), ImageError::Layout);
        let mut mirrored = array.clone();
        mirrored.invert_axis(Axis(1));
        assert_eq!(ImageMut::try_from(&mut mirrored).unwrap_err(), ImageError::Layout);
        let copy = Image::try_from(part).unwrap();
        assert_eq!((copy.size(), copy.pixels()[21]), ((20, 30), seen(1).row(1)[1]));
    }

    #[test]
    fn arrays_of_another_shape_are_an_error() {
        let four = Array3::<u8>::zeros((5, 7, 4));
        assert_eq!(ImageRef::try_from(&four).unwrap_err(), ImageError::Channels { found: 4 });
        let none = Array3::<u8>::zeros((0, 7, 3));
        assert_eq!(Fuser::new(&none).unwrap_err(), ImageError::Empty { width: 7, height: 0 });
    }
}
