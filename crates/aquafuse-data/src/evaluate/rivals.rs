//! What others do with colours alone: statistics of the reference put on the content.
//!
//! None of them knows of depth: near and far things take the same colours. They stand beside the physics because they
//! are what is at hand. All work on encoded values, and give values that are neither clipped nor rounded.

mod alone;
mod histogram;
mod matrix;
mod monge_kantorovich;
mod reinhard;

use aquafuse::image::Image;

pub use alone::Alone;

/// A way to give an image the colours of another one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rival {
    /// Mean and deviation of each channel of lαβ (E. Reinhard et al., "Color Transfer between Images", 2001).
    Reinhard,
    /// The linear map of least effort that takes mean and covariance of RGB to the reference's (F. Pitié and A. Kokaram,
    /// "The linear Monge-Kantorovitch linear colour mapping for example-based colour transfer", 2007).
    MongeKantorovich,
    /// Each channel's distribution, by rank.
    Histogram,
    /// Each channel times what makes its mean the reference's: the mean taken for the colour of the light
    /// (G. Buchsbaum, "A spatial processor model for object colour perception", 1980).
    GrayWorld,
}

/// What the rivals read of an image, so that none has to be kept.
#[derive(Clone, Debug)]
pub struct Palette {
    lab: reinhard::Moments,
    rgb: monge_kantorovich::Moments,
    ranks: histogram::Ranks,
}

impl Palette {
    /// Reads an image.
    pub fn of(image: &Image<u8>) -> Self {
        Self {
            lab: reinhard::Moments::of(image),
            rgb: monge_kantorovich::Moments::of(image),
            ranks: histogram::Ranks::of(image),
        }
    }
}

impl Rival {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Reinhard, Self::MongeKantorovich, Self::Histogram, Self::GrayWorld];

    /// The name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Reinhard => "Reinhard",
            Self::MongeKantorovich => "Monge–Kantorovich",
            Self::Histogram => "histogram matching",
            Self::GrayWorld => "gray world",
        }
    }

    /// The content's pixels, `own` read of it, with the colours of the image that `other` was read of.
    ///
    /// # Examples
    ///
    /// ```
    /// use aquafuse::image::Image;
    /// use aquafuse_data::evaluate::{Palette, Rival};
    ///
    /// let dark = Image::<u8>::from_raw(2, 1, vec![10, 20, 30, 30, 40, 50])?;
    /// let light = Image::<u8>::from_raw(2, 1, vec![110, 120, 130, 130, 140, 150])?;
    /// let made = Rival::Histogram.transfer(&dark, &Palette::of(&dark), &Palette::of(&light));
    /// assert_eq!(made[0], [110.0 / 255.0, 120.0 / 255.0, 130.0 / 255.0]);
    /// # Ok::<(), aquafuse::image::ImageError>(())
    /// ```
    pub fn transfer(self, content: &Image<u8>, own: &Palette, other: &Palette) -> Vec<[f32; 3]> {
        match self {
            Self::Reinhard => reinhard::transfer(content, &own.lab, &other.lab),
            Self::MongeKantorovich => monge_kantorovich::transfer(content, &own.rgb, &other.rgb),
            Self::Histogram => histogram::transfer(content, &own.ranks, &other.ranks),
            Self::GrayWorld => gray_world(content, &own.rgb, &other.rgb),
        }
    }

    /// [`Rival::transfer`] as an image: clipped, and rounded to bytes.
    pub fn image(self, content: &Image<u8>, own: &Palette, other: &Palette) -> Image<u8> {
        let made = self.transfer(content, own, other).into_flattened();
        let (width, height) = content.size();
        Image::<f32>::from_raw(width, height, made).expect("a colour for each pixel").convert()
    }
}

/// Each channel times the ratio of the means. A channel without light has no gain.
fn gray_world(
    content: &Image<u8>,
    own: &monge_kantorovich::Moments,
    other: &monge_kantorovich::Moments,
) -> Vec<[f32; 3]> {
    let gain = |c: usize| if own.mean[c] > 0.0 { other.mean[c] / own.mean[c] } else { 1.0 };
    let gains: [f64; 3] = std::array::from_fn(gain);
    let changed = |pixel: &[u8; 3]| {
        let rgb = unit(pixel);
        std::array::from_fn(|c| (rgb[c] * gains[c]) as f32)
    };
    content.pixels().iter().map(changed).collect()
}

/// A pixel in `[0, 1]`.
fn unit(pixel: &[u8; 3]) -> [f64; 3] {
    pixel.map(|value| f64::from(value) / 255.0)
}

#[cfg(test)]
mod tests;
