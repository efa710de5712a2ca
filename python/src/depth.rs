//! Depth: from colour, by a network from a file, by a callable of the caller, or as an array.

use aquafuse::depth::{DepthKind, Supplied, SuppliedKind};
use aquafuse_data::image_file::ImageFile;
use aquafuse_data::pipeline::{
    Analysis, DepthEstimator, DepthSource, PixelEncoding, WaterEstimate, analyse_coarse, analyse_in,
    analyse_supplied,
};
use numpy::PyArray2;
use pyo3::prelude::*;

use crate::array::{array_of, plane, take, take_depth};
use crate::error::Fault;
use crate::settings::ModelArgument;
use crate::threads;

/// Where the depth of an image comes from, as the caller says it.
pub(crate) enum Depth {
    Known(Known),
    /// A callable: the scene as an array of bytes in, a map of a declared kind out.
    Called(Py<PyAny>, SuppliedKind),
}

/// The same without anything of Python's.
#[derive(Debug)]
pub(crate) enum Known {
    /// From the image.
    Estimated(DepthEstimator),
    /// A value for each pixel of the whole image.
    Values(Supplied),
    /// A map of the scene, of any size.
    OfScene(Supplied),
}

impl From<DepthEstimator> for Depth {
    fn from(estimator: DepthEstimator) -> Self {
        Self::Known(Known::Estimated(estimator))
    }
}

impl Default for Depth {
    fn default() -> Self {
        DepthEstimator::default().into()
    }
}

impl Depth {
    /// The unit that z will have.
    pub(crate) fn kind(&self) -> DepthKind {
        let kind = match self {
            Self::Known(Known::Estimated(estimator)) => return estimator.kind(),
            Self::Known(Known::Values(map) | Known::OfScene(map)) => map.kind(),
            Self::Called(_, kind) => *kind,
        };
        match kind {
            SuppliedKind::Metres | SuppliedKind::Millimetres => DepthKind::Metres,
            _ => DepthKind::Relative,
        }
    }

    /// Calls what is a callable, in the thread of the caller, where its settings are (as `torch.no_grad()`).
    pub(crate) fn known(self, py: Python<'_>, image: &ImageFile) -> PyResult<Known> {
        let (callable, kind) = match self {
            Self::Known(known) => return Ok(known),
            Self::Called(callable, kind) => (callable, kind),
        };
        let scene = array_of(py, image.bytes().into_owned())?;
        Ok(Known::OfScene(take_depth(callable.bind(py).call1((scene,))?.as_any(), kind)?))
    }
}

impl Known {
    /// Estimates depth and water of an image.
    pub(crate) fn analyse(
        self,
        encoding: PixelEncoding,
        image: &ImageFile,
    ) -> Result<Analysis<WaterEstimate>, Fault> {
        Ok(match self {
            Self::Estimated(estimator) => analyse_in(encoding, image, &DepthSource::Estimated(estimator))?,
            Self::Values(map) => analyse_supplied(encoding, image, map)?,
            Self::OfScene(map) => analyse_coarse(encoding, image, &map)?,
        })
    }
}

/// Depth of an image by a model of its colours or a network, as an array of shape (height, width).
#[pyfunction]
pub(crate) fn estimate_depth<'py>(
    image: &Bound<'py, PyAny>,
    model: ModelArgument,
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let (py, estimator) = (image.py(), model.estimator()?);
    let pixels = take(image)?.pixels;
    let (size, values) = threads::work(py, || {
        let image = ImageFile::new(pixels);
        let (depth, _) = estimator.depth(&image, &image.bytes())?;
        Ok((depth.size(), depth.distances()))
    })?;
    plane(py, size, values)
}
