//! A depth map and what its numbers mean.

mod guesses;
mod steps;

use std::borrow::Cow;

use super::DepthModel;
use crate::bands;
use crate::image::{Encoding, ImageError, ImageMut, Sample, check_same_size, check_size, runs_mut};
use crate::scene_area::SceneArea;
use crate::simd;

pub(crate) use guesses::Guesses;
pub(super) use guesses::{Water, at};
use steps::step_to_z;
pub(crate) use steps::{InSteps, Stepped, TABLE};
pub(super) use steps::{LAST_STEP, step_to_level};

/// Distance from the camera along the line of sight, `z`, one value a pixel.
///
/// **0 is at the camera, larger is farther.** Inverse depth and disparity run the other way: invert them
/// first, or use [`Supplied`](super::Supplied). Depth estimated from colour is kept in even steps of `[0, 1]`: 2041 of them, 65536 of
/// an image of more than 8 bits, 256 by the median alone. Given depth is kept as floats in its own unit.
#[derive(Clone, Debug, PartialEq)]
pub struct DepthMap {
    width: usize,
    height: usize,
    kind: DepthKind,
    model: Option<DepthModel>,
    /// Whether z is 1 less an inverse depth of unknown scale and shift.
    is_inverse: bool,
    /// Where z is a guess, if it is anywhere.
    guesses: Option<Guesses>,
    values: Values,
}

/// What the numbers of a [`DepthMap`] are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
#[non_exhaustive]
pub enum DepthKind {
    /// In `[0, 1]`, without a unit and on its own scale in each image.
    Relative,
    /// Metres.
    Metres,
}

/// A depth map cannot be made from these values.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DepthError {
    /// The buffer and the size disagree.
    #[error(transparent)]
    Size(#[from] ImageError),
    /// A distance is negative, not a number, or beyond what its kind can be.
    #[error("depth at column {x}, row {y} is {value}, but must be from 0 to {most}")]
    Value {
        /// Column.
        x: usize,
        /// Row.
        y: usize,
        /// What stands there.
        value: f32,
        /// The largest distance of this kind.
        most: f32,
    },
}

#[derive(Clone, Debug, PartialEq)]
enum Values {
    /// z = level / 255.
    Levels(Vec<u8>),
    /// z = step / 2040; the levels are the nearest of 256, for those who count.
    Steps {
        steps: Vec<u16>,
        levels: Vec<u8>,
    },
    /// z = level / 65535.
    FineLevels(Vec<u16>),
    Floats(Vec<f32>),
}

/// The memory of a map's steps and levels.
#[derive(Clone, Debug, Default)]
pub(crate) struct Buffers {
    pub(crate) levels: Vec<u8>,
    pub(crate) steps: Vec<u16>,
}

/// Changes pixels one by one, by the law at their depth, and sums up.
struct ChangeAll<'a, P, D, L, C, S> {
    pixels: &'a mut [P],
    depths: &'a [D],
    law: &'a L,
    change: &'a C,
    sum: S,
}

impl<P, D: Copy, V, L: Fn(D) -> V, C: Fn(&mut P, V, &mut S), S> simd::Work for ChangeAll<'_, P, D, L, C, S> {
    type Output = S;

    #[inline(always)]
    fn run(mut self) -> S {
        for (pixel, &depth) in self.pixels.iter_mut().zip(self.depths) {
            (self.change)(pixel, (self.law)(depth), &mut self.sum);
        }
        self.sum
    }
}

/// Depth in even steps.
pub(crate) struct Quantised<'a> {
    pub(crate) levels: Cow<'a, [u8]>,
    /// z of one step, > 0.
    pub(crate) step: f32,
    /// The level that stands for all that lies beyond the steps, if there is one: its z is not known.
    pub(crate) beyond: Option<u8>,
}

/// Share of the farthest distance that still counts as farthest: open water is often one far number.
const HORIZON: f32 = 0.98;
/// Of what is nearer than the horizon, this share lies within the steps; the rest is outliers.
const WITHIN: f64 = 0.995;

/// Spreads the steps over where things are. Open water at a far number, or one wrong pixel, would
/// otherwise press the whole scene into a few steps.
fn quantise(distances: &[f32]) -> Quantised<'_> {
    let farthest = distances.iter().copied().fold(0.0, f32::max);
    let mut nearer: Vec<f32> = distances.iter().copied().filter(|&z| z < HORIZON * farthest).collect();
    let within = if nearer.is_empty() {
        0.0
    } else {
        let rank = ((nearer.len() as f64 * WITHIN) as usize).min(nearer.len() - 1);
        *nearer.select_nth_unstable_by(rank, f32::total_cmp).1
    };
    // Distances too small to divide by are none: then the farthest is the scale, or else any.
    let reach = [within, farthest, 254.0].into_iter().find(|&reach| reach > 1e-30).unwrap_or(254.0);
    let step = reach / 254.0;
    let levels = distances.iter().map(|z| (z / step + 0.5).min(255.0) as u8).collect();
    Quantised { levels, step, beyond: Some(255) }
}

