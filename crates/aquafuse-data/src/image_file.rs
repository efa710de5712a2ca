//! Image files: pixels, and the metadata that is kept with them.

mod exif;
mod folder;
mod format;
mod limits;
mod metadata;
mod pixels;
mod read;
mod scene;
mod write;

use std::path::Path;

use aquafuse::image::{Image, TopEdge};
use aquafuse::waterbody::WaterMap;

use crate::files::{FileError, Staged};

#[cfg(feature = "fuzz-targets")]
pub(crate) use exif::try_exif;
pub use folder::{Listing, list};
pub use format::{Format, LISTED, WRITTEN};
pub use limits::ReadOptions;
pub use metadata::{Metadata, Resolution, ResolutionUnit};
pub use pixels::{Layers, Pixels};
pub use read::Opened;
pub(crate) use read::{LARGER_PIECES, open_file, read_beside, too_many_pieces};
pub(crate) use write::{encode_grey16, whole};

/// An image with the metadata of its file.
///
/// Pixels stay in stored order: the EXIF orientation is kept as data, and written back, so that boxes and
/// masks made for the file stay valid. [`ImageFile::upright`] rotates the pixels on request.
#[derive(Clone, Debug)]
pub struct ImageFile {
    /// The pixels, encoded.
    pub pixels: Pixels,
    /// Metadata that is written with them.
    pub metadata: Metadata,
    /// The damage of the file, if [`ReadOptions::lenient`] accepted it. The EXIF description of an output repeats it.
    pub damage: Option<String>,
    /// The whole image, if the pixels are but its scene.
    whole: Option<std::sync::Arc<scene::Whole>>,
    water_map: WaterMap,
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

impl ImageFile {
    /// An image that did not come from a file.
    pub fn new(pixels: impl Into<Pixels>) -> Self {
        Self {
            pixels: pixels.into(),
            metadata: Metadata::default(),
            damage: None,
            whole: None,
            water_map: WaterMap::default(),
        }
    }

    /// The same with another map of open water.
    #[must_use]
    pub fn with_water_map(self, water_map: WaterMap) -> Self {
        Self { water_map, ..self }
    }

    /// What says where it shows open water.
    pub fn water_map(&self) -> WaterMap {
        self.water_map
    }

    /// Reads a PNG, JPEG, TIFF, WebP, BMP or GIF file, detected by its content, within the default limits.
    ///
    /// Grey and CMYK become RGB. Their colour profile, which would be wrong for RGB, is dropped and listed in
    /// [`Metadata::left_out`].
    ///
    /// # Errors
    ///
    /// [`FileError`] when the file cannot be opened, is too large, damaged or cut short, or holds another format
    /// or kind of pixels.
    pub fn read(path: &Path) -> Result<Self, FileError> {
        Self::open(path, &ReadOptions::default())?.decode()
    }

    /// Reads an image's header and holds it against the limits; [`Opened::decode`] does the rest.
    ///
    /// # Errors
    ///
    /// [`FileError`] when the file cannot be opened, holds another format, or is larger than `options` allow.
    pub fn open(path: &Path, options: &ReadOptions) -> Result<Opened, FileError> {
        read::open(path, options)
    }

    /// As [`open`](Self::open), of a file that is in memory already.
    pub(crate) fn open_bytes(
        name: &Path,
        bytes: Vec<u8>,
        options: &ReadOptions,
    ) -> Result<Opened, FileError> {
        read::open_bytes(name, bytes, options)
    }

    /// Reads an image whose file is in memory already; errors call it `name`.
    ///
    /// # Errors
    ///
    /// [`FileError`] when it holds another format, is larger than `options` allow, damaged or cut short.
    ///
    /// # Examples
    ///
    /// ```
    /// use aquafuse_data::image_file::{ImageFile, ReadOptions};
    ///
    /// let bitmap = b"BM:\0\0\0\0\0\0\0\x36\0\0\0\x28\0\0\0\x01\0\0\0\x01\0\0\0\x01\0\x18\0\0\0\0\0\x04\0\0\0\
    ///     \0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\xa0\x78\x14\0";
    /// let image = ImageFile::from_bytes("upload.bmp".as_ref(), bitmap, &ReadOptions::default())?;
    /// assert_eq!(image.bytes().pixels(), [[0x14, 0x78, 0xa0]]);
    /// # Ok::<(), aquafuse_data::files::FileError>(())
    /// ```
    pub fn from_bytes(name: &Path, bytes: &[u8], options: &ReadOptions) -> Result<Self, FileError> {
        read::from_bytes(name, bytes, options)
    }

    /// Writes the image in the format its extension names, whole or not at all.
    ///
    /// PNG and TIFF hold 16 bits, TIFF floats too; the others hold bytes. JPEG holds no transparency.
    ///
    /// # Errors
    ///
    /// [`FileError`] when the name has another extension, the format cannot hold the image, the file exists and
    /// may not be replaced, or the system refuses; an earlier file at `path` is then unchanged.
    pub fn write(&self, path: &Path, options: &WriteOptions) -> Result<(), FileError> {
        self.stage(path, options)?.persist()
    }

    /// [`write`](Self::write) as far as the processor is needed: what is left is waiting for the disk.
    pub(crate) fn stage(&self, path: &Path, options: &WriteOptions) -> Result<Staged, FileError> {
        match self.whole {
            Some(_) => write::stage(&self.clone().joined(), path, options),
            None => write::stage(self, path, options),
        }
    }

    /// The file that [`write`](Self::write) would write at `path`, in memory.
    ///
    /// # Errors
    ///
    /// [`FileError`] when the name has another extension, or the format cannot hold the image.
    pub fn encode(&self, path: &Path, quality: u8) -> Result<Vec<u8>, FileError> {
        match self.whole {
            Some(_) => write::encode(&self.clone().joined(), path, quality),
            None => write::encode(self, path, quality),
        }
    }

    /// The colours in bytes, whatever the file holds.
    pub fn bytes(&self) -> std::borrow::Cow<'_, Image<u8>> {
        self.pixels.bytes()
    }

    /// The stored edge that is up as seen.
    pub fn top_edge(&self) -> TopEdge {
        TopEdge::from_exif(self.metadata.orientation())
    }

    /// The whole image rotated by its EXIF orientation, which is then 1.
    pub fn upright(self) -> Self {
        let whole = self.joined();
        whole.turned()
    }

    fn turned(self) -> Self {
        let orientation = self.metadata.orientation();
        let pixels = self.pixels.turned(orientation);
        let mut metadata = self.metadata;
        if let Some(block) = &mut metadata.exif {
            exif::set_upright(block);
        }
        if orientation > 4 {
            metadata.turn_resolution();
        }
        Self { pixels, metadata, ..self }
    }
}

#[cfg(test)]
mod tests;
