//! Small pictures, and pictures as text.

use ::image::codecs::jpeg::JpegEncoder;
use ::image::imageops::{FilterType, resize};
use ::image::{ExtendedColorType, ImageEncoder, RgbImage};
use aquafuse::image::Image;

/// The most columns and rows of a small picture.
const ROOM: [u32; 2] = [216, 162];
const QUALITY: u8 = 88;

/// The picture, as large as fits.
pub(crate) fn thumbnail(image: &Image<u8>) -> Image<u8> {
    let sides = [image.width(), image.height()].map(|side| u32::try_from(side).unwrap_or(u32::MAX));
    let [wide, high] = sides.map(f64::from);
    let scale = (f64::from(ROOM[0]) / wide).min(f64::from(ROOM[1]) / high).min(1.0);
    let Some(picture) = RgbImage::from_raw(sides[0], sides[1], image.as_raw().to_vec()) else {
        return image.clone();
    };
    let small = resize(&picture, scaled(wide, scale), scaled(high, scale), FilterType::Triangle);
    let (width, height) = (small.width() as usize, small.height() as usize);
    Image::from_raw(width, height, small.into_raw()).expect("as many pixels as it was made with")
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "sides of at most 216 pixels")]
fn scaled(side: f64, scale: f64) -> u32 {
    ((side * scale).round() as u32).max(1)
}

/// The picture as a JPEG that stands in a page by itself.
pub(super) fn data_uri(image: &Image<u8>) -> String {
    let sides = [image.width(), image.height()].map(|side| u32::try_from(side).unwrap_or(u32::MAX));
    let mut jpeg = Vec::new();
    let encoder = JpegEncoder::new_with_quality(&mut jpeg, QUALITY);
    let written = encoder.write_image(image.as_raw(), sides[0], sides[1], ExtendedColorType::Rgb8);
    written.expect("a small picture of bytes fits into a JPEG");
    format!("data:image/jpeg;base64,{}", base64(&jpeg))
}

/// RFC 4648.
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let letter = |bits: u32| LETTERS.get((bits & 63) as usize).copied().map_or('=', char::from);
    let mut text = String::new();
    for three in bytes.chunks(3) {
        let byte = |i: usize| three.get(i).copied().map_or(0, u32::from);
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        let filled = |i: usize, shift: u32| if i < three.len() { letter(bits >> shift) } else { '=' };
        text.extend([letter(bits >> 18), letter(bits >> 12), filled(1, 6), filled(2, 0)]);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_is_that_of_the_standard() {
        // Checked with Python's own.
        let cases: [(&[u8], &str); 5] = [
            (&[], ""),
            (&[255], "/w=="),
            (&[255, 254], "//4="),
            (&[251, 239, 190], "++++"),
            (&[0, 1, 2, 3], "AAECAw=="),
        ];
        for (bytes, expected) in cases {
            assert_eq!(base64(bytes), expected);
        }
    }

    #[test]
    fn a_thumbnail_keeps_the_shape_and_is_never_larger_than_the_picture() {
        let of = |width: usize, height: usize| {
            thumbnail(&Image::<u8>::from_raw(width, height, vec![90; 3 * width * height]).unwrap()).size()
        };
        assert_eq!(of(1152, 432), (216, 81));
        assert_eq!(of(20, 10), (20, 10));
        assert_eq!(of(2000, 1), (216, 1));
    }
}
