//! Picture files: what is read, and what is written back with it.

mod atomic;
mod read;
mod write;

use std::path::{Path, PathBuf};

use aquafuse::depth::SuppliedError;
use aquafuse::image::Image;
use aquafuse::waterbody::TopEdge;

pub(crate) use atomic::write_atomically;
pub(crate) use write::encode_grey16;

/// A picture with what its file said about it.
///
/// Pixels stay in stored order: the EXIF orientation is kept as data, and written back, so that boxes and
/// masks made for the file stay true.
#[derive(Clone, Debug)]
pub struct Picture {
    /// The pixels, encoded.
    pub image: Image<u8>,
    /// What travels with them.
    pub metadata: Metadata,
}

/// What a file says about its pixels; carried over from content to output.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Metadata {
    /// ICC colour profile, if it is one for RGB.
    pub icc_profile: Option<Vec<u8>>,
    /// EXIF block.
    pub exif: Option<Vec<u8>>,
    /// EXIF orientation, 1 to 8; 1 when none is given.
    pub orientation: u8,
}

impl Default for Metadata {
    fn default() -> Self {
        Self { icc_profile: None, exif: None, orientation: 1 }
    }
}

/// The formats we read and write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// PNG, 8 bit.
    Png,
    /// JPEG; written without chroma subsampling.
    Jpeg,
}

impl Format {
    /// The format a file name asks for, by its extension.
    pub fn of(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        match extension.as_str() {
            "png" => Some(Self::Png),
            "jpg" | "jpeg" => Some(Self::Jpeg),
            _ => None,
        }
    }
}

/// How to write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WriteOptions {
    /// Replace a file that is already there.
    pub overwrite: bool,
    /// JPEG quality, 1 to 100. The default, 95, keeps the error of writing below one of fusion's steps.
    pub quality: u8,
}

impl Default for WriteOptions {
    fn default() -> Self {
        Self { overwrite: false, quality: 95 }
    }
}

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

impl Picture {
    /// A picture that did not come from a file.
    pub fn new(image: Image<u8>) -> Self {
        Self { image, metadata: Metadata::default() }
    }

    /// Reads a PNG or JPEG file, told apart by its content.
    ///
    /// Grey and CMYK become RGB; their colour profile, which would be wrong for it, is left out.
    ///
    /// # Errors
    ///
    /// [`FileError`] when the file cannot be opened, is damaged, or holds another format or kind of pixels.
    pub fn read(path: &Path) -> Result<Self, FileError> {
        read::read(path)
    }

    /// Writes the picture in the format its extension names, whole or not at all.
    ///
    /// # Errors
    ///
    /// [`FileError`] when the name has another extension, the file exists and may not be replaced, or the
    /// system refuses; whatever stood at `path` is then still there.
    pub fn write(&self, path: &Path, options: &WriteOptions) -> Result<(), FileError> {
        write::write(self, path, options)
    }

    /// The stored edge that is up as seen.
    pub fn top_edge(&self) -> TopEdge {
        TopEdge::from_exif(self.metadata.orientation)
    }
}

#[cfg(test)]
mod tests;
