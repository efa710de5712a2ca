//! Why a step of an evaluation, or all of it, cannot be done.

use std::path::PathBuf;

use serde::Serialize;

use crate::files::{FileError, display};
use crate::image_file::LISTED;
use crate::run::Stopped;

/// An evaluation, or a step of it, cannot be done. Its message names the file, the cause and what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EvaluateError {
    /// A file cannot be read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// The evaluation was stopped.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// A folder holds no image.
    #[error("{} holds no {LISTED}; name the folder that contains the images", display(folder))]
    NoImages {
        /// The folder.
        folder: PathBuf,
    },
    /// No content has a reference.
    #[error(
        "no content has a reference of another group: all {contents} contents and {references} references belong to \
         {group}. Use another --group-by, or name another folder"
    )]
    NoPairs {
        /// Contents.
        contents: usize,
        /// References.
        references: usize,
        /// Their only group.
        group: String,
    },
    /// Two contents would have outputs of one name.
    #[error(
        "{} and {} share their stem, so outputs of other tools cannot be matched to them; rename one of them",
        display(.one), display(.other)
    )]
    Ambiguous {
        /// One file.
        one: PathBuf,
        /// The other.
        other: PathBuf,
    },
    /// An output of another tool is missing, or there are several.
    #[error("{} holds {found} images with the stem {stem}; it needs exactly one", display(folder))]
    NoOutput {
        /// Where was looked.
        folder: PathBuf,
        /// Its name without extension.
        stem: String,
        /// How many were found.
        found: usize,
    },
    /// An output of another tool has another size than its content.
    #[error(
        "{} has {}x{} pixels, but {} has {}x{}; scores need equal sizes, so let the tool write the full size",
        display(output), .found.0, .found.1, display(content), .expected.0, .expected.1
    )]
    Size {
        /// The output.
        output: PathBuf,
        /// Its columns and rows.
        found: (u64, u64),
        /// The content.
        content: PathBuf,
        /// Its columns and rows.
        expected: (u64, u64),
    },
    /// A file is no network of LPIPS, or cannot take an image.
    #[error(
        "cannot use {} as the network of LPIPS: {cause}. Export it again with lpips/export.py of crates/aquafuse-data",
        display(path)
    )]
    NoLpips {
        /// The file.
        path: PathBuf,
        /// What its reader said.
        cause: String,
    },
    /// An image is too small to be scored.
    #[error("{} is smaller than the 11 x 11 pixel window of SSIM; remove it from the folder", display(path))]
    TooSmall {
        /// The image.
        path: PathBuf,
    },
}

/// A step that failed: which, and why. It is shown as its error, which names the file.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, thiserror::Error)]
#[error("{error}")]
pub struct Failed {
    /// What it was about.
    pub name: String,
    /// Why it failed.
    pub error: String,
}

impl Failed {
    pub(crate) fn new(name: &str, error: &EvaluateError) -> Self {
        Self { name: name.to_owned(), error: error.to_string() }
    }
}
