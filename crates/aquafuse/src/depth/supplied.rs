//! Depth that comes with an image: raw values of a declared kind, made into a [`DepthMap`].
//!
//! Nothing is guessed: the kind is declared, the size must be the image's, and values that are none are found
//! by one rule ([`SuppliedKind`]), counted, and filled from what is valid beside them and from colour.

mod agreement;
mod holes;
mod kind;

pub use kind::SuppliedKind;

use super::{DepthKind, DepthMap, DepthModel};
use crate::image::{ImageError, ImageRef, TopEdge, check_same_size, check_size};
use crate::scene_area::SceneArea;

/// Raw values of a depth map, as a file or a sensor gives them, and what they are declared to be.
///
/// # Examples
///
/// ```
/// use aquafuse::depth::{Supplied, SuppliedKind};
/// use aquafuse::image::Image;
///
/// let image = Image::<u8>::from_raw(4, 1, [[90, 90, 90]; 4].concat())?;
/// let values = vec![500.0, 1000.0, 2000.0, 4000.0];
/// let map = Supplied::new(4, 1, values, SuppliedKind::Millimetres)?;
/// let found = map.seen_with(&image, Default::default())?;
/// assert_eq!(found.depth.distances(), [0.5, 1.0, 2.0, 4.0]);
/// assert_eq!(found.report.invalid, 0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Supplied {
    width: usize,
    height: usize,
    values: Vec<f32>,
    kind: SuppliedKind,
    full_range: f32,
}

/// Supplied depth, ready for use, and what had to be done to it.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct SuppliedDepth {
    /// Distances: metres for metric kinds, relative for the others.
    pub depth: DepthMap,
    /// What is worth knowing about them.
    pub report: SuppliedReport,
}

/// What is worth knowing about supplied depth.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SuppliedReport {
    /// What the values were declared to be.
    pub kind: SuppliedKind,
    /// Pixels without a valid value, whose depth comes from colour.
    pub invalid: u64,
    /// All pixels.
    pub pixels: u64,
    /// Rank correlation, in `[-1, 1]`, of the valid depth with what the image itself says: colour depth, and
    /// that the far is higher up. None when one of them has no order.
    pub agreement: Option<f64>,
}

/// Agreement below this looks like a map inverted. On 26 real pairs maps declared rightly lie at .09 or above, so
/// they stay quiet with room to spare; nearer to 0 more turned maps would be caught, and level or down-looking views
/// would be blamed.
const TURNED_ROUND: f64 = -0.2;

impl SuppliedReport {
    /// Share of the pixels without a valid value.
    pub fn invalid_share(&self) -> f64 {
        self.invalid as f64 / self.pixels.max(1) as f64
    }

    /// Whether near and far look swapped: large values seem near although the declared kind says far, or the reverse.
    ///
    /// A hint to a person: views from above and images without red may deserve it wrongly.
    pub fn looks_inverted(&self) -> bool {
        self.agreement.is_some_and(|agreement| agreement < TURNED_ROUND)
    }
}

/// Supplied depth does not suit its image or its kind.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SuppliedError {
    /// The map has another size than the image.
    #[error(
        "the map is {}x{}, the image {}x{}{}",
        .map.0, .map.1, .image.0, .image.1,
        if (map.1, map.0) == *image { "; turned by 90° it would fit" } else { "" }
    )]
    Size {
        /// Columns and rows of the map.
        map: (usize, usize),
        /// Columns and rows of the image.
        image: (usize, usize),
    },
    /// A value is larger than its kind allows.
    #[error("the value at column {x}, row {y} is {value}, but relative depth lies between 0 and 1")]
    AboveOne {
        /// Column.
        x: usize,
        /// Row.
        y: usize,
        /// What stands there.
        value: f32,
    },
    /// So few values are valid that nothing can be said about the rest.
    #[error("{valid} of its {pixels} values are valid, and at least {least} are needed")]
    TooFewValid {
        /// Valid values.
        valid: usize,
        /// All values.
        pixels: usize,
        /// Valid values needed.
        least: usize,
    },
    /// All valid values are one, and its kind has no scale of its own.
    #[error("all its values are {value}, which has no scale to read a distance from")]
    Flat {
        /// The value.
        value: f32,
    },
}

impl Supplied {
    /// Takes raw values, row by row from the top, as what `kind` says.
    ///
    /// # Errors
    ///
    /// [`ImageError`] when a side is zero or the buffer has another length.
    pub fn new(
        width: usize,
        height: usize,
        values: Vec<f32>,
        kind: SuppliedKind,
    ) -> Result<Self, ImageError> {
        check_size(width, height, 1, values.len())?;
        Ok(Self { width, height, values, kind, full_range: 1.0 })
    }

    /// Says that the values are whole numbers whose full range ends at `most` (65535 for 16 bits): that is 1 in
    /// relative depth. Other kinds do not read it.
    #[must_use]
    pub fn with_full_range(mut self, most: f32) -> Self {
        self.full_range = most;
        self
    }

    /// The values of the scene alone: those within the margins of `area`.
    ///
    /// # Errors
    ///
    /// [`ImageError`] when the area belongs to an image of another size.
    pub fn cut(self, area: &SceneArea) -> Result<Self, ImageError> {
        check_same_size(area.image_size(), (self.width, self.height))?;
        let (width, height) = area.size();
        Ok(Self { width, height, values: area.cut_values(self.values), ..self })
    }

