//! Files about all images of a dataset. [`augment`](crate::augment) writes them again for the variants.

use std::path::Path;

use super::coco;
use crate::files::FileError;
use crate::image_file::{ReadOptions, read_beside};

/// A file about all images of a dataset.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Index {
    /// It names no image, and is copied unchanged.
    Carried {
        /// Its path.
        path: String,
    },
    /// The YAML of a YOLO dataset: copied without `path`, so that paths are relative to its own folder.
    Config {
        /// Its path.
        path: String,
    },
    /// A path of an image a line.
    Paths {
        /// Its path.
        path: String,
    },
    /// The stem of an image a line, with something behind it or not.
    Stems {
        /// Its path.
        path: String,
        /// Where the images stand.
        folder: String,
    },
    /// JSON in the layout of COCO.
    Coco(coco::File),
}

impl Index {
    /// Its path within the dataset.
    pub fn path(&self) -> &str {
        match self {
            Self::Carried { path }
            | Self::Config { path }
            | Self::Paths { path }
            | Self::Stems { path, .. } => path,
            Self::Coco(file) => &file.path,
        }
    }

    /// Whether it is the same whichever images were made.
    pub(crate) fn is_shared(&self) -> bool {
        matches!(self, Self::Carried { .. } | Self::Config { .. })
    }

    /// Its content in the dataset in `root`.
    ///
    /// # Errors
    ///
    /// [`FileError`] when the file cannot be read again.
    pub fn read(&self, root: &Path, reading: &ReadOptions) -> Result<Vec<u8>, FileError> {
        read_beside(&root.join(self.path()), reading)
    }
}
