//! `inspect`: depth and water of an image, with a verdict.

use aquafuse::image::Encoded;
use aquafuse::scene_area::SceneArea;
use aquafuse::waterbody::{self, EstimateOptions};
use aquafuse_data::drawing::{self, Captions};
use aquafuse_data::image_file::{ImageFile, Pixels};
use aquafuse_data::pipeline::{Analysis, PixelEncoding, WaterEstimate};
use numpy::PyArray2;
use pyo3::prelude::*;

use crate::array::{Container, give, plane, take};
use crate::error::Fault;
use crate::operations::scene;
use crate::settings::Reading;
use crate::threads;
use crate::water::{Water, reason_names};

/// Depth and water of an image, estimated.
#[pyclass(frozen, module = "aquafuse._native")]
pub(crate) struct Estimate {
    image: ImageFile,
    found: Analysis,
    name: String,
}

/// Estimates depth and water of an image.
#[pyfunction]
pub(crate) fn inspect(
    image: &Bound<'_, PyAny>,
    depth: Option<&Bound<'_, PyAny>>,
    depth_kind: Option<&str>,
    reading: Reading,
    name: String,
) -> PyResult<Estimate> {
    let (how, depth) = (reading.scene()?, reading.depth(depth, depth_kind)?);
    let pixels = take(image)?.pixels;
    let (py, (image, depth)) = (image.py(), scene(image.py(), pixels, &how, depth)?);
    Ok(threads::work(py, || {
        let Analysis { depth, depth_source, supplied, share, estimate } =
            depth.analyse(PixelEncoding::Encoded, &image)?;
        let WaterEstimate::Encoded(estimate) = estimate else {
            return Err(Fault::argument("inspect works on encoded values"));
        };
        Ok(Estimate { image, found: Analysis { depth, depth_source, supplied, share, estimate }, name })
    })?)
}

#[pymethods]
impl Estimate {
    #[getter]
    fn verdict(&self) -> &'static str {
        self.found.estimate.quality.verdict.name()
    }

    #[getter]
    fn reasons(&self) -> Vec<String> {
        reason_names(self.found.estimate.quality)
    }

    /// The reasons in words.
    #[getter]
    fn reasons_in_words(&self) -> Vec<&'static str> {
        self.found.estimate.quality.reasons.iter().map(aquafuse::waterbody::Reason::describe).collect()
    }

    #[getter]
    fn water(&self) -> Water {
        Water::of_estimate(&self.name, self.found.depth.kind(), self.found.estimate.into())
    }

    /// z of each pixel, NaN outside the scene.
    #[getter]
    fn depth<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let distances = self.found.depth.distances();
        let values = match self.image.area() {
            Some(area) => area.spread(&distances, &f32::NAN),
            None => distances,
        };
        plane(py, self.image.whole_size(), values)
    }

    #[getter]
    fn depth_kind(&self) -> &'static str {
        self.water().depth_kind_name()
    }

    /// The 5th and the 95th percentile of z.
    #[getter]
    fn depth_range(&self) -> (f32, f32) {
        (self.found.depth.percentile(0.05), self.found.depth.percentile(0.95))
    }

    /// The share of supplied depth that was not valid; `None` for depth from colour.
    #[getter]
    fn invalid_depth_share(&self) -> Option<f64> {
        self.found.supplied.map(|report| report.invalid_share())
    }

    /// Rows and columns around the scene: top, right, bottom, left.
    #[getter]
    fn border(&self) -> (usize, usize, usize, usize) {
        let margins = self.image.area().map(SceneArea::margins).unwrap_or_default();
        (margins.top, margins.right, margins.bottom, margins.left)
    }

    /// The mean share of open water in the pixels, and how likely it is that open water is in view.
    #[getter]
    fn open_water(&self) -> (f32, f32) {
        (self.found.share.mean(), self.found.share.seen())
    }

    /// The sheet of `aquafuse inspect --plots`.
    fn plot<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let figure = threads::work(py, || {
            let options = EstimateOptions::default().with_water_map(self.image.water_map());
            let evidence = waterbody::evidence::<Encoded>(&*self.image.bytes(), &self.found.depth, &options)?;
            let [r, g, b] =
                self.found.estimate.water.veiling_light.rgb().map(|value| (255.0 * value).round() as u8);
            let captions =
                Captions { name: &self.name, veiling_light: &format!("B∞ #{r:02x}{g:02x}{b:02x}") };
            drawing::estimates(captions, &self.image, &self.found, &evidence).map_err(Fault::array)
        })?;
        give(py, Pixels::from(figure), Container::Array, None)
    }
}