    /// What the values were declared to be.
    pub fn kind(&self) -> SuppliedKind {
        self.kind
    }

    /// Columns and rows.
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// The depth map of `image`, of which `top` is the edge that is up as seen.
    ///
    /// Valid values are converted by their kind. Where there is none, z goes on from the valid pixels beside it, as far as the image
    /// shows no edge. Beyond that it comes from colour ([`DepthModel::Ratio`]), taken to the map's unit by a rising curve through
    /// the valid pixels; colours farther than theirs are open water and lie beyond the far end of the map. A restoration goes no
    /// farther than that end, for beyond it z is a guess.
    ///
    /// # Errors
    ///
    /// [`SuppliedError`] when the sizes differ, relative depth exceeds 1, fewer than 1 % of the pixels (or 100, or
    /// half of an image of fewer than 200) are valid, or inverse depth or disparity is all one value.
    pub fn seen_with<'a>(
        &self,
        image: impl Into<ImageRef<'a, u8>>,
        top: TopEdge,
    ) -> Result<SuppliedDepth, SuppliedError> {
        let image = image.into();
        let valid = self.valid_in(image.size())?;
        // Colour needs something to be taken to the map's unit by.
        let (count, pixels) = (valid.iter().filter(|valid| **valid).count(), valid.len());
        let least = pixels.div_ceil(100).max(pixels.div_ceil(2).min(100));
        if count < least {
            return Err(SuppliedError::TooFewValid { valid: count, pixels, least });
        }
        let mut distances = self.kind.to_distances(&self.values, &valid, self.full_range)?;
        let colour = DepthModel::Ratio.estimate(image);
        let quantised = colour.quantised();
        let levels = &*quantised.levels;
        let agreement = agreement::with_image(&distances, &valid, levels, image.size(), top);
        let invalid = pixels - count;
        let guesses = (invalid > 0).then(|| {
            let most = if self.kind.is_metric() { f32::MAX } else { 1.0 };
            holes::fill(image, &mut distances, &valid, levels, most)
        });
        let report =
            SuppliedReport { kind: self.kind, invalid: invalid as u64, pixels: pixels as u64, agreement };
        let kind = if self.kind.is_metric() { DepthKind::Metres } else { DepthKind::Relative };
        let depth = DepthMap::from_distances(self.width, self.height, kind, distances)
            .expect("valid values and filled ones are in range");
        let depth = if self.kind == SuppliedKind::Inverse { depth.turned_from_inverse() } else { depth };
        let depth = match guesses {
            Some(guesses) => depth.with_guesses(guesses),
            None => depth,
        };
        Ok(SuppliedDepth { depth, report })
    }

    /// The distances of the pixels of `image`, converted by their kind; NaN where there is no valid value.
    ///
    /// Nothing is filled in, however few are valid: these are labels to fit a depth model to
    /// ([`Fitter`](super::fit::Fitter)), and what colour says must not come back as measured. The conversion is that
    /// of fusion. What it leaves open for inverse depth and disparity, a scale or a shift of each image, is what
    /// a fit image by image leaves open as well; only [`Scale::Shared`](super::fit::Scale::Shared) must not be
    /// fitted to them.
    ///
    /// # Errors
    ///
    /// [`SuppliedError`] when the sizes differ, relative depth exceeds 1, or inverse depth or disparity is all one
    /// value.
    ///
    /// # Examples
    ///
    /// ```
    /// use aquafuse::depth::{Supplied, SuppliedKind};
    /// use aquafuse::image::Image;
    ///
    /// let image = Image::<u8>::from_raw(3, 1, vec![90; 9])?;
    /// let labels = Supplied::new(3, 1, vec![0.0, 1.5, 2.0], SuppliedKind::Metres)?.labels(&image)?;
    /// assert!(labels[0].is_nan());
    /// assert_eq!(labels[1..], [1.5, 2.0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn labels<'a>(&self, image: impl Into<ImageRef<'a, u8>>) -> Result<Vec<f32>, SuppliedError> {
        let valid = self.valid_in(image.into().size())?;
        let mut labels = self.kind.to_distances(&self.values, &valid, self.full_range)?;
        for (label, _) in labels.iter_mut().zip(&valid).filter(|(_, valid)| !**valid) {
            *label = f32::NAN;
        }
        Ok(labels)
    }

    /// Which values are valid for an image: its size must be theirs, and none may be above what its kind allows.
    fn valid_in(&self, image: (usize, usize)) -> Result<Vec<bool>, SuppliedError> {
        let map = (self.width, self.height);
        if map != image {
            return Err(SuppliedError::Size { map, image });
        }
        let valid: Vec<bool> = self.values.iter().map(|&value| self.kind.is_valid(value)).collect();
        if self.kind == SuppliedKind::Relative
            && let Some(i) = (0..valid.len()).find(|&i| valid[i] && self.values[i] > self.full_range)
        {
            let (x, y) = (i % self.width, i / self.width);
            return Err(SuppliedError::AboveOne { x, y, value: self.values[i] });
        }
        Ok(valid)
    }
}

#[cfg(test)]
mod tests;
