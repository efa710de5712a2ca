//! Global levels: exposure and white balance within bounds, the last step of a restoration and all of an enhancement.
//!
//! The references that people choose for underwater images differ from the images mostly by a few numbers for each channel.
//! These numbers are those of Eq. 2 for water of one distance: what is taken off is the veil, what is multiplied is the gain.

mod measure;
mod power;
mod run;

use crate::image::{Clipping, ImageMut, ImageRef, Sample};

/// Black and white of an image: these shares of a channel may be clipped at either end.
const CLIPPED: f64 = 0.005;
/// White stays a little above the brightest: by this share of what it is below 1.
const HEADROOM: f32 = 0.05;
/// A channel is amplified at most so much: more would show its noise.
const MOST_GAIN: f32 = 5.0;
/// The mean that exponents lead towards, and how far: 0 not at all, 1 to the mean itself.
const MEAN: f32 = 0.46;
const TOWARDS_MEAN: f32 = 0.3;
const EXPONENTS: [f32; 2] = [0.4, 2.5];
/// Share of what red lacks against green that it is given from green.
const RED_FROM_GREEN: f32 = 0.3;
/// Colours become calmer where channels were treated apart: levels make noise colourful.
const CALM: f32 = 0.87;
/// Where red led the other channels by no more than this, it does not lead by more: a little less, since files round. Where it was
/// behind by as much or more, it does not lead at all once distance has been undone.
const LEAD: f32 = 20.0 / 255.0;
const LEAD_MADE: f32 = 16.0 / 255.0;
/// Where red led by more, its lead may grow so many times.
const LEAD_GROWTH: f32 = 2.0;

/// Weights of lightness (BT.601).
const LUMA: [f32; 3] = [0.299, 0.587, 0.114];

/// Whether something is set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum Setting {
    /// By what is found in the image.
    #[default]
    Auto,
    /// It stays as it is.
    None,
}

impl Setting {
    /// Both.
    pub const ALL: &'static [Self] = &[Self::Auto, Self::None];

    /// The name used on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::None => "none",
        }
    }
}

crate::names::named!(Setting, "setting");

/// How levels are set.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct LevelsOptions {
    /// White balance: each channel has levels of its own, so that the colour of the water goes. Otherwise all have the same, and
    /// hues stay.
    pub white: Setting,
    /// Exposure: black and white are where the darkest and the brightest values are, and the mean comes nearer to medium grey.
    /// Otherwise the brightest channel stays as it is.
    pub exposure: Setting,
    /// From 0, the image as it is, to 1, the whole.
    pub strength: f32,
}

impl Default for LevelsOptions {
    /// All of it.
    fn default() -> Self {
        Self { white: Setting::Auto, exposure: Setting::Auto, strength: 1.0 }
    }
}

impl LevelsOptions {
    /// The same with another white balance.
    #[must_use]
    pub fn with_white(self, white: Setting) -> Self {
        Self { white, ..self }
    }

    /// The same with another exposure.
    #[must_use]
    pub fn with_exposure(self, exposure: Setting) -> Self {
        Self { exposure, ..self }
    }

    /// Whether neither is set.
    #[must_use]
    pub fn sets_nothing(&self) -> bool {
        self.white == Setting::None && self.exposure == Setting::None && self.strength == 1.0
    }

    /// The same with another strength, from 0 to 1.
    #[must_use]
    pub fn with_strength(self, strength: f32) -> Self {
        Self { strength, ..self }
    }
}

