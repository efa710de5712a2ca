//! Buffers of the crate `image`: views of them without a copy, and images made of ours.
//!
//! Their values are taken as encoded (sRGB), as files hold them.

use std::ops::{Deref, DerefMut};

use ::image::{DynamicImage, ImageBuffer, Pixel, Rgb};

use crate::image::{Image, ImageError, ImageMut, ImageRef, Sample};

/// A view of `RgbImage`, of `Rgb32FImage` or of a buffer of 16 bits. An error where it has no pixels.
impl<'a, T, C> TryFrom<&'a ImageBuffer<Rgb<T>, C>> for ImageRef<'a, T>
where
    T: Sample,
    Rgb<T>: Pixel<Subpixel = T>,
    C: Deref<Target = [T]>,
{
    type Error = ImageError;

    fn try_from(buffer: &'a ImageBuffer<Rgb<T>, C>) -> Result<Self, ImageError> {
        let [width, height] = [buffer.width(), buffer.height()].map(|side| side as usize);
        Self::new(width, height, buffer)
    }
}

/// The same for writing.
impl<'a, T, C> TryFrom<&'a mut ImageBuffer<Rgb<T>, C>> for ImageMut<'a, T>
where
    T: Sample,
    Rgb<T>: Pixel<Subpixel = T>,
    C: DerefMut<Target = [T]>,
{
    type Error = ImageError;

    fn try_from(buffer: &'a mut ImageBuffer<Rgb<T>, C>) -> Result<Self, ImageError> {
        let [width, height] = [buffer.width(), buffer.height()].map(|side| side as usize);
        Self::new(width, height, buffer)
    }
}

impl<T: Sample> From<Image<T>> for ImageBuffer<Rgb<T>, Vec<T>>
where
    Rgb<T>: Pixel<Subpixel = T>,
{
    fn from(image: Image<T>) -> Self {
        let [width, height] = [image.width(), image.height()].map(|side| u32::try_from(side).ok());
        let buffer =
            width.zip(height).and_then(|(width, height)| Self::from_raw(width, height, image.into_raw()));
        buffer.expect("a side of more than 2^32 pixels is out of reach of the crate `image`")
    }
}

macro_rules! dynamic_image {
    ($sample:ty, $into_rgb:ident, $variant:ident) => {
        /// The colours of any image; what is stored in another way is converted, and alpha is dropped. An error
        /// where it has no pixels.
        impl TryFrom<DynamicImage> for Image<$sample> {
            type Error = ImageError;

            fn try_from(image: DynamicImage) -> Result<Self, ImageError> {
                let [width, height] = [image.width(), image.height()].map(|side| side as usize);
                Self::from_raw(width, height, image.$into_rgb().into_raw())
            }
        }

        impl From<Image<$sample>> for DynamicImage {
            fn from(image: Image<$sample>) -> Self {
                Self::$variant(image.into())
            }
        }
    };
}

dynamic_image!(u8, into_rgb8, ImageRgb8);
dynamic_image!(u16, into_rgb16, ImageRgb16);
dynamic_image!(f32, into_rgb32f, ImageRgb32F);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fuser::Fuser;
    use crate::truth::{Scene, Size, waters};
    use ::image::{GrayImage, RgbImage};

    fn seen(seed: u64) -> Image<f32> {
        Scene::new(seed, Size { width: 40, height: 30 }).seen_through(&waters()[0].water)
    }

    fn check<T: Sample>()
    where
        Rgb<T>: Pixel<Subpixel = T>,
    {
        let (content, reference) = (seen(1).convert::<T>(), seen(2).convert::<T>());
        let expected = Fuser::new(&reference).unwrap().fuse(&content).unwrap();
        let [mut theirs, theirs_too] = [content.clone(), reference].map(ImageBuffer::<Rgb<T>, Vec<T>>::from);
        let fuser = Fuser::new(&theirs_too).unwrap();
        assert_eq!(fuser.fuse(&theirs).unwrap(), expected);
        let place = theirs.as_ptr();
        assert_eq!(fuser.fuse_mut(&mut theirs), Ok(expected.report));
        assert_eq!((theirs.as_ptr(), theirs.as_raw().as_slice()), (place, expected.image.as_raw()));
    }

    #[test]
    fn buffers_of_all_three_samples_are_fused_as_ours_are_and_without_a_copy() {
        check::<u8>();
        check::<u16>();
        check::<f32>();
    }

    #[test]
    fn any_dynamic_image_becomes_colours_and_comes_back() {
        let image = seen(1).convert::<u8>();
        let there = DynamicImage::from(image.clone());
        assert_eq!(Image::<u8>::try_from(there), Ok(image));
        let grey = DynamicImage::ImageLuma8(GrayImage::from_pixel(2, 1, ::image::Luma([7])));
        assert_eq!(Image::<u8>::try_from(grey.clone()).unwrap().as_raw(), [7; 6]);
        assert_eq!(Image::<u16>::try_from(grey).unwrap().as_raw(), [7 * 257; 6]);
    }

    #[test]
    fn an_image_without_pixels_is_an_error() {
        let mut empty = RgbImage::new(0, 4);
        let error = ImageError::Empty { width: 0, height: 4 };
        assert_eq!(Fuser::new(&empty).unwrap_err(), error);
        assert_eq!(ImageMut::try_from(&mut empty).unwrap_err(), error);
        assert!(Image::<u8>::try_from(DynamicImage::from(empty)).is_err());
    }
}
