//! Fits the coefficients of Eq. 3 to images whose depth is known (Eq. 4).
//!
//! The laws of [`Eq3`] hold by construction: with `g_k(R) = (e^(kR) - e^k) / (1 - e^k)`, which falls from 1 to 0
//! for every k, and `h_k(M) = (1 - e^(kM)) / (1 - e^k)`, which rises from 0 to 1,
//!
//! > d = w g_μ2(R) + (1 - w) h_μ4(M),  0 <= w <= 1
//!
//! is Eq. 3 with depth spanning `[0, 1]` over the colour cube. Scale and shift of the labels and w are linear
//! and eliminated in closed form (variable projection, Golub and Pereyra 1973); what is searched is (μ2, μ4), from
//! several starts. Outliers are held off twice: each colour of an image is represented by the median of its
//! labels, and colours that disagree with the rest count by Huber's weights (Huber 1964).

mod cells;
mod doubt;
mod search;
mod terms;

pub use doubt::Doubt;

use super::Eq3;
use crate::image::{ImageError, ImageRef, Sample};
use cells::LabelledImage;
use search::Search;

/// Gathers images with known depth, one at a time, and fits Eq. 3 to them.
///
/// An image is kept as at most 4096 colours, 80 kB, however many pixels it has: ten thousand fit in
/// memory. Nothing depends on the order in which images are added but the order of their scores.
///
/// # Examples
///
/// ```
/// use aquafuse::depth::{Eq3, fit::{Fitter, Options}};
/// use aquafuse::image::Image;
///
/// // All pairs of red and blue, each with the depth that a known model gives it, in metres.
/// let samples: Vec<u8> = (0..64 * 64).flat_map(|i| [4 * (i % 64) as u8, 0, 4 * (i / 64) as u8]).collect();
/// let metres: Vec<f32> = samples
///     .chunks(3)
///     .map(|rgb| 12.0 * Eq3::OURS.depth(f64::from(rgb[0]) / 255.0, f64::from(rgb[2]) / 255.0) as f32)
///     .collect();
/// let mut fitter = Fitter::new(Options::default());
/// fitter.add(&Image::from_raw(64, 64, samples)?, &metres)?;
/// let fit = fitter.solve()?;
/// assert!((fit.eq3.depth(0.2, 0.6) - Eq3::OURS.depth(0.2, 0.6)).abs() < 0.01);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Fitter {
    options: Options,
    images: Vec<LabelledImage>,
}

/// How to fit.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Options {
    /// What the labels of different images have in common. Default: nothing but the kind of number.
    pub scale: Scale,
    /// What of the labels is fitted to. Default: the distances.
    pub target: Target,
    /// Residual from which on Huber's loss grows linearly, in units of the labels' own spread. Default 0.5. It
    /// matters little: on the measured pairs, values from 0.2 to 3 move the rank score on places left out by .02.
    pub huber: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self { scale: Scale::PerImage, target: Target::Distances, huber: 0.5 }
    }
}

impl Options {
    /// The same with another kind of scale.
    #[must_use]
    pub fn with_scale(self, scale: Scale) -> Self {
        Self { scale, ..self }
    }

    /// The same with another target.
    #[must_use]
    pub fn with_target(self, target: Target) -> Self {
        Self { target, ..self }
    }

    /// The same with another residual from which on the loss grows linearly.
    #[must_use]
    pub fn with_huber(self, huber: f64) -> Self {
        Self { huber, ..self }
    }
}

/// What the labels of different images have in common.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Scale {
    /// Each image has a scale and a shift of its own: relative labels, or metres in different waters.
    #[default]
    PerImage,
    /// One scale and one shift for all: metres in one water.
    Shared,
}

/// What of the labels is fitted to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Target {
    /// Their distances: depth becomes as even as it can be.
    #[default]
    Distances,
    /// Their order within each image: each label counts as the share of labels below it. Whatever rising
    /// function of distance the labels are, the fit is the same, and the rank score is higher.
    Order,
}

/// Labels that cannot be fitted to.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LabelError {
    /// Image and labels differ in size.
    #[error(transparent)]
    Size(#[from] ImageError),
    /// Hardly any pixel has a label.
    #[error("only {found} pixels have a depth; at least {least} are needed")]
    Few {
        /// Pixels with a label.
        found: usize,
        /// Pixels needed.
        least: usize,
    },
    /// All labels are the same.
    #[error("all depths are {value}; there is no order to learn")]
    Flat {
        /// The depth.
        value: f32,
    },
}

