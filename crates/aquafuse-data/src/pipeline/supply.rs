//! Where the depth of each image of a run comes from.

use std::path::{Path, PathBuf};

use aquafuse::depth::SuppliedKind;

use super::{DepthEstimator, DepthSource, MapSize};
use crate::depth_file::DepthFolder;
use crate::files::FileError;

/// What a supplied depth map takes in bytes a pixel: as stored, as floats of its file and as distances.
pub(crate) const SUPPLIED: u64 = 16;

/// The depth of all images of a run.
#[derive(Clone, Debug)]
pub enum DepthSupply {
    /// Estimated from each image.
    Estimated(DepthEstimator),
    /// One file, for a run over one image.
    File(PathBuf, SuppliedKind, MapSize),
    /// A folder with a depth map for each image, of the same stem.
    Folder(DepthFolder, SuppliedKind, MapSize),
}

impl DepthSupply {
    /// The name used in reports: the depth model, or the kind of the supplied values.
    pub fn name(&self) -> &str {
        match self {
            Self::Estimated(estimator) => estimator.name(),
            Self::File(_, kind, _) | Self::Folder(_, kind, _) => kind.name(),
        }
    }

    /// The same; what a network gives is kept in the folder of the run.
    #[must_use]
    pub fn kept_in(&self, folder: &Path) -> Self {
        match self {
            Self::Estimated(estimator) => Self::Estimated(estimator.kept_in(folder)),
            other => other.clone(),
        }
    }

    /// The depth of the images in a folder within a content: its maps are in a folder of the same name.
    ///
    /// # Errors
    ///
    /// [`FileError::Read`] when the folder of maps cannot be listed.
    pub fn within(&self, folder: &Path) -> Result<Self, FileError> {
        match self {
            Self::Folder(maps, kind, size) if !folder.as_os_str().is_empty() => {
                Ok(Self::Folder(DepthFolder::list(&maps.path().join(folder))?, *kind, *size))
            }
            other => Ok(other.clone()),
        }
    }

    /// The depth of one image.
    ///
    /// # Errors
    ///
    /// [`FileError::NoDepthBeside`] when the folder has no depth map of that stem, or more than one.
    pub fn of(&self, image: &Path) -> Result<DepthSource, FileError> {
        Ok(match self {
            Self::Estimated(estimator) => DepthSource::Estimated(estimator.clone()),
            Self::File(path, kind, size) => {
                DepthSource::Supplied { path: path.clone(), kind: *kind, size: *size }
            }
            Self::Folder(folder, kind, size) => {
                DepthSource::Supplied { path: folder.map_of(image)?.to_owned(), kind: *kind, size: *size }
            }
        })
    }
}
