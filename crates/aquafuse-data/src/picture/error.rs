//! What can go wrong with a file, and what to do about it.

use std::path::PathBuf;

use aquafuse::depth::SuppliedError;

/// A file could not be read or written. Its message names the file, the cause and what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileError {
    /// The file cannot be opened or read.
    #[error("cannot read {}: {error}. {}", path.display(), remedy(error))]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        error: std::io::Error,
    },
    /// There is nothing in the file.
    #[error("cannot read {}: the file is empty. Get a whole copy of it", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// The content is none of our formats.
    #[error("cannot read {}: it is neither PNG nor JPEG. If it is a picture, convert it first", path.display())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// The pixels are of a kind we do not read yet.
    #[error("cannot read {}: its pixels are {found}; 8-bit RGB or grey is read. {remedy}", path.display())]
    UnsupportedPixels {
        /// The file.
        path: PathBuf,
        /// What they are.
        found: String,
        /// What to do.
        remedy: &'static str,
    },
    /// The content is no format of depth maps that we read.
    #[error(
        "cannot read {}: it is no depth map in PNG, TIFF, OpenEXR, NPY or PFM. Convert it first, best to one of \
         floats; JPEG alters the numbers",
        path.display()
    )]
    UnknownDepthFormat {
        /// The file.
        path: PathBuf,
    },
    /// The values of a depth map are of a kind we do not read.
    #[error("cannot read {} as depth: it holds {found}. {remedy}", path.display())]
    UnsupportedDepth {
        /// The file.
        path: PathBuf,
        /// What they are.
        found: String,
        /// What to do.
        remedy: &'static str,
    },
    /// A depth map does not suit its picture or what it was declared to be.
    #[error("cannot use {} as depth: {error}. {}", path.display(), unfit_remedy(error, *turned))]
    UnfitDepth {
        /// The depth map.
        path: PathBuf,
        /// What is wrong.
        error: SuppliedError,
        /// Whether the picture is turned by its EXIF orientation.
        turned: bool,
    },
    /// No file, or more than one, is the depth map of a picture.
    #[error(
        "{} holds {found} depth maps named as {}; put exactly one .png, .tif, .tiff, .exr, .npy or .pfm of that \
         name there",
        folder.display(),
        picture.display()
    )]
    NoDepthBeside {
        /// Where was looked.
        folder: PathBuf,
        /// The picture.
        picture: PathBuf,
        /// How many were found.
        found: usize,
    },
    /// The file is damaged.
    #[error("cannot decode {}: {cause}. The file seems damaged; get a whole copy of it", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What the decoder said.
        cause: String,
    },
    /// The picture is larger than we take on.
    #[error("cannot decode {}: {cause}; a decoded picture may take 512 MiB. Scale it down or cut it into parts", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// What the decoder said.
        cause: String,
    },
    /// The output's extension names no format we write.
    #[error("cannot write {}: its name must end in {expected}", path.display())]
    UnknownExtension {
        /// The file.
        path: PathBuf,
        /// What is written.
        expected: &'static str,
    },
    /// There is already a file of that name.
    #[error("{} exists and was not touched; give another output, or --overwrite to replace it", path.display())]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// The file cannot be written.
    #[error("cannot write {}: {cause}. Whatever was there before is still there", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system or the encoder said.
        cause: String,
    },
}

/// What to do about an input that cannot be read.
fn remedy(error: &std::io::Error) -> &'static str {
    match error.kind() {
        std::io::ErrorKind::NotFound => "Check the name",
        std::io::ErrorKind::PermissionDenied => "Ask for the right to read it",
        std::io::ErrorKind::IsADirectory => "Name a picture in it instead",
        _ => "Check that it is a file on a disk that works",
    }
}

/// What to do about a depth map that does not suit.
fn unfit_remedy(error: &SuppliedError, turned: bool) -> &'static str {
    match error {
        SuppliedError::Size { map, picture } if turned && (map.1, map.0) == *picture => {
            "The picture is turned by its EXIF orientation when seen, and the map was made for that: turn the map \
             back to the order in which the picture is stored"
        }
        SuppliedError::Size { .. } => {
            "Depth belongs to single pixels: scale the map to the picture's size yourself, by nearest neighbour"
        }
        SuppliedError::AboveOne { .. } => {
            "Divide the map by its largest distance, or declare what it is: metres, millimetres, inverse or disparity"
        }
        SuppliedError::TooFewValid { .. } => {
            "Check what it was declared to be, or leave it out: depth is then estimated from colour"
        }
        _ => "Check that it is the right file, or leave it out: depth is then estimated from colour",
    }
}