/// Nothing can be fitted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// No image was added.
    #[error("there is no image to fit to")]
    NoImages,
    /// Turned round, the labels would agree better with the laws of the model: depth falls where water
    /// should make it rise.
    #[error(
        "in the {images} images depth falls rather than rises as red fades against green and blue; if larger \
         labels are nearer, declare them as inverse depth or disparity"
    )]
    Backwards {
        /// Images.
        images: usize,
    },
}

/// A fitted model and how far to trust it.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Fit {
    /// The coefficients.
    pub eq3: Eq3,
    /// Mean of the rank scores.
    pub rank_score: f64,
    /// Spearman's correlation of the model with the labels of each image, in the order of adding; 0 where
    /// the model distinguishes nothing.
    pub rank_scores: Vec<f64>,
    /// Huber's loss, mean over images, in units of the labels' spread squared.
    pub loss: f64,
    /// The searches, best first.
    pub starts: Vec<Start>,
    /// What speaks against the fit.
    pub doubts: Vec<Doubt>,
}

/// One search for (μ2, μ4).
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Start {
    /// (μ2, μ4) at which it began.
    pub from: [f64; 2],
    /// (μ2, μ4) at which it ended.
    pub reached: [f64; 2],
    /// Loss there.
    pub loss: f64,
}

impl Fitter {
    /// A fitter without images.
    pub fn new(options: Options) -> Self {
        Self { options, images: Vec::new() }
    }

    /// Adds an image with the depth of each of its pixels, row by row; larger is farther, in any unit. What is
    /// no finite number (NaN, say) is a pixel without a label.
    ///
    /// # Errors
    ///
    /// [`LabelError`] when the sizes differ, or there are too few labels or only one value of them.
    pub fn add<'a, T: Sample>(
        &mut self,
        image: impl Into<ImageRef<'a, T>>,
        distances: &[f32],
    ) -> Result<(), LabelError> {
        self.add_weighted(image, distances, 1.0)
    }

    /// Adds an image that counts as `weight` images: of three of one place, each a third, so that the place
    /// counts once. A weight that is no number above 0 counts as nothing.
    ///
    /// # Errors
    ///
    /// As [`Fitter::add`].
    pub fn add_weighted<'a, T: Sample>(
        &mut self,
        image: impl Into<ImageRef<'a, T>>,
        distances: &[f32],
        weight: f64,
    ) -> Result<(), LabelError> {
        let weight = if weight.is_finite() { weight.max(0.0) } else { 0.0 };
        self.images.push(LabelledImage::gather(image.into(), distances, weight)?);
        Ok(())
    }

    /// Adds all images of another fitter behind its own: for fitters filled on several threads.
    pub fn merge(&mut self, other: Self) {
        self.images.extend(other.images);
    }

    /// Images added.
    pub fn images(&self) -> usize {
        self.images.len()
    }

    /// Spearman's correlation of a model with the labels of each image, in the order of adding. Nearly equal
    /// colours count as equal here, so that it comes out a few hundredths low.
    pub fn rank_scores(&self, eq3: &Eq3) -> Vec<f64> {
        self.images.iter().map(|labelled| labelled.rank_score(eq3)).collect()
    }

    /// Fits Eq. 3 to what was added.
    ///
    /// # Errors
    ///
    /// [`FitError`] when there is nothing to fit to, or the labels contradict the laws of the model.
    pub fn solve(&self) -> Result<Fit, FitError> {
        if self.images.is_empty() {
            return Err(FitError::NoImages);
        }
        let search = Search::new(&self.images, &self.options);
        let (best, starts) = search.run();
        if best.explains_nothing || search.would_rather_be_turned_round(&best) {
            return Err(FitError::Backwards { images: self.images.len() });
        }
        let eq3 = best.terms.eq3();
        let rank_scores = self.rank_scores(&eq3);
        Ok(Fit {
            eq3,
            rank_score: rank_scores.iter().sum::<f64>() / rank_scores.len() as f64,
            loss: best.loss,
            starts,
            doubts: Doubt::about(&best.terms, &rank_scores),
            rank_scores,
        })
    }
}

#[cfg(test)]
mod tests;
