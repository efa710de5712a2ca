//! How good an image looks, by scores that need no other image.

use aquafuse::image::Image;
use aquafuse::metrics::{uciqe, uiqm};
use serde::Serialize;

/// Scores of one image; for each but lightness, more is held to be better. All are fooled by oversaturation and noise.
///
/// # Examples
///
/// ```
/// use aquafuse::image::Image;
/// use aquafuse_data::pipeline::Scores;
///
/// let flat: Image<u8> = Image::from_raw(10, 10, [90, 90, 90].repeat(100))?;
/// let found = Scores::of(&flat);
/// assert_eq!((found.contrast, found.sharpness, found.lightness), (0.0, Some(0.0), 90.0 / 255.0));
/// # Ok::<(), aquafuse::image::ImageError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Scores {
    /// UCIQE.
    pub uciqe: f64,
    /// UIQM; `None` for images smaller than its blocks of 10 x 10.
    pub uiqm: Option<f64>,
    /// Deviation of chroma, the first part of UCIQE.
    pub colour: f64,
    /// Lightness of the lightest less that of the darkest hundredth, the second part of UCIQE.
    pub contrast: f64,
    /// UISM, the second part of UIQM.
    pub sharpness: Option<f64>,
    /// Mean of all values, 0 black and 1 white: whether it came out darker.
    pub lightness: f64,
}

impl Scores {
    /// Scores an image.
    pub fn of(image: &Image<u8>) -> Self {
        let (colour, sharp) = (uciqe(image), uiqm(image));
        Self {
            uciqe: colour.score(),
            uiqm: sharp.map(|parts| parts.score()),
            colour: colour.chroma_deviation,
            contrast: colour.luminance_contrast,
            sharpness: sharp.map(|parts| parts.sharpness),
            lightness: mean(image),
        }
    }
}

/// Mean of all values.
fn mean(image: &Image<u8>) -> f64 {
    let all = image.as_raw();
    let sum = all.iter().fold(0_u64, |sum, value| sum.saturating_add(u64::from(*value)));
    sum as f64 / (255.0 * all.len() as f64)
}
