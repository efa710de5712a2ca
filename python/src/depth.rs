//! Depth: from colour, or as an array.

use aquafuse::depth::{DepthKind, DepthModel, Supplied, SuppliedKind};
use aquafuse::image::TopEdge;
use aquafuse_data::image_file::ImageFile;
use aquafuse_data::pipeline::{
    Analysis, DepthSource, PixelEncoding, WaterEstimate, analyse_in, analyse_supplied,
};
use numpy::PyArray2;
use pyo3::prelude::*;

use crate::array::{plane, take};
use crate::error::Fault;
use crate::settings::depth_model;
use crate::threads;

/// Where the depth of an image comes from.
#[derive(Clone, Debug)]
pub(crate) enum Depth {
    Colour(DepthModel),
    Values(Supplied),
}

impl Depth {
    /// The unit that z will have.
    pub(crate) fn kind(&self) -> DepthKind {
        match self {
            Self::Colour(_) => DepthKind::Relative,
            Self::Values(map) => match map.kind() {
                SuppliedKind::Metres | SuppliedKind::Millimetres => DepthKind::Metres,
                _ => DepthKind::Relative,
            },
        }
    }

    /// Estimates depth and water of an image.
    pub(crate) fn analyse(
        self,
        encoding: PixelEncoding,
        image: &ImageFile,
    ) -> Result<Analysis<WaterEstimate>, Fault> {
        Ok(match self {
            Self::Colour(model) => analyse_in(encoding, image, &DepthSource::Estimated(model.into()))?,
            Self::Values(map) => analyse_supplied(encoding, image, map)?,
        })
    }
}

/// Depth from colour, as an array of shape (height, width).
#[pyfunction]
pub(crate) fn estimate_depth<'py>(
    image: &Bound<'py, PyAny>,
    model: &str,
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let (py, model) = (image.py(), depth_model(model)?);
    let pixels = take(image)?.pixels;
    let (size, values) = threads::work(py, || {
        let depth = pixels.depth(&model, TopEdge::default());
        Ok((depth.size(), depth.distances()))
    })?;
    plane(py, size, values)
}