/// Global levels of an image, per channel red, green, blue: what is done to every pixel, wherever it is.
///
/// Of an encoded value `u` in `[0, 1]`, black b, gain g and exponent γ make `x = clip((u - b) g)`. Where the mean of
/// red is below the mean of green, red is given `r (1 - x_red) x_green`. Then `y = x^γ`, and colours become calmer:
/// `L + s (y - L)`, with L the lightness (BT.601). Red leads green and blue nowhere by more than 20 of 255 levels where it did
/// not lead before.
///
/// - b is the .5 % percentile, `1 / g` the distance to the 99.5 % percentile, which is moved .05 of its way to 1; g is at most 5;
/// - `r = .3 (mean green - mean red)` of x, 0 or more;
/// - `γ = (ln .46 / ln mean)^.3` of x, within .4 and 2.5;
/// - s is .87 where channels have levels of their own, 1 otherwise.
///
/// The numbers were chosen on pairs of underwater images and the references that people voted for (`docs/decisions.md`).
///
/// # Examples
///
/// ```
/// use aquafuse::image::Image;
/// use aquafuse::levels::{Levels, LevelsOptions};
///
/// // A dim image with a blue cast.
/// let row: Vec<u8> = (0..64).flat_map(|x| [60 + x, 80 + 2 * x, 100 + 2 * x]).collect();
/// let mut image = Image::<u8>::from_raw(64, 1, row)?;
/// let levels = Levels::of(&image, &LevelsOptions::default());
/// levels.apply(&mut image);
/// let [r, g, b] = image.pixels()[63];
/// assert!(r > 200 && g > 200 && b > 200);
/// # Ok::<(), aquafuse::image::ImageError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Levels {
    /// What becomes black.
    pub black: [f32; 3],
    /// What is left is multiplied by this.
    pub gain: [f32; 3],
    /// How much red is made from green.
    pub red_from_green: f32,
    /// What values are raised to.
    pub exponent: [f32; 3],
    /// What is left of the difference from grey.
    pub colour: f32,
    /// Whether red is kept from leading where it did not.
    pub holds_red: bool,
    /// From 0, the image as it is, to 1, the whole.
    pub strength: f32,
}

impl Levels {
    /// The levels of an image.
    #[must_use]
    pub fn of<'a, T: Sample>(image: impl Into<ImageRef<'a, T>>, options: &LevelsOptions) -> Self {
        Self::of_restored(image.into(), options, true, &AsItIs)
    }

    /// Sets the levels of an image. Values that become black or white are counted as clipped.
    pub fn apply<'a, T: Sample>(&self, image: impl Into<ImageMut<'a, T>>) -> Clipping {
        self.apply_restored(image.into(), &AsItIs)
    }

    /// The levels of what becomes of each pixel `before` them.
    pub(crate) fn of_restored<T: Sample>(
        image: ImageRef<'_, T>,
        options: &LevelsOptions,
        hold_red: bool,
        before: &impl Before,
    ) -> Self {
        let mut channels = measure::channels(image, before);
        measure::levels(&mut channels, options, hold_red)
    }

    /// Sets the levels of what becomes of each pixel `before` them.
    pub(crate) fn apply_restored<T: Sample>(&self, image: ImageMut<'_, T>, before: &impl Before) -> Clipping {
        run::run(self, image, before)
    }

    /// The levels that give an image this [`lightness`]: one exponent, between .4 and 2.5.
    #[must_use]
    pub fn of_lightness<'a, T: Sample>(image: impl Into<ImageRef<'a, T>>, lightness: f32) -> Self {
        let channels = measure::channels(image.into(), &AsItIs);
        let exponent = measure::exponent_for(&channels, lightness);
        let (black, gain, exponent) = ([0.0; 3], [1.0; 3], [exponent; 3]);
        Self { black, gain, red_from_green: 0.0, exponent, colour: 1.0, holds_red: false, strength: 1.0 }
    }
}

/// The mean lightness (BT.601) of an image, in `[0, 1]`.
#[must_use]
pub fn lightness<'a, T: Sample>(image: impl Into<ImageRef<'a, T>>) -> f32 {
    let channels = measure::channels(image.into(), &AsItIs);
    measure::lightness(&channels, 1.0)
}

/// What becomes of a pixel before its levels are set. A trait and no closure, because its method can be `#[inline(always)]`.
pub(crate) trait Before: Sync {
    /// What part of its lead red may be made to have where it was far behind. A restoration gives red back by distance, and
    /// there it would show where distance is wrong.
    const LEAD_FROM_BEHIND: f32;

    /// The encoded value, not clipped, at a column and a row where the image has the value `raw`.
    fn at(&self, x: usize, y: usize, raw: [f32; 3]) -> [f32; 3];
}

/// Nothing.
struct AsItIs;

impl Before for AsItIs {
    const LEAD_FROM_BEHIND: f32 = 1.0;

    #[inline(always)]
    fn at(&self, _: usize, _: usize, raw: [f32; 3]) -> [f32; 3] {
        raw
    }
}

/// Within `[0, 1]`; a NaN becomes 0.
#[inline(always)]
fn unit(value: f32) -> f32 {
    value.max(0.0).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests;
