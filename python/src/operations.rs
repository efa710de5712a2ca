//! One image changed: the same pipeline as that of the command.

use aquafuse::formation::RestoreOptions;
use aquafuse::smooth::Smoothing;
use aquafuse_data::image_file::{ImageFile, Pixels, ReadOptions};
use aquafuse_data::pipeline::{self, Operation, Outcome};
use pyo3::prelude::*;

use crate::array::{check_out, give, take};
use crate::depth::{Depth, Known};
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
    py: Python<'_>,
    pixels: Pixels,
    reading: &ReadOptions,
    depth: Depth,
    operation: &Operation,
    smoothing: Smoothing,
) -> PyResult<(Pixels, Report)> {
    let (mut image, depth) = scene(py, pixels, reading, depth)?;
    let work = || {
        let analyse = || depth.analyse(operation.encoding(), &image);
        let found = operation.needs_analysis().then(analyse).transpose()?;
        let outcome = operation.apply(&mut image.pixels, found.as_ref())?;
        image.pixels = image.pixels.smoothed(smoothing);
        let quality = found.map(|found| found.estimate.quality());
        Ok((image.joined().pixels, Report { outcome, quality }))
    };
    Ok(threads::work(py, work)?)
}

/// The scene of an image, and its depth if that had to be asked for.
pub(crate) fn scene(
    py: Python<'_>,
    pixels: Pixels,
    reading: &ReadOptions,
    depth: Depth,
) -> PyResult<(ImageFile, Known)> {
    let image = threads::work(py, || {
        Ok(ImageFile::new(pixels).with_water_map(reading.water_map).cut_to_scene(reading.border)?)
    })?;
    let depth = depth.known(py, &image)?;
    Ok((image, depth))
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
    let depth = reading.depth(depth, depth_kind)?;
    run(image, out, &reading.scene()?, depth, &operation)
}

/// Levels are set; no water is estimated.
#[pyfunction]
pub(crate) fn enhance<'py>(
    image: &Bound<'py, PyAny>,
    border: &str,
    levels: Levels,
    out: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let reading = ReadOptions { border: border.parse().map_err(Fault::from)?, ..ReadOptions::default() };
    let operation = Operation::Enhance { levels: levels.options()? };
    run(image, out, &reading, Depth::default(), &operation)
}

fn run<'py>(
    image: &Bound<'py, PyAny>,
    out: Option<&Bound<'py, PyAny>>,
    reading: &ReadOptions,
    depth: Depth,
    operation: &Operation,
) -> PyResult<Bound<'py, PyAny>> {
    let taken = take(image)?;
    check_out(out, &taken)?;
    let (pixels, _) = apply(image.py(), taken.pixels, reading, depth, operation, Smoothing::default())?;
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
    let (py, taken) = (image.py(), take(image)?);
    check_out(out, &taken)?;
    let Some(depth) = supplied(Some(depth), Some(depth_kind))? else {
        return Err(Fault::argument("simulate needs depth").into());
    };
    let (water, scale) = (water.get(), scale(metres_at_one)?);
    let seen_through = water.per(depth.kind(), scale, visibility)?;
    let (image, depth) = scene(py, taken.pixels, &ReadOptions::default(), depth)?;
    let pixels = threads::work(py, || {
        let found = depth.analyse(water.encoding(), &image)?;
        let mut pixels = image.pixels;
        let light = if keep_light { [1.0; 3] } else { water.light()? };
        pipeline::simulate(&mut pixels, &found.depth, &seen_through, light)?;
        Ok(pixels)
    })?;
    give(py, pixels, taken.container, out)
}
