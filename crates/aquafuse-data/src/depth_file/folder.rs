//! The depth maps of a folder of images.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

use super::format_of;
use crate::files::FileError;

/// A folder of depth maps, which belong to images by their stem: `a.tiff` to `a.jpg`.
#[derive(Clone, Debug)]
pub struct DepthFolder {
    folder: PathBuf,
    by_stem: BTreeMap<OsString, Vec<PathBuf>>,
}

impl DepthFolder {
    /// Lists the files in `folder` whose extension is that of a depth map.
    ///
    /// # Errors
    ///
    /// [`FileError::Read`] when the folder cannot be listed.
    pub fn list(folder: &Path) -> Result<Self, FileError> {
        let failed = |error| FileError::Read { path: folder.to_owned(), error };
        let mut by_stem: BTreeMap<OsString, Vec<PathBuf>> = BTreeMap::new();
        for entry in std::fs::read_dir(folder).map_err(failed)? {
            let path = entry.map_err(failed)?.path();
            if let (Some(stem), Some(_), false) = (path.file_stem(), format_of(&path), path.is_dir()) {
                by_stem.entry(stem.to_owned()).or_default().push(path);
            }
        }
        Ok(Self { folder: folder.to_owned(), by_stem })
    }

    /// Where they stand.
    pub fn path(&self) -> &Path {
        &self.folder
    }

    /// The depth map of an image.
    ///
    /// # Errors
    ///
    /// [`FileError::NoDepthBeside`] when there is none of its stem, or more than one.
    pub fn map_of(&self, image: &Path) -> Result<&Path, FileError> {
        let found = image.file_stem().and_then(|stem| self.by_stem.get(stem));
        match found.map(Vec::as_slice) {
            Some([only]) => Ok(only),
            found => Err(FileError::NoDepthBeside {
                folder: self.folder.clone(),
                image: image.to_owned(),
                found: found.map_or(0, <[_]>::len),
            }),
        }
    }
}
