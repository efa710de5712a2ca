//! Frames of a video one after another, with a water that changes smoothly.

use std::sync::{Mutex, MutexGuard, PoisonError, TryLockError};

use aquafuse::depth::RelativeScale;
use aquafuse::formation::RestoreOptions;
use aquafuse::image::Sample;
use aquafuse_data::image_file::{Layers, Pixels};
use aquafuse_data::pipeline::{Operation, PixelEncoding, WaterEstimate};
use aquafuse_data::video::{ContentWater, FrameReport, Frames, Recipe, VideoError};
use pyo3::prelude::*;

use crate::array::{check_out, give, take};
use crate::error::Fault;
use crate::fuser::Fuser;
use crate::settings::{Levels, Reading};
use crate::threads;
use crate::water::{Water, reason_names};

/// Frames of one video.
#[pyclass(frozen, module = "aquafuse._native")]
pub(crate) struct Sequence {
    recipe: Recipe,
    frames: Mutex<Option<AnyFrames>>,
}

/// Frames of one type of values.
enum AnyFrames {
    Bytes(Frames<u8>),
    Words(Frames<u16>),
    Floats(Frames<f32>),
}

/// Verdict and reasons of the frame's own water, where it was estimated.
type Report = Option<(&'static str, Vec<String>)>;

#[pymethods]
impl Sequence {
    /// Frames that are put into the water of a fuser.
    #[staticmethod]
    fn fused(fuser: &Fuser, content: Option<&Water>, steady_over: usize) -> Result<Self, Fault> {
        let mut recipe = fuser.recipe()?;
        if let Some(water) = content {
            let per_unit = water.per(recipe.depth_model.kind(), RelativeScale::default(), None)?;
            let WaterEstimate::Encoded(estimate) = per_unit else {
                return Err(Fault::argument(
                    "content_water is of linear values, and a sequence works on encoded ones; give a water of encoded values",
                ));
            };
            recipe.content_water = ContentWater::Given(estimate);
        }
        Self::of(recipe, steady_over)
    }

    /// Frames that are restored.
    #[staticmethod]
    fn restored(reading: Reading, levels: Levels, max_gain: f32, steady_over: usize) -> Result<Self, Fault> {
        if !(1.0..=100.0).contains(&max_gain) {
            return Err(Fault::argument(format!("max_gain is {max_gain}; give a number from 1 to 100")));
        }
        let options = RestoreOptions::default().with_max_gain([max_gain; 3]);
        let encoding = PixelEncoding::Encoded;
        let mut recipe = Recipe::new(Operation::Restore { options, levels: levels.options()?, encoding });
        let scene = reading.scene()?;
        recipe.border = scene.border;
        recipe.water_map = scene.water_map;
        recipe.depth_model = reading.estimator()?;
        Self::of(recipe, steady_over)
    }

    /// Frames whose levels are set.
    #[staticmethod]
    fn enhanced(border: &str, levels: Levels, steady_over: usize) -> Result<Self, Fault> {
        let mut recipe = Recipe::new(Operation::Enhance { levels: levels.options()? });
        recipe.border = border.parse().map_err(Fault::from)?;
        Self::of(recipe, steady_over)
    }

    /// The next frame, changed, and a report.
    fn next<'py>(
        &self,
        frame: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<(Bound<'py, PyAny>, Report)> {
        let mut taken = take(frame)?;
        check_out(out, &taken)?;
        let (pixels, report) = threads::work(frame.py(), || {
            let mut frames = self.lock()?;
            let known = match frames.take() {
                Some(known) => known,
                None => AnyFrames::of(&self.recipe, &taken.pixels)?,
            };
            let report = frames.insert(known).change(&mut taken.pixels)?;
            Ok((taken.pixels, report))
        })?;
        let report = report.quality.map(|quality| (quality.verdict.name(), reason_names(quality)));
        Ok((give(frame.py(), pixels, taken.container, out)?, report))
    }

    /// Forgets the frames before: the next one is a first one.
    fn reset(&self) -> Result<(), Fault> {
        *self.lock()? = None;
        Ok(())
    }
}

impl Sequence {
    fn of(mut recipe: Recipe, steady_over: usize) -> Result<Self, Fault> {
        if !(1..=MOST).contains(&steady_over) {
            return Err(Fault::argument(format!("steady_over is {steady_over}; give 1 to {MOST} frames")));
        }
        recipe.steady_over = steady_over;
        Ok(Self { recipe, frames: Mutex::new(None) })
    }

    /// Two threads cannot both have the next frame.
    fn lock(&self) -> Result<MutexGuard<'_, Option<AnyFrames>>, Fault> {
        match self.frames.try_lock() {
            Ok(frames) => Ok(frames),
            // What a panic left is forgotten.
            Err(TryLockError::Poisoned(left)) => {
                let mut frames = PoisonError::into_inner(left);
                *frames = None;
                Ok(frames)
            }
            Err(TryLockError::WouldBlock) => Err(Fault::argument(
                "another thread is at work on a frame of this sequence; frames come one after another",
            )),
        }
    }
}

/// More would be a slip of the keyboard: half an hour of video.
const MOST: usize = 100_000;

impl AnyFrames {
    fn of(recipe: &Recipe, pixels: &Pixels) -> Result<Self, Fault> {
        let frames = match pixels {
            Pixels::Bytes(_) => recipe.frames().map(Self::Bytes),
            Pixels::Words(_) => recipe.frames().map(Self::Words),
            Pixels::Floats(_) => recipe.frames().map(Self::Floats),
        };
        frames.map_err(|error| Fault::argument(error.to_string()))
    }

    fn change(&mut self, pixels: &mut Pixels) -> Result<FrameReport, Fault> {
        fn next<T: Sample>(frames: &mut Frames<T>, layers: &mut Layers<T>) -> Result<FrameReport, Fault> {
            frames.change(layers.image.view_mut()).map_err(|error| match error {
                VideoError::Image(error) => error.into(),
                VideoError::File(error) => error.into(),
                other => Fault::argument(other.to_string()),
            })
        }
        Ok(match (self, pixels) {
            (Self::Bytes(frames), Pixels::Bytes(layers)) => next(frames, layers)?,
            (Self::Words(frames), Pixels::Words(layers)) => next(frames, layers)?,
            (Self::Floats(frames), Pixels::Floats(layers)) => next(frames, layers)?,
            _ => {
                return Err(Fault::array(
                    "this frame has another dtype than those before it; convert it, or call reset() first",
                ));
            }
        })
    }
}
