//! The depth maps of a folder of images.

use std::collections::BTreeMap;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};

use super::{colmap, format_of};
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
            if path.is_dir() {
                continue;
            }
            // `a.jpg.geometric.bin` is of `a.jpg`.
            let of_colmap = path.file_name().and_then(|name| name.to_str()?.strip_suffix(colmap::END));
            let own = || format_of(&path).and_then(|_| path.file_stem());
            let stem = of_colmap.and_then(|name| Path::new(name).file_stem()).or_else(own);
            if let Some(stem) = stem.map(OsStr::to_owned) {
                by_stem.entry(stem).or_default().push(path);
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
