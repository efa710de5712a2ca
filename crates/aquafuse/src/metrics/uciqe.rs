//! UCIQE, underwater colour image quality without a reference.

use super::lab::{lab_of_light, light_of_bytes};
use crate::image::{Encoding, ImageRef, Linear, Sample};
use crate::simd;

/// The three parts of UCIQE.
///
/// M. Yang and A. Sowmya, "An underwater color image quality evaluation metric" (2015). The publication leaves
/// units open, and implementations differ in them (L, a, b over 255 or not at all, saturation of HSV, extremes
/// for percentiles): compare only numbers of one implementation. Ours, from encoded sRGB to CIELab (D65, 2°):
///
/// - L* and C* = √(a*² + b*²) are taken over 100;
/// - saturation is C* / √(C*² + L*²), M. Lübbe's, and 0 for black;
/// - the top and bottom 1 % of L* are its values at these ranks, not means over them.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Uciqe {
    /// σ_c, standard deviation of chroma; 0 for grey, hardly above .5.
    pub chroma_deviation: f64,
    /// con_l, lightness that 1 % of the pixels reach less that 1 % do not exceed, in `[0, 1]`.
    pub luminance_contrast: f64,
    /// μ_s, mean saturation, in `[0, 1]`.
    pub saturation: f64,
}

impl Uciqe {
    /// `.4680 σ_c + .2745 con_l + .2576 μ_s`, most often .3 to .6, higher for more colour and contrast.
    pub fn score(&self) -> f64 {
        0.4680 * self.chroma_deviation + 0.2745 * self.luminance_contrast + 0.2576 * self.saturation
    }
}

/// Underwater colour image quality of one image; see [`Uciqe`] for what is summed.
///
/// It rewards colour and contrast, whether true or not: an oversaturated image scores high.
///
/// # Examples
///
/// ```
/// use aquafuse::{image::Image, metrics::uciqe};
///
/// let greys: Image<u8> = Image::from_raw(2, 1, [[0; 3], [255; 3]].concat())?;
/// let found = uciqe(&greys);
/// // From black to white, and no colour (the matrix of sRGB is rounded, so white is not quite).
/// assert!((found.luminance_contrast - 1.0).abs() < 1e-6 && found.saturation < 1e-4);
/// # Ok::<(), aquafuse::image::ImageError>(())
/// ```
#[must_use]
pub fn uciqe<'a, T: Sample>(image: impl Into<ImageRef<'a, T>>) -> Uciqe {
    let image = image.into();
    let [chroma, mut lightness] = match image.as_bytes() {
        Some(bytes) => {
            let light = light_of_bytes();
            colours(bytes, |byte| light[usize::from(byte)])
        }
        None => colours(image, |value| Linear::from_encoded(value.to_unit())),
    };
    let count = chroma.len() as f64;
    let mean = chroma.iter().sum::<f64>() / count;
    let variance = chroma.iter().map(|chroma| (chroma - mean).powi(2)).sum::<f64>() / count;
    let saturation = |(c, l): (&f64, &f64)| if *c > 0.0 { c / (c * c + l * l).sqrt() } else { 0.0 };
    let saturation = chroma.iter().zip(&lightness).map(saturation).sum::<f64>() / count;
    let percent = lightness.len().div_ceil(100);
    let most = lightness.len() - percent;
    let mut at = |rank: usize| *lightness.select_nth_unstable_by(rank, f64::total_cmp).1;
    Uciqe { chroma_deviation: variance.sqrt(), luminance_contrast: at(most) - at(percent - 1), saturation }
}

/// Pixels that are computed with at once.
const BLOCK: usize = 64;

/// Chroma and lightness of each pixel, over 100, by the light behind a value.
fn colours<T: Sample>(image: ImageRef<'_, T>, light_of: impl Fn(T) -> f32) -> [Vec<f64>; 2] {
    let pixels = image.width() * image.height();
    let mut found = [Vec::with_capacity(pixels), Vec::with_capacity(pixels)];
    let mut light = [[0.0_f32; 3]; BLOCK];
    for y in 0..image.height() {
        for pixels in image.row(y).chunks(BLOCK) {
            for (light, pixel) in light.iter_mut().zip(pixels) {
                *light = pixel.map(&light_of);
            }
            for (found, block) in found.iter_mut().zip(simd::widest(Colours(&light))) {
                found.extend(&block[..pixels.len()]);
            }
        }
    }
    found
}

/// Chroma and lightness of a block of linear light.
struct Colours<'a>(&'a [[f32; 3]; BLOCK]);

impl simd::Work for Colours<'_> {
    type Output = [[f64; BLOCK]; 2];

    #[inline(always)]
    fn run(self) -> Self::Output {
        let [mut chroma, mut lightness] = [[0.0; BLOCK]; 2];
        for i in 0..BLOCK {
            let [l, a, b] = lab_of_light(self.0[i]);
            (chroma[i], lightness[i]) = ((a * a + b * b).sqrt() / 100.0, l / 100.0);
        }
        [chroma, lightness]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Image;
    use proptest::prelude::*;

    fn image(pixels: &[[u8; 3]]) -> Image<u8> {
        Image::from_raw(pixels.len(), 1, pixels.concat()).unwrap()
    }

    #[test]
    fn one_pixel_in_a_hundred_may_be_anything() {
        let mut pixels = vec![[100; 3]; 99];
        pixels.extend([[200; 3]; 99]);
        let before = uciqe(&image(&pixels)).luminance_contrast;
        pixels.extend([[0; 3], [255; 3]]);
        assert_eq!(uciqe(&image(&pixels)).luminance_contrast, before);
    }

    proptest! {
        #[test]
        fn grey_has_no_colour(greys: [u8; 16]) {
            let found = uciqe(&image(&greys.map(|grey| [grey; 3])));
            prop_assert!(found.chroma_deviation < 1e-4 && found.saturation < 1e-3, "{:?}", found);
        }

        #[test]
        fn more_contrast_never_lowers_con_l(greys: [u8; 16]) {
            // All values drawn half the way to grey.
            let of = |greys: [u8; 16]| uciqe(&image(&greys.map(|grey| [grey; 3]))).luminance_contrast;
            let (full, half) = (of(greys), of(greys.map(|grey| 64 + grey / 2)));
            // Halves of odd steps are rounded: a step of a byte is at most .004 of lightness.
            prop_assert!(half <= full + 0.004, "{half} of {full}");
        }

        #[test]
        fn the_order_of_the_pixels_does_not_matter(pixels: [[u8; 3]; 16]) {
            let mut turned = pixels;
            turned.reverse();
            prop_assert!((uciqe(&image(&pixels)).score() - uciqe(&image(&turned)).score()).abs() < 1e-12);
        }

        #[test]
        fn the_parts_lie_in_their_ranges(pixels: [[u8; 3]; 16]) {
            let found = uciqe(&image(&pixels));
            prop_assert!((0.0..0.7).contains(&found.chroma_deviation));
            prop_assert!((0.0..=1.0).contains(&found.luminance_contrast) && (0.0..=1.0).contains(&found.saturation));
        }
    }
}
