//! What estimates the depth of an image: a model of its colours, or a network.

use std::path::Path;

use aquafuse::depth::{DepthKind, DepthMap, DepthModel, SuppliedReport};
use aquafuse::image::Image;

use super::SUPPLIED;
use crate::depth_network::{DepthNetwork, NetworkKind};
use crate::files::FileError;
use crate::image_file::ImageFile;

/// What estimates the depth of an image.
#[derive(Clone, Debug, PartialEq)]
pub enum DepthEstimator {
    /// A model of its colours.
    Colour(DepthModel),
    /// A network from a file. What it gives is used as a supplied depth map is, refined by the image.
    Network(DepthNetwork),
}

impl Default for DepthEstimator {
    /// The default model of colours.
    fn default() -> Self {
        Self::Colour(DepthModel::default())
    }
}

impl From<DepthModel> for DepthEstimator {
    fn from(model: DepthModel) -> Self {
        Self::Colour(model)
    }
}

impl DepthEstimator {
    /// The name used in reports: the model, or the network's file with its digest.
    pub fn name(&self) -> &str {
        match self {
            Self::Colour(model) => model.name(),
            Self::Network(network) => network.name(),
        }
    }

    /// The network, if it is one.
    pub fn network(&self) -> Option<&DepthNetwork> {
        match self {
            Self::Colour(_) => None,
            Self::Network(network) => Some(network),
        }
    }

    /// The unit of what it gives.
    pub fn kind(&self) -> DepthKind {
        match self.network().map(DepthNetwork::kind) {
            Some(NetworkKind::Metric) => DepthKind::Metres,
            _ => DepthKind::Relative,
        }
    }

    /// The same, which keeps what a network gives in the folder of a run ([`DepthNetwork::kept_in`]).
    #[must_use]
    pub fn kept_in(&self, folder: &Path) -> Self {
        let kept = self.network().map(|network| network.kept_in(folder));
        kept.map_or_else(|| self.clone(), Self::Network)
    }

    /// Bytes that it takes beside an image of so many pixels.
    pub fn memory(&self, pixels: u64) -> u64 {
        match self {
            Self::Colour(_) => 0,
            Self::Network(network) => pixels.saturating_mul(SUPPLIED).saturating_add(network.memory()),
        }
    }

    /// The depth of an image, whose pixels as bytes are `bytes`; and the report on depth that comes from a network.
    ///
    /// # Errors
    ///
    /// [`FileError::UnfitNetwork`] when a network gives none.
    pub fn depth(
        &self,
        image: &ImageFile,
        bytes: &Image<u8>,
    ) -> Result<(DepthMap, Option<SuppliedReport>), FileError> {
        let top = image.top_edge();
        Ok(match self {
            Self::Colour(model) => (image.pixels.depth(model, top), None),
            Self::Network(network) => {
                let found = network.depth(bytes, top)?;
                (found.depth, Some(found.report))
            }
        })
    }
}
