//! Names and numbers of options, as the Python side passes them.

use std::ops::RangeInclusive;
use std::path::Path;

use aquafuse::depth::{DepthModel, RelativeScale, SuppliedKind};
use aquafuse::fusion::{Gain, Incidence, Model, Options};
use aquafuse::levels::{LevelsOptions, Setting};
use aquafuse_data::image_file::ReadOptions;
use aquafuse_data::model_file::{self, ModelFile};
use aquafuse_data::pipeline::{DepthEstimator, PixelEncoding};
use pyo3::prelude::*;

use crate::array::take_depth;
use crate::depth::{Depth, Known};
use crate::error::Fault;
use crate::network::{self, DepthNetwork};

/// How depth and water of an image are estimated.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Reading {
    depth_model: ModelArgument,
    water_map: String,
    border: String,
    linear: bool,
}

impl Reading {
    /// What of an image is its scene, and what says where that shows open water.
    pub(crate) fn scene(&self) -> Result<ReadOptions, Fault> {
        scene(&self.border, &self.water_map)
    }

    pub(crate) fn encoding(&self) -> PixelEncoding {
        encoding(self.linear)
    }

    pub(crate) fn estimator(&self) -> Result<DepthEstimator, Fault> {
        self.depth_model.estimator()
    }

    /// The depth of an image: an array or a callable of a declared kind, or estimated.
    pub(crate) fn depth(&self, given: Option<&Bound<'_, PyAny>>, kind: Option<&str>) -> PyResult<Depth> {
        match supplied(given, kind)? {
            Some(depth) => Ok(depth),
            None => Ok(self.estimator()?.into()),
        }
    }
}

/// What estimates depth: a model of colours by its name or file, a network by its file, or one that was read before.
#[derive(FromPyObject)]
pub(crate) enum ModelArgument {
    Network(Py<DepthNetwork>),
    Named(String),
}

impl ModelArgument {
    pub(crate) fn estimator(&self) -> Result<DepthEstimator, Fault> {
        match self {
            Self::Network(network) => Ok(DepthEstimator::Network(network.get().0.clone())),
            Self::Named(name) if is_network(name) => Python::attach(|py| {
                Ok(DepthEstimator::Network(network::read(py, name.into(), None, None, None)?))
            }),
            Self::Named(name) => Ok(depth_model(name)?.into()),
        }
    }
}

/// What of an image is its scene, and what says where that shows open water, by their names.
pub(crate) fn scene(border: &str, water_map: &str) -> Result<ReadOptions, Fault> {
    Ok(ReadOptions { border: border.parse()?, water_map: water_map.parse()?, ..ReadOptions::default() })
}

fn is_network(name: &str) -> bool {
    Path::new(name).extension().is_some_and(|extension| extension.eq_ignore_ascii_case("onnx"))
}

/// A depth map, or a callable that gives one, and the kind of its values: they need each other.
pub(crate) fn supplied(given: Option<&Bound<'_, PyAny>>, kind: Option<&str>) -> PyResult<Option<Depth>> {
    match (given, kind) {
        (None, None) => Ok(None),
        (Some(callable), Some(kind)) if callable.is_callable() => {
            Ok(Some(Depth::Called(callable.clone().unbind(), self::kind(kind)?)))
        }
        (Some(map), Some(kind)) => {
            Ok(Some(Depth::Known(Known::Values(take_depth(map, self::kind(kind)?)?))))
        }
        (Some(_), None) => Err(Fault::argument(
            "depth does not state the kind of its values; add depth_kind=\"metres\", \"millimetres\" or \"relative\" \
             (larger is farther), \"inverse\" (larger is nearer, as from monocular networks) or \"disparity\"",
        )
        .into()),
        (None, Some(_)) => Err(Fault::argument("depth_kind has no effect without depth; pass depth=ARRAY or a callable").into()),
    }
}

/// A kind of depth by its name.
pub(crate) fn kind(name: &str) -> Result<SuppliedKind, Fault> {
    Ok(name.parse()?)
}

pub(crate) fn encoding(linear: bool) -> PixelEncoding {
    if linear { PixelEncoding::Linear } else { PixelEncoding::Encoded }
}

/// A depth model by its name, or from a file of `aquafuse fit`.
pub(crate) fn depth_model(name: &str) -> Result<DepthModel, Fault> {
    if let Ok(model) = name.parse() {
        return Ok(model);
    }
    if model_file::check_name(Path::new(name)).is_err() {
        let names = DepthModel::ALL.iter().map(DepthModel::name).collect::<Vec<_>>().join(", ");
        let message = format!(
            "there is no depth model {name:?}; give one of {names}, a FILE.toml from `aquafuse fit`, or a network \
             FILE.onnx"
        );
        return Err(Fault::argument(message));
    }
    let file = ModelFile::read(Path::new(name)).map_err(|error| Fault::argument(error.to_string()))?;
    Ok(DepthModel::Eq3(file.eq3))
}

pub(crate) fn incidence(degrees: f32) -> Result<Incidence, Fault> {
    Ok(Incidence::from_degrees(degrees)?)
}

pub(crate) fn gain(alpha: f32) -> Result<Gain, Fault> {
    Ok(Gain::new(alpha)?)
}

/// How to fuse by a model, with its own θ and α where none is given.
pub(crate) fn fusion_options(model: Model, theta: Option<f32>, alpha: Option<f32>) -> Result<Options, Fault> {
    let mut options = Options::for_model(model);
    if let Some(theta) = theta {
        options = options.with_incidence(incidence(theta)?);
    }
    if let Some(alpha) = alpha {
        options = options.with_gain(gain(alpha)?);
    }
    Ok(options)
}

pub(crate) fn scale(metres_at_one: Option<f32>) -> Result<RelativeScale, Fault> {
    metres_at_one.map_or_else(
        || Ok(RelativeScale::default()),
        |metres| {
            RelativeScale::new(metres).map_err(|error| Fault::argument(format!("metres_at_one: {error}")))
        },
    )
}

/// A whole number of an option within its range.
pub(crate) fn whole<T: TryFrom<i64>>(name: &str, value: i64, range: RangeInclusive<i64>) -> Result<T, Fault> {
    let within = Some(value).filter(|value| range.contains(value)).and_then(|value| T::try_from(value).ok());
    within.ok_or_else(|| {
        Fault::argument(format!("{name} is {value}; give {} to {}", range.start(), range.end()))
    })
}

/// [`whole`] of an option that may be left out.
pub(crate) fn optional<T: TryFrom<i64>>(
    name: &str,
    value: Option<i64>,
    range: RangeInclusive<i64>,
) -> Result<Option<T>, Fault> {
    value.map(|value| whole(name, value, range)).transpose()
}

/// How levels are set.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Levels {
    white: String,
    exposure: String,
    strength: f32,
}

impl Levels {
    pub(crate) fn options(&self) -> Result<LevelsOptions, Fault> {
        if !(0.0..=1.0).contains(&self.strength) {
            return Err(Fault::argument(format!("strength is {}; give a number from 0 to 1", self.strength)));
        }
        let (white, exposure) = (self.white.parse::<Setting>()?, self.exposure.parse::<Setting>()?);
        let options = LevelsOptions::default().with_white(white).with_exposure(exposure);
        Ok(options.with_strength(self.strength))
    }
}
