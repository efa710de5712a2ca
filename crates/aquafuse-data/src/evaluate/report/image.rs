//! Small images, and images as text.

use ::image::RgbImage;
use ::image::imageops::{FilterType, resize};
use aquafuse::image::Image;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use jpeg_encoder::{ColorType, Encoder, SamplingFactor};

/// The most columns and rows of a small image.
const ROOM: [u32; 2] = [216, 162];
const QUALITY: u8 = 88;

/// The image, as large as fits side by side with others on a page.
pub fn thumbnail(image: &Image<u8>) -> Image<u8> {
    let sides = [image.width(), image.height()].map(|side| u32::try_from(side).unwrap_or(u32::MAX));
    let [wide, high] = sides.map(f64::from);
    let scale = (f64::from(ROOM[0]) / wide).min(f64::from(ROOM[1]) / high).min(1.0);
    let Some(image_file) = RgbImage::from_raw(sides[0], sides[1], image.as_raw().to_vec()) else {
        return image.clone();
    };
    let small = resize(&image_file, scaled(wide, scale), scaled(high, scale), FilterType::Triangle);
    let (width, height) = (small.width() as usize, small.height() as usize);
    Image::from_raw(width, height, small.into_raw()).expect("as many pixels as it was made with")
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "sides of at most 216 pixels")]
fn scaled(side: f64, scale: f64) -> u32 {
    ((side * scale).round() as u32).max(1)
}

/// The image as a JPEG embedded in a page.
pub(super) fn data_uri(image: &Image<u8>) -> String {
    let [width, height] = [image.width(), image.height()].map(|side| u16::try_from(side).unwrap_or(u16::MAX));
    let mut jpeg = Vec::new();
    let mut encoder = Encoder::new(&mut jpeg, QUALITY);
    encoder.set_sampling_factor(SamplingFactor::F_1_1);
    let written = encoder.encode(image.as_raw(), width, height, ColorType::Rgb);
    written.expect("a small image of bytes fits into a JPEG");
    format!("data:image/jpeg;base64,{}", BASE64_STANDARD.encode(&jpeg))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thumbnail_keeps_the_shape_and_is_never_larger_than_the_image() {
        let of = |width: usize, height: usize| {
            thumbnail(&Image::<u8>::from_raw(width, height, vec![90; 3 * width * height]).unwrap()).size()
        };
        assert_eq!(of(1152, 432), (216, 81));
        assert_eq!(of(20, 10), (20, 10));
        assert_eq!(of(2000, 1), (216, 1));
    }
}
