//! Fusion with one reference water, image after image.

use aquafuse::depth::DepthKind;
use aquafuse::fusion::{Model, Options};
use aquafuse::smooth::Smoothing;
use aquafuse_data::image_file::ReadOptions;
use aquafuse_data::pipeline::{DepthEstimator, Operation, PixelEncoding, WaterEstimate};
use aquafuse_data::video::Recipe;
use pyo3::prelude::*;

use crate::array::{check_out, give, take};
use crate::error::Fault;
use crate::operations::apply;
use crate::settings::{ModelArgument, fusion_options, gain, incidence, scale, supplied};
use crate::water::{Water, reason_names};

/// How images are fused.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct Settings {
    model: String,
    theta: Option<f32>,
    alpha: Option<f32>,
    smooth: String,
    depth_model: ModelArgument,
    water_map: String,
    border: String,
    linear: bool,
    metres_at_one: Option<f32>,
    visibility: Option<f32>,
    keep_lightness: bool,
}

/// Puts images into one reference water.
#[pyclass(frozen, module = "aquafuse._native")]
pub(crate) struct Fuser {
    /// The water by the unit of the content's depth.
    relative: WaterEstimate,
    metric: WaterEstimate,
    options: Options,
    smoothing: Smoothing,
    estimator: DepthEstimator,
    reading: ReadOptions,
    keep_lightness: bool,
}

impl Fuser {
    /// The same for the frames of a sequence, which are encoded values.
    pub(crate) fn recipe(&self) -> Result<Recipe, Fault> {
        let reference = match self.estimator.kind() {
            DepthKind::Metres => self.metric,
            _ => self.relative,
        };
        if reference.encoding() == PixelEncoding::Linear {
            return Err(Fault::argument("a sequence works on encoded values; leave linear=False"));
        }
        let mut recipe = Recipe::new(Operation::Fuse { reference, options: self.options });
        recipe.depth_model = self.estimator.clone();
        recipe.smoothing = self.smoothing;
        recipe.border = self.reading.border;
        recipe.water_map = self.reading.water_map;
        Ok(recipe)
    }
}

/// What [`Fuser::fuse`] reports: verdict and reasons of the content, contrast left, change, whether a bound acted, whether
/// the water hides the scene.
type Report = (&'static str, Vec<String>, f64, f64, bool, bool);

#[pymethods]
impl Fuser {
    #[new]
    fn new(water: &Water, settings: Settings) -> Result<Self, Fault> {
        let model: Model = settings.model.parse()?;
        if settings.visibility.is_some() && model != Model::Exchange {
            return Err(Fault::argument(format!(
                "visibility needs model=\"exchange\": {model} takes only the colour of the water"
            )));
        }
        if water.encoding() != crate::settings::encoding(settings.linear) {
            return Err(Fault::argument(format!(
                "the water is of {} values, but linear={}; use one for both",
                water.encoding(),
                if settings.linear { "True" } else { "False" }
            )));
        }
        let options = fusion_options(model, settings.theta, settings.alpha)?;
        let scale = scale(settings.metres_at_one)?;
        Ok(Self {
            relative: water.per(DepthKind::Relative, scale, settings.visibility)?,
            metric: water.per(DepthKind::Metres, scale, settings.visibility)?,
            options,
            smoothing: settings.smooth.parse()?,
            estimator: settings.depth_model.estimator()?,
            reading: crate::settings::scene(&settings.border, &settings.water_map)?,
            keep_lightness: settings.keep_lightness,
        })
    }

    /// An image in the water, and a report.
    #[pyo3(signature = (image, depth, depth_kind, theta, alpha, out))]
    fn fuse<'py>(
        &self,
        image: &Bound<'py, PyAny>,
        depth: Option<&Bound<'py, PyAny>>,
        depth_kind: Option<&str>,
        theta: Option<f32>,
        alpha: Option<f32>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<(Bound<'py, PyAny>, Report)> {
        let mut options = self.options;
        if let Some(theta) = theta {
            options = options.with_incidence(incidence(theta)?);
        }
        if let Some(alpha) = alpha {
            options = options.with_gain(gain(alpha)?);
        }
        let depth = supplied(depth, depth_kind)?.unwrap_or_else(|| self.estimator.clone().into());
        let reference = match depth.kind() {
            DepthKind::Metres => self.metric,
            _ => self.relative,
        };
        let operation = match self.keep_lightness {
            true => Operation::Clarify { reference, options },
            false => Operation::Fuse { reference, options },
        };
        let taken = take(image)?;
        check_out(out, &taken)?;
        let (pixels, report) =
            apply(image.py(), taken.pixels, &self.reading, depth, &operation, self.smoothing)?;
        let quality = report.quality.unwrap_or_default();
        let outcome = report.outcome;
        let report = (
            quality.verdict.name(),
            reason_names(quality),
            outcome.contrast_left,
            outcome.change,
            outcome.limited.any(),
            outcome.has_vanished(),
        );
        Ok((give(image.py(), pixels, taken.container, out)?, report))
    }
}
