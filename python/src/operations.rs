//! One image changed: the same pipeline as that of the command.

use aquafuse::depth::DepthModel;
use aquafuse::formation::RestoreOptions;
use aquafuse::scene_area::Border;
use aquafuse::smooth::Smoothing;
use aquafuse_data::image_file::{ImageFile, Pixels};
use aquafuse_data::pipeline::{self, Operation, Outcome};
use pyo3::prelude::*;

use crate::array::{check_out, give, take};
use crate::depth::Depth;
use crate::error::Fault;
use crate::settings::{Levels, Reading, scale, supplied};
use crate::threads;
use crate::water::Water;

/// What was done to an image, and what is known of its own water.
pub(crate) struct Report {
    pub(crate) outcome: Outcome,
    pub(crate) quality: Option<aquafuse::waterbody::Quality>,
}

/// Applies an operation to the scene of an image.
pub(crate) fn apply(
    pixels: Pixels,
    border: Border,
    depth: Depth,
    operation: &Operation,
    smoothing: Smoothing,
) -> Result<(Pixels, Report), Fault> {
    let mut image = ImageFile::new(pixels).cut_to_scene(border)?;
    let analyse = || depth.analyse(operation.encoding(), &image);
    let found = operation.needs_analysis().then(analyse).transpose()?;
    let outcome = operation.apply(&mut image.pixels, found.as_ref())?;
    image.pixels = image.pixels.smoothed(smoothing);
    let quality = found.map(|found| found.estimate.quality());
    Ok((image.joined().pixels, Report { outcome, quality }))
}

/// The scene as if seen through air.
#[pyfunction]
#[allow(clippy::too_many_arguments, reason = "the Python side names them")]
pub(crate) fn restore<'py>(
    image: &Bound<'py, PyAny>,
    depth: Option<&Bound<'py, PyAny>>,
    depth_kind: Option<&str>,
    reading: Reading,
    levels: Levels,
    max_gain: f32,
    out: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    if !(1.0..=100.0).contains(&max_gain) {
        return Err(Fault::argument(format!("max_gain is {max_gain}; give a number from 1 to 100")).into());
    }
    let options = RestoreOptions::default().with_max_gain([max_gain; 3]);
    let operation = Operation::Restore { options, levels: levels.options()?, encoding: reading.encoding() };
    let (border, depth) = (reading.border()?, reading.depth(depth, depth_kind)?);
    run(image, out, move |pixels| apply(pixels, border, depth, &operation, Smoothing::default()))
}

/// Levels are set; no water is estimated.
#[pyfunction]
pub(crate) fn enhance<'py>(
    image: &Bound<'py, PyAny>,
    border: &str,
    levels: Levels,
    out: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let border: Border = border.parse().map_err(Fault::from)?;
    let operation = Operation::Enhance { levels: levels.options()? };
    let depth = Depth::Colour(DepthModel::default());
    run(image, out, move |pixels| apply(pixels, border, depth, &operation, Smoothing::default()))
}

fn run<'py>(
    image: &Bound<'py, PyAny>,
    out: Option<&Bound<'py, PyAny>>,
    work: impl FnOnce(Pixels) -> Result<(Pixels, Report), Fault> + Send,
) -> PyResult<Bound<'py, PyAny>> {
    let taken = take(image)?;
    check_out(out, &taken)?;
    let (pixels, _) = threads::work(image.py(), || work(taken.pixels))?;
    give(image.py(), pixels, taken.container, out)
}

/// An image taken in air, as it would look under water.
#[pyfunction]
#[allow(clippy::too_many_arguments, reason = "the Python side names them")]
pub(crate) fn simulate<'py>(
    image: &Bound<'py, PyAny>,
    depth: &Bound<'py, PyAny>,
    depth_kind: &str,
    water: &Bound<'py, Water>,
    metres_at_one: Option<f32>,
    visibility: Option<f32>,
    keep_light: bool,
    out: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let mut taken = take(image)?;
    check_out(out, &taken)?;
    let map = supplied(Some(depth), Some(depth_kind))?;
    let (water, scale) = (water.get(), scale(metres_at_one)?);
    let pixels = threads::work(image.py(), || {
        let Some(depth) = map else { return Err(Fault::argument("simulate needs depth")) };
        let seen_through = water.per(depth.kind(), scale, visibility)?;
        let image = ImageFile::new(taken.pixels);
        let found = depth.analyse(water.encoding(), &image)?;
        taken.pixels = image.pixels;
        let light = if keep_light { [1.0; 3] } else { water.light()? };
        pipeline::simulate(&mut taken.pixels, &found.depth, &seen_through, light)?;
        Ok(taken.pixels)
    })?;
    give(image.py(), pixels, taken.container, out)
}
