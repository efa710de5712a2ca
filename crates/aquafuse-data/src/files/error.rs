//! What can go wrong with a file, and what to do about it.

use std::path::PathBuf;

use aquafuse::depth::SuppliedError;

use super::display;

/// A file could not be read or written. Its message names the file, the cause and what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileError {
    /// The file cannot be opened or read.
    #[error("cannot read {}: {error}. {}", display(path), remedy(error))]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        error: std::io::Error,
    },
    /// There is nothing in the file.
    #[error("cannot read {}: the file is empty. Get a whole copy of it", display(path))]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// There is something of that name that is no file.
    #[error(
        "cannot read {}: it is no file but a device, a pipe or a socket. Save what it gives to a file first",
        display(path)
    )]
    NoFile {
        /// What is no file.
        path: PathBuf,
    },
    /// The content is none of our formats.
    #[error(
        "cannot read {}: its content is none of PNG, JPEG, TIFF, WebP, BMP and GIF. If it is an image, convert it first",
        display(path)
    )]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// The pixels, or the texts of a table, are of a kind we do not read.
    #[error("cannot read {}: it is {found}. {remedy}", display(path))]
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
        display(path)
    )]
    UnknownDepthFormat {
        /// The file.
        path: PathBuf,
    },
    /// The values of a depth map are of a kind we do not read.
    #[error("cannot read {} as depth: it holds {found}. {remedy}", display(path))]
    UnsupportedDepth {
        /// The file.
        path: PathBuf,
        /// What they are.
        found: String,
        /// What to do.
        remedy: &'static str,
    },
    /// A depth map does not suit its image or what it was declared to be.
    #[error("cannot use {} as depth: {error}. {}", display(path), unfit_remedy(error, *turned))]
    UnfitDepth {
        /// The depth map.
        path: PathBuf,
        /// What is wrong.
        error: SuppliedError,
        /// Whether the image is turned by its EXIF orientation.
        turned: bool,
    },
    /// No file, or more than one, is the depth map of an image.
    #[error(
        "{} holds {found} depth maps named as {}; put exactly one .png, .tif, .tiff, .exr, .npy or .pfm of that \
         name there",
        display(folder),
        display(image)
    )]
    NoDepthBeside {
        /// Where was looked.
        folder: PathBuf,
        /// The image.
        image: PathBuf,
        /// How many were found.
        found: usize,
    },
    /// The file is damaged.
    #[error("cannot decode {}: {cause}. The file seems damaged; get a whole copy of it", display(path))]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What the decoder said.
        cause: String,
    },
    /// There is less of the file than it says.
    #[error(
        "cannot decode {}: it was cut short ({cause}). Get a whole copy of it; if there is none, --lenient takes what is \
         left of an image",
        display(path)
    )]
    CutShort {
        /// The file.
        path: PathBuf,
        /// What the decoder said.
        cause: String,
    },
    /// The image is larger than we take on.
    #[error("cannot decode {}: {cause}. Raise the limit, scale it down or cut it into parts", display(path))]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// What the decoder said.
        cause: String,
    },
    /// The output's extension names no format we write.
    #[error("cannot write {}: its name must end in {expected}", display(path))]
    UnknownExtension {
        /// The file.
        path: PathBuf,
        /// What is written.
        expected: &'static str,
    },
    /// There is already a file of that name.
    #[error(
        "{} exists and was not touched; give another output, or --overwrite to replace it",
        display(path)
    )]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// A folder for outputs cannot be made.
    #[error("cannot make the folder {}: {cause}. Name another output", display(path))]
    Folder {
        /// The folder.
        path: PathBuf,
        /// Why.
        cause: String,
    },
    /// Another process works in the folder.
    #[error("another aquafuse works in {}; wait for it, or give another output", display(folder))]
    Busy {
        /// The folder.
        folder: PathBuf,
    },
    /// The outputs in a folder were made with other settings than asked for now.
    #[error(
        "{} holds images that were made with other settings ({differences}); give another output, or --overwrite \
         to make them again",
        display(folder)
    )]
    OtherSettings {
        /// The folder.
        folder: PathBuf,
        /// What differs, in words.
        differences: String,
    },
    /// The record of a job is no such thing.
    #[error(
        "cannot go on from {}: line {line} is no record of ours. Move it away, or give another output",
        display(path)
    )]
    DamagedRecord {
        /// The record.
        path: PathBuf,
        /// The line.
        line: usize,
    },
    /// The run was stopped before the file took its name.
    #[error(
        "{} is not written: the run was stopped. The same command goes on where it stopped",
        display(path)
    )]
    Stopped {
        /// The file.
        path: PathBuf,
    },
    /// The file cannot be written.
    #[error("cannot write {}: {cause}. Whatever was there before is still there", display(path))]
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
        std::io::ErrorKind::IsADirectory => "Name an image in it instead",
        _ => "Check that it is a file on a disk that works",
    }
}

/// What to do about a depth map that does not suit.
fn unfit_remedy(error: &SuppliedError, turned: bool) -> &'static str {
    match error {
        SuppliedError::Size { map, image } if turned && (map.1, map.0) == *image => {
            "The image is turned by its EXIF orientation when seen, and the map was made for that: turn the map \
             back to the order in which the image is stored"
        }
        SuppliedError::Size { .. } => {
            "Depth belongs to single pixels: scale the map to the image's size yourself, by nearest neighbour"
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