/// Levels of depth estimated from colour; level 255 is z = 1.
pub(crate) const LEVELS: usize = 256;
const FINE_LEVELS: usize = 1 << 16;

/// z of a level.
pub(crate) fn level_to_z(level: u8) -> f32 {
    f32::from(level) / 255.0
}

/// z of a fine level.
fn fine_level_to_z(level: u16) -> f32 {
    f32::from(level) / f32::from(u16::MAX)
}

impl DepthMap {
    /// Relative depth from bytes: `z = level / 255`.
    ///
    /// # Errors
    ///
    /// [`ImageError`] when a side is zero or the buffer has another length.
    pub fn from_levels(width: usize, height: usize, levels: Vec<u8>) -> Result<Self, ImageError> {
        check_size(width, height, 1, levels.len())?;
        Ok(Self::relative((width, height), Values::Levels(levels)))
    }

    /// Relative depth from 16-bit words: `z = level / 65535`.
    ///
    /// # Errors
    ///
    /// [`ImageError`] when a side is zero or the buffer has another length.
    pub fn from_fine_levels(width: usize, height: usize, levels: Vec<u16>) -> Result<Self, ImageError> {
        check_size(width, height, 1, levels.len())?;
        Ok(Self::relative((width, height), Values::FineLevels(levels)))
    }

    /// Depth from colour in steps, of which the largest is [`LAST_STEP`], and the levels nearest to them.
    pub(super) fn from_steps((width, height): (usize, usize), steps: Vec<u16>, levels: Vec<u8>) -> Self {
        debug_assert!(steps.len() == width * height && levels.len() == steps.len());
        Self::relative((width, height), Values::Steps { steps, levels })
    }

    fn relative((width, height): (usize, usize), values: Values) -> Self {
        Self {
            width,
            height,
            kind: DepthKind::Relative,
            model: None,
            is_inverse: false,
            guesses: None,
            values,
        }
    }

    /// Depth from distances in the unit that `kind` names.
    ///
    /// # Errors
    ///
    /// [`DepthError`] when the buffer has another length, or a value is negative, not finite, or, for relative
    /// depth, above 1.
    pub fn from_distances(
        width: usize,
        height: usize,
        kind: DepthKind,
        distances: Vec<f32>,
    ) -> Result<Self, DepthError> {
        check_size(width, height, 1, distances.len())?;
        let most = if kind == DepthKind::Relative { 1.0 } else { f32::MAX };
        if let Some(i) = distances.iter().position(|z| !(0.0..=most).contains(z)) {
            return Err(DepthError::Value { x: i % width, y: i / width, value: distances[i], most });
        }
        Ok(Self {
            width,
            height,
            kind,
            model: None,
            is_inverse: false,
            guesses: None,
            values: Values::Floats(distances),
        })
    }

    /// Columns.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Columns and rows.
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// This map as one that `model` made from colour.
    pub(super) fn made_by(self, model: DepthModel) -> Self {
        Self { model: Some(model), ..self }
    }

    /// Other distances of the same kind.
    pub(super) fn with_distances(&self, (width, height): (usize, usize), distances: Vec<f32>) -> Self {
        let sizes = [[self.width, self.height], [width, height]];
        let guesses = self.guesses.as_ref().map(|guesses| guesses.resized(sizes[0], sizes[1]));
        Self { width, height, values: Values::Floats(distances), guesses, ..*self }
    }

    /// This map as one whose z is 1 less an inverse depth.
    pub(super) fn turned_from_inverse(self) -> Self {
        Self { is_inverse: true, ..self }
    }

    /// This map as one in which z is a guess in places.
    pub(super) fn with_guesses(self, guesses: Guesses) -> Self {
        Self { guesses: Some(guesses), ..self }
    }

    /// The distance beyond which z is a guess, infinite where none is: a restoration goes no farther.
    pub(crate) fn measured_to(&self) -> f32 {
        self.guesses.as_ref().map_or(f32::INFINITY, Guesses::beyond)
    }

    /// How much of a pixel may be open water, in `[0, 1]`: nothing where z was measured, and what colour says in holes.
    pub(crate) fn may_be_water(&self, x: usize, y: usize) -> f32 {
        match &self.guesses {
            _ if !self.is_measured() => 1.0,
            Some(guesses) => guesses.water_at([x, y], [self.width, self.height]),
            None => 0.0,
        }
    }

    /// Whether every z was measured.
    pub(crate) fn is_measured_everywhere(&self) -> bool {
        self.is_measured() && self.guesses.is_none()
    }

