//! What can go wrong with a file, and what to do about it.

use std::path::{Path, PathBuf};

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
    #[error("cannot read {}: the file is empty. Get a complete copy", display(path))]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// A device, a pipe or a socket has that name.
    #[error(
        "cannot read {}: it is a device, a pipe or a socket. Save its content to a file first",
        display(path)
    )]
    NoFile {
        /// The device, pipe or socket.
        path: PathBuf,
    },
    /// A link leads out of the folder that its file should be in.
    #[error(
        "cannot read {}: it is a link that leads out of its folder. Copy the file into the folder",
        display(path)
    )]
    LeadsOut {
        /// The link.
        path: PathBuf,
    },
    /// The content has none of the supported formats.
    #[error(
        "cannot read {}: its content is none of PNG, JPEG, TIFF, WebP, BMP and GIF. If it is an image, convert it first{}",
        display(path),
        for_video(path, "")
    )]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// The pixels, or the strings of a table, are of a kind that is not supported.
    #[error("cannot read {}: it is {found}. {remedy}", display(path))]
    UnsupportedPixels {
        /// The file.
        path: PathBuf,
        /// What they are.
        found: String,
        /// What to do.
        remedy: &'static str,
    },
    /// The content has no supported format of depth maps.
    #[error(
        "cannot read {}: it is no depth map in PNG, TIFF, OpenEXR, NPY, PFM or COLMAP's format. Convert it first, best to a float \
         format; JPEG alters the values",
        display(path)
    )]
    UnknownDepthFormat {
        /// The file.
        path: PathBuf,
    },
    /// The values of a depth map are of a kind that is not supported.
    #[error("cannot read {} as depth: it holds {found}. {remedy}", display(path))]
    UnsupportedDepth {
        /// The file.
        path: PathBuf,
        /// What they are.
        found: String,
        /// What to do.
        remedy: &'static str,
    },
    /// A border leaves nothing of an image.
    #[error("cannot use {}: {error}", display(path))]
    UnfitBorder {
        /// The image.
        path: PathBuf,
        /// What is wrong, and what to do.
        error: aquafuse::scene_area::BorderError,
    },
    /// A depth map does not fit its image or its declared kind.
    #[error("cannot use {} as depth: {error}. {}", display(path), unfit_remedy(error, *turned))]
    UnfitDepth {
        /// The depth map.
        path: PathBuf,
        /// What is wrong.
        error: SuppliedError,
        /// Whether the image is rotated by its EXIF orientation.
        turned: bool,
    },
    /// A network gives no depth.
    #[error("cannot use {} as a depth model: {cause}. {remedy}", display(path))]
    UnfitNetwork {
        /// The file of the network.
        path: PathBuf,
        /// What is wrong.
        cause: String,
        /// What to do.
        remedy: String,
    },
    /// No file, or more than one, is the depth map of an image.
    #[error(
        "{} holds {found} depth maps with the stem of {}; it needs exactly one (.png, .tif, .tiff, .exr, .npy, \
         .pfm or .geometric.bin)",
        display(folder),
        display(image)
    )]
    NoDepthBeside {
        /// The folder that was searched.
        folder: PathBuf,
        /// The image.
        image: PathBuf,
        /// How many were found.
        found: usize,
    },
    /// The file is damaged.
    #[error("cannot decode {}: {cause}. The file seems damaged; get an intact copy", display(path))]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What the decoder said.
        cause: String,
    },
    /// The file is truncated.
    #[error(
        "cannot decode {}: it is truncated ({cause}). Get a complete copy, or decode what is left of an image with \
         --lenient",
        display(path)
    )]
    CutShort {
        /// The file.
        path: PathBuf,
        /// What the decoder said.
        cause: String,
    },
    /// The file exceeds a limit.
    #[error("cannot decode {}: {cause}. Raise the limit, or scale or split the file", display(path))]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// What the decoder said.
        cause: String,
    },
    /// The system has less memory than the file needs.
    #[error(
        "cannot decode {}: it may need {} MiB of memory, and the system has less to give. Close other programs, raise the \
         limit of the system, or scale or split the file",
        display(path),
        bytes.div_ceil(1 << 20)
    )]
    NoMemory {
        /// The file.
        path: PathBuf,
        /// What it needs.
        bytes: u64,
    },
    /// The extension of the output names no supported format.
    #[error("cannot write {}: its name must end in {expected}{}", display(path), for_video(path, expected))]
    UnknownExtension {
        /// The file.
        path: PathBuf,
        /// The supported extensions.
        expected: &'static str,
    },
    /// There is already a file of that name.
    #[error(
        "{} exists and was not changed; give another output, or --overwrite to replace it",
        display(path)
    )]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// An output would replace a file that is read, or another output.
    #[error(
        "{} is read or written by this command already, and would be replaced; give another output",
        display(path)
    )]
    IsInput {
        /// The file.
        path: PathBuf,
    },
    /// A folder for outputs cannot be made.
    #[error("cannot create the folder {}: {cause}. Give another output", display(path))]
    Folder {
        /// The folder.
        path: PathBuf,
        /// Why.
        cause: String,
    },
    /// Another process works in the folder.
    #[error("another aquafuse process writes to {}; wait for it, or give another output", display(folder))]
    Busy {
        /// The folder.
        folder: PathBuf,
    },
    /// The outputs in a folder were made with other settings.
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
    /// The record of a run is invalid.
    #[error(
        "cannot continue from {}: line {line} is no record of aquafuse. Move the file away, or give another output",
        display(path)
    )]
    DamagedRecord {
        /// The record.
        path: PathBuf,
        /// The line.
        line: usize,
    },
    /// Something else has the name of a run's record.
    #[error(
        "{} must be a regular file, the record of a run, but is a link or something else. Move it away, or give another \
         output",
        display(path)
    )]
    ForeignRecord {
        /// The file.
        path: PathBuf,
    },
    /// The run was stopped before the file took its name.
    #[error("{} was not written: the run was stopped. Repeat the command to continue", display(path))]
    Stopped {
        /// The file.
        path: PathBuf,
    },
    /// The file cannot be written.
    #[error("cannot write {}: {cause}. An earlier file of this name is unchanged", display(path))]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system or the encoder said.
        cause: String,
    },
}

