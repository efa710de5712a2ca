//! Scores.

use aquafuse::metrics;
use aquafuse_data::image_file::Pixels;
use aquafuse_data::pipeline::Scores;
use pyo3::prelude::*;

use crate::array::take;
use crate::error::Fault;
use crate::settings::depth_model;
use crate::threads;

/// The same work on two images of one dtype.
macro_rules! both {
    ($a:expr, $b:expr, $x:ident, $y:ident => $score:expr) => {
        match ($a, $b) {
            (Pixels::Bytes($x), Pixels::Bytes($y)) => Ok($score?),
            (Pixels::Words($x), Pixels::Words($y)) => Ok($score?),
            (Pixels::Floats($x), Pixels::Floats($y)) => Ok($score?),
            _ => Err(Fault::array("the two images differ in dtype; convert one of them")),
        }
    };
}

/// PSNR in decibels.
#[pyfunction]
pub(crate) fn psnr(a: &Bound<'_, PyAny>, b: &Bound<'_, PyAny>) -> PyResult<f64> {
    let (first, second) = (take(a)?.pixels, take(b)?.pixels);
    Ok(threads::work(a.py(), || both!(&first, &second, x, y => metrics::psnr(&x.image, &y.image)))?)
}

/// SSIM of luma; `None` for images smaller than its window.
#[pyfunction]
pub(crate) fn ssim(a: &Bound<'_, PyAny>, b: &Bound<'_, PyAny>) -> PyResult<Option<f64>> {
    let (first, second) = (take(a)?.pixels, take(b)?.pixels);
    Ok(threads::work(a.py(), || both!(&first, &second, x, y => metrics::ssim(&x.image, &y.image)))?)
}

/// The difference of the depths that are estimated from two images, in percent of the range.
#[pyfunction]
pub(crate) fn depth_rmse(a: &Bound<'_, PyAny>, b: &Bound<'_, PyAny>, model: &str) -> PyResult<f64> {
    let (first, second, model) = (take(a)?.pixels, take(b)?.pixels, depth_model(model)?);
    let found = threads::work(
        a.py(),
        || both!(&first, &second, x, y => metrics::depth_rmse(&x.image, &y.image, model)),
    )?;
    Ok(found.percent())
}

/// UCIQE, UIQM, colour, contrast, sharpness and lightness.
type WithoutReference = (f64, Option<f64>, f64, f64, Option<f64>, f64);

/// Scores without a reference.
#[pyfunction]
pub(crate) fn scores(image: &Bound<'_, PyAny>) -> PyResult<WithoutReference> {
    let pixels = take(image)?.pixels;
    let Scores { uciqe, uiqm, colour, contrast, sharpness, lightness } =
        threads::work(image.py(), || Ok(Scores::of(&pixels.bytes())))?;
    Ok((uciqe, uiqm, colour, contrast, sharpness, lightness))
}