    /// Whether z is 1 less an inverse depth of unknown scale and shift, as of a monocular network: its order is right, its
    /// distances are not.
    pub fn is_inverse(&self) -> bool {
        self.is_inverse
    }

    /// Whether its distances are: neither read off colours nor turned from inverse depth.
    pub(crate) fn is_measured(&self) -> bool {
        self.model.is_none() && !self.is_inverse
    }

    /// The depth model it was obtained by; `None` for supplied depth.
    pub fn model(&self) -> Option<DepthModel> {
        self.model
    }

    /// What the numbers are.
    pub fn kind(&self) -> DepthKind {
        self.kind
    }

    /// The distance at column `x`, row `y`.
    ///
    /// # Panics
    ///
    /// When the place lies outside the map.
    pub fn at(&self, x: usize, y: usize) -> f32 {
        assert!(x < self.width && y < self.height, "({x}, {y}) lies outside {:?}", self.size());
        let i = y * self.width + x;
        match &self.values {
            Values::Levels(levels) => level_to_z(levels[i]),
            Values::Steps { steps, .. } => step_to_z(steps[i]),
            Values::FineLevels(levels) => fine_level_to_z(levels[i]),
            Values::Floats(distances) => distances[i],
        }
    }

    /// The bytes of depth that has 256 levels; `None` for finer depth.
    pub fn levels(&self) -> Option<&[u8]> {
        match &self.values {
            Values::Levels(levels) => Some(levels),
            Values::Steps { .. } | Values::FineLevels(_) | Values::Floats(_) => None,
        }
    }