/// Whom to ask for a video, if the name is one of a video and other names are `expected`.
fn for_video(path: &Path, expected: &str) -> &'static str {
    const VIDEO: [&str; 7] = ["mp4", "m4v", "mov", "mkv", "webm", "avi", "mpg"];
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    match VIDEO.iter().any(|video| extension.eq_ignore_ascii_case(video)) && !expected.contains(".mp4") {
        true => "; a video is for `aquafuse video`",
        false => "",
    }
}

/// What to do about an input that cannot be read.
fn remedy(error: &std::io::Error) -> &'static str {
    match error.kind() {
        std::io::ErrorKind::NotFound => "Check the name",
        std::io::ErrorKind::PermissionDenied => "Get permission to read it",
        std::io::ErrorKind::IsADirectory => "Name an image in it instead",
        _ => "Check the file and its disk",
    }
}

/// What to do about a depth map that does not fit the image or its kind.
fn unfit_remedy(error: &SuppliedError, turned: bool) -> &'static str {
    match error {
        SuppliedError::Size { map, image } if turned && (map.1, map.0) == *image => {
            "The map was made for the image as rotated by its EXIF orientation: rotate the map back to the stored order \
             of the pixels"
        }
        SuppliedError::Size { .. } => {
            "If it shows the whole image, add --depth-resize, which scales it by nearest neighbour"
        }
        SuppliedError::AboveOne { .. } => {
            "Divide the map by its largest distance, or declare another kind: metres, millimetres, inverse or disparity"
        }
        SuppliedError::TooFewValid { .. } => {
            "Check the declared kind, or leave the map out: depth is then estimated from colour"
        }
        _ => "Check that it is the right file, or leave it out: depth is then estimated from colour",
    }
}
