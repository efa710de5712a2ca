//! The depth of a dataset's images.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use aquafuse::depth::SuppliedKind;

use crate::dataset::split;
use crate::depth_file::DepthFolder;
use crate::files::FileError;
use crate::pipeline::{DepthEstimator, DepthSource, MapSize};

/// How the depth of a dataset's images is obtained.
#[derive(Clone, Debug)]
pub enum DepthPlan {
    /// From each image, by a model of its colours or by a network.
    Estimated(DepthEstimator),
    /// From a folder of maps, laid out as the dataset or with all maps in it, each of its image's stem.
    Maps {
        /// The folder.
        folder: PathBuf,
        /// What its values are.
        kind: SuppliedKind,
        /// The size that its maps may have.
        size: MapSize,
    },
}

/// The maps of a dataset, found once.
pub(super) enum Maps {
    None(DepthEstimator),
    Folders { root: PathBuf, kind: SuppliedKind, size: MapSize, by_folder: BTreeMap<PathBuf, DepthFolder> },
}

impl Maps {
    /// The maps of a dataset, none of whose images is known yet; what a network gives is kept in the folder of a run.
    pub(super) fn of(plan: &DepthPlan, folder: Option<&Path>) -> Result<Self, FileError> {
        let (root, kind, size) = match plan {
            DepthPlan::Estimated(model) => {
                return Ok(Self::None(folder.map_or_else(|| model.clone(), |folder| model.kept_in(folder))));
            }
            DepthPlan::Maps { folder, kind, size } => (folder.clone(), *kind, *size),
        };
        let by_folder = BTreeMap::from([(root.clone(), DepthFolder::list(&root)?)]);
        Ok(Self::Folders { root, kind, size, by_folder })
    }

    /// Lists the folder in which the map of an image stands.
    pub(super) fn know(&mut self, key: &str) -> Result<(), FileError> {
        if let Self::Folders { root, by_folder, .. } = self {
            let folder = root.join(split(key).0);
            if !by_folder.contains_key(&folder) && folder.is_dir() {
                by_folder.insert(folder.clone(), DepthFolder::list(&folder)?);
            }
        }
        Ok(())
    }

    /// The depth of an image.
    pub(super) fn source(&self, key: &str) -> Result<DepthSource, FileError> {
        let (root, kind, size, by_folder) = match self {
            Self::None(model) => return Ok(DepthSource::Estimated(model.clone())),
            Self::Folders { root, kind, size, by_folder } => (root, *kind, *size, by_folder),
        };
        let (within, name) = split(key);
        let folder = by_folder.get(&root.join(within)).or_else(|| by_folder.get(root));
        let none = || FileError::NoDepthBeside { folder: root.clone(), image: name.into(), found: 0 };
        let path = folder.ok_or_else(none)?.map_of(Path::new(name))?.to_owned();
        Ok(DepthSource::Supplied { path, kind, size })
    }
}