    /// The levels or steps of depth that has either.
    pub(crate) fn in_steps(&self) -> Option<InSteps<'_>> {
        match &self.values {
            Values::Levels(levels) => Some(InSteps::Levels(levels)),
            Values::Steps { steps, .. } => Some(InSteps::Steps(steps)),
            Values::FineLevels(_) | Values::Floats(_) => None,
        }
    }

    /// The memory of a map that is no longer needed.
    pub(crate) fn into_buffers(self) -> Buffers {
        match self.values {
            Values::Levels(levels) => Buffers { levels, steps: Vec::new() },
            Values::Steps { steps, levels } => Buffers { levels, steps },
            Values::FineLevels(_) | Values::Floats(_) => Buffers::default(),
        }
    }

    /// The depth of the scene alone: what lies within the margins of `area`.
    ///
    /// # Errors
    ///
    /// [`ImageError`] when the area belongs to an image of another size.
    pub fn cut(&self, area: &SceneArea) -> Result<Self, ImageError> {
        check_same_size(area.image_size(), self.size())?;
        let (width, height) = area.size();
        let guesses = self.guesses.as_ref().map(|guesses| guesses.cut(area));
        let values = match &self.values {
            Values::Levels(levels) => Values::Levels(area.cut_values(levels.iter().copied())),
            Values::Steps { steps, levels } => Values::Steps {
                steps: area.cut_values(steps.iter().copied()),
                levels: area.cut_values(levels.iter().copied()),
            },
            Values::FineLevels(levels) => Values::FineLevels(area.cut_values(levels.iter().copied())),
            Values::Floats(distances) => Values::Floats(area.cut_values(distances.iter().copied())),
        };
        Ok(Self { width, height, values, guesses, ..*self })
    }

    /// All distances, row by row from the top.
    pub fn distances(&self) -> Vec<f32> {
        match &self.values {
            Values::Levels(levels) => levels.iter().map(|&level| level_to_z(level)).collect(),
            Values::Steps { steps, .. } => steps.iter().map(|&step| step_to_z(step)).collect(),
            Values::FineLevels(levels) => levels.iter().map(|&level| fine_level_to_z(level)).collect(),
            Values::Floats(distances) => distances.clone(),
        }
    }

    /// Checks that an image of `size` can be seen through this map.
    pub(crate) fn check_fits(&self, size: (usize, usize)) -> Result<(), ImageError> {
        check_same_size(size, self.size())
    }

    /// Changes each pixel by what `law` says of its depth, and adds up what that makes of a `Default`: the law is
    /// evaluated once a level where depth has levels and there are more pixels than levels, once a pixel otherwise.
    pub(crate) fn sum_over_pixels<T: Sample, E: Encoding, V: Copy + Sync, S: Default + Send>(
        &self,
        image: ImageMut<'_, T, E>,
        law: impl Fn(f32) -> V + Sync,
        change: impl Fn(&mut [T; 3], V, &mut S) + Sync,
        add: impl Fn(S, S) -> S + Send + Sync,
    ) -> S {
        match &self.values {
            Values::Levels(levels) => {
                let table: [V; LEVELS] = std::array::from_fn(|level| law(level_to_z(level as u8)));
                self.sum_over(image, levels, |level| table[usize::from(level)], change, add)
            }
            Values::Steps { steps, .. } if steps.len() > TABLE => {
                let table: Vec<V> = (0..=LAST_STEP).map(|step| law(step_to_z(step))).collect();
                self.sum_over(image, steps, |step| table[usize::from(step)], change, add)
            }
            Values::Steps { steps, .. } => {
                self.sum_over(image, steps, |step| law(step_to_z(step)), change, add)
            }
            Values::FineLevels(levels) if levels.len() > FINE_LEVELS => {
                let table: Vec<V> = (0..=u16::MAX).map(|level| law(fine_level_to_z(level))).collect();
                self.sum_over(image, levels, |level| table[usize::from(level)], change, add)
            }
            Values::FineLevels(levels) => {
                self.sum_over(image, levels, |level| law(fine_level_to_z(level)), change, add)
            }
            Values::Floats(distances) => self.sum_over(image, distances, law, change, add),
        }
    }

    fn sum_over<T: Sample, E: Encoding, D: Copy + Sync, V, S: Default + Send>(
        &self,
        image: ImageMut<'_, T, E>,
        depths: &[D],
        law: impl Fn(D) -> V + Sync,
        change: impl Fn(&mut [T; 3], V, &mut S) + Sync,
        add: impl Fn(S, S) -> S + Send + Sync,
    ) -> S {
        let (width, stride) = (self.width, image.stride());
        let band = |first: usize, samples: &mut [T]| {
            let depths = &depths[first * width..];
            runs_mut(samples, width, stride).fold(S::default(), |sum, (start, run)| {
                let (pixels, depths) = (run.as_chunks_mut().0, &depths[start..]);
                simd::widest(ChangeAll { pixels, depths, law: &law, change: &change, sum })
            })
        };
        bands::sum(image.into_samples(), stride, band, add)
    }

    /// [`DepthMap::sum_over_pixels`] without a sum.
    pub(crate) fn for_each_pixel<T: Sample, E: Encoding, V: Copy + Sync>(
        &self,
        image: ImageMut<'_, T, E>,
        law: impl Fn(f32) -> V + Sync,
        change: impl Fn(&mut [T; 3], V) + Sync,
    ) {
        self.sum_over_pixels(image, law, |pixel, value, ()| change(pixel, value), |(), ()| ());
    }

    /// The farthest distance that is distinguished from what is farther.
    pub(crate) fn reach(&self) -> f32 {
        let quantised = self.quantised();
        quantised.step * (LEVELS - 1) as f32
    }

    /// This map in 256 even steps, for estimators that count.
    pub(crate) fn quantised(&self) -> Quantised<'_> {
        match &self.values {
            Values::Levels(levels) | Values::Steps { levels, .. } => {
                Quantised { levels: levels.into(), step: level_to_z(1), beyond: None }
            }
            Values::FineLevels(levels) => Quantised {
                levels: levels.iter().map(|&level| level.to_byte()).collect(),
                step: level_to_z(1),
                beyond: None,
            },
            Values::Floats(distances) => match &self.guesses {
                Some(guesses) => guesses.quantised(),
                None => quantise(distances),
            },
        }
    }

    /// The distance that `share` of the pixels do not exceed.
    ///
    /// # Examples
    ///
    /// ```
    /// use aquafuse::depth::DepthMap;
    ///
    /// let z = DepthMap::from_levels(4, 1, vec![0, 51, 102, 255])?;
    /// assert!((z.percentile(0.5) - 0.2).abs() < 1e-6);
    /// # Ok::<(), aquafuse::image::ImageError>(())
    /// ```
    pub fn percentile(&self, share: f32) -> f32 {
        let mut distances = self.distances();
        let wanted = (f64::from(share) * distances.len() as f64).ceil() as usize;
        let rank = wanted.saturating_sub(1).min(distances.len() - 1);
        *distances.select_nth_unstable_by(rank, f32::total_cmp).1
    }

    /// The mean distance.
    pub fn mean(&self) -> f32 {
        let sum: f64 = match &self.values {
            Values::Levels(levels) => levels.iter().map(|&l| u64::from(l)).sum::<u64>() as f64 / 255.0,
            Values::Steps { steps, .. } => {
                steps.iter().map(|&step| u64::from(step)).sum::<u64>() as f64 / f64::from(LAST_STEP)
            }
            Values::FineLevels(levels) => levels.iter().map(|&l| u64::from(l)).sum::<u64>() as f64 / 65535.0,
            Values::Floats(distances) => distances.iter().copied().map(f64::from).sum(),
        };
        (sum / (self.width * self.height) as f64) as f32
    }
}

#[cfg(test)]
mod tests;
