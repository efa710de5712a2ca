//! What can be wrong with the files of a scene, and what to do about it.

use std::path::{Path, PathBuf};

use aquafuse_data::files::{FileError, display};

/// A file of a scene could not be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneFileError {
    /// The file cannot be opened, read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// A folder has no model in it.
    #[error(
        "{} holds no cameras: neither cameras.bin nor cameras.txt (in it, in sparse/0, sparse or colmap_text) nor \
         transforms.json. Name the folder of a COLMAP model, or make one with `aquafuse scene sfm`",
        display(folder)
    )]
    NoCameras {
        /// The folder.
        folder: PathBuf,
    },
    /// A line of a text file is wrong.
    #[error("{}, line {line}: {cause}. {}", display(path), REMEDY)]
    Line {
        /// The file.
        path: PathBuf,
        /// Which line, counted from 1.
        line: usize,
        /// What is wrong.
        cause: String,
    },
    /// Some bytes of a binary file are wrong.
    #[error("{}, byte {offset}: {cause}. {}", display(path), REMEDY)]
    Offset {
        /// The file.
        path: PathBuf,
        /// Where they are.
        offset: usize,
        /// What is wrong.
        cause: String,
    },
    /// A file is not what it should be as a whole.
    #[error("{}: {cause}", display(path))]
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong, and what to do.
        cause: String,
    },
}

const REMEDY: &str = "The file seems damaged, or is of another program: export it again";

impl SceneFileError {
    pub(super) fn line(path: &Path, line: usize, cause: impl Into<String>) -> Self {
        Self::Line { path: path.to_owned(), line, cause: cause.into() }
    }

    pub(super) fn content(path: &Path, cause: impl Into<String>) -> Self {
        Self::Content { path: path.to_owned(), cause: cause.into() }
    }
}
