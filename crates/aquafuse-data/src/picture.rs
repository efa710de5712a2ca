//! Picture files: what is read, and what is written back with it.

mod atomic;
mod error;
mod read;
mod write;

use std::path::Path;

use aquafuse::image::{Image, TopEdge};

pub(crate) use atomic::write_atomically;
pub use error::FileError;
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
