//! From file to image: look at the header, reserve memory, decode.

mod bmp;
mod gif;
mod jpeg;
mod png;
mod tiff;
mod webp;

pub(crate) use tiff::{LARGER_PIECES, too_many_pieces};

use std::fs::File;
use std::io::{BufRead, BufReader, Cursor, ErrorKind, Read, Seek};
use std::path::{Path, PathBuf};

use ::image::error::UnsupportedErrorKind;
use ::image::{DynamicImage, ImageDecoder, ImageError, Limits};

use super::limits::Size;
use super::pixels::Layers;
use aquafuse::scene_area::Border;

use super::{Format, ImageFile, Metadata, Pixels, ReadOptions};
use crate::files::{FileError, Patient, Step, catch_panic, count, is_memory, one_line};

/// An image file whose header was read and found within the limits; its pixels are not decoded yet.
#[derive(Debug)]
pub struct Opened {
    path: PathBuf,
    file: Held,
    length: u64,
    format: Format,
    size: Size,
    options: ReadOptions,
}

/// Where a file is.
#[derive(Debug)]
enum Held {
    Disk(File),
    Memory(Vec<u8>),
}

/// An image as a decoder gives it.
struct Decoded {
    pixels: Pixels,
    metadata: Metadata,
    damage: Option<String>,
}

/// Why a file cannot be read, before its name is known.
#[derive(Debug)]
pub(crate) enum Fault {
    Read(std::io::Error),
    Damaged(String),
    /// There is less of it than it says.
    CutShort(String),
    TooLarge(String),
    Unsupported(String, &'static str),
}

impl From<std::io::Error> for Fault {
    fn from(error: std::io::Error) -> Self {
        match error.kind() {
            ErrorKind::UnexpectedEof => Self::CutShort("it ends too early".into()),
            ErrorKind::InvalidData | ErrorKind::InvalidInput => Self::Damaged(error.to_string()),
            _ => Self::Read(error),
        }
    }
}

impl From<ImageError> for Fault {
    fn from(error: ImageError) -> Self {
        match error {
            ImageError::IoError(error) => error.into(),
            ImageError::Limits(limit) => Self::TooLarge(limit.to_string()),
            ImageError::Unsupported(found) => match found.kind() {
                UnsupportedErrorKind::GenericFeature(form) => Self::Unsupported(
                    format!("in a form that is not read ({form})"),
                    "Save it as PNG, or as TIFF with LZW, deflate or no compression",
                ),
                UnsupportedErrorKind::Color(colour) => {
                    Self::Unsupported(format!("of kind {colour:?}"), "Save it as plain RGB first")
                }
                _ => Self::Unsupported("in a form that is not read".into(), "Save it as PNG"),
            },
            other => Self::Damaged(other.to_string()),
        }
    }
}

impl Fault {
    fn named(self, path: &Path) -> FileError {
        let path = path.to_owned();
        match self {
            Self::Read(error) => FileError::Read { path, error },
            Self::Damaged(cause) => FileError::Damaged { path, cause: one_line(&cause) },
            Self::CutShort(cause) => FileError::CutShort { path, cause: one_line(&cause) },
            Self::TooLarge(cause) => FileError::TooLarge { path, cause: one_line(&cause) },
            Self::Unsupported(found, remedy) => {
                FileError::UnsupportedPixels { path, found: one_line(&found), remedy }
            }
        }
    }
}

/// Opens a file that is to be read from its beginning: a regular one, and not empty.
pub(crate) fn open_file(path: &Path) -> Result<(File, u64), FileError> {
    let cannot_read = |error| FileError::Read { path: path.to_owned(), error };
    // Before opening: that would wait for ever for somebody to write into a pipe.
    let about = path.metadata().map_err(cannot_read)?;
    if about.is_dir() {
        return Err(cannot_read(ErrorKind::IsADirectory.into()));
    }
    if !about.is_file() {
        return Err(FileError::NoFile { path: path.to_owned() });
    }
    if about.len() == 0 {
        return Err(FileError::Empty { path: path.to_owned() });
    }
    Ok((File::open(path).map_err(cannot_read)?, about.len()))
}

/// All of a file that goes along with images, which need not hold anything.
pub(crate) fn read_beside(path: &Path, options: &ReadOptions) -> Result<Vec<u8>, FileError> {
    let most = options.most_beside();
    let (file, length) = match open_file(path) {
        Err(FileError::Empty { .. }) => return Ok(Vec::new()),
        opened => opened?,
    };
    if length > most {
        let cause = format!(
            "it has {length} bytes; an annotation file or list may have {most}, a quarter of --max-memory"
        );
        return Err(FileError::TooLarge { path: path.to_owned(), cause });
    }
    let mut bytes = Vec::new();
    let read = file.take(most).read_to_end(&mut bytes);
    read.map_err(|error| FileError::Read { path: path.to_owned(), error })?;
    Ok(bytes)
}

pub(super) fn open(path: &Path, options: &ReadOptions) -> Result<Opened, FileError> {
    let (file, length) = open_file(path)?;
    let mut reader = BufReader::new(Patient(file));
    let head = reader.fill_buf().map_err(|error| FileError::Read { path: path.to_owned(), error })?;
    let Some(format) = Format::of_content(head) else {
        return Err(FileError::UnknownFormat { path: path.to_owned() });
    };
    let size = header(format, &mut reader)
        .and_then(|size| check(size, length, options))
        .map_err(|fault| fault.named(path))?;
    let file = Held::Disk(reader.into_inner().0);
    Ok(Opened { path: path.to_owned(), file, length, format, size, options: *options })
}

/// As [`open`], of a file that is in memory already.
pub(super) fn open_bytes(name: &Path, bytes: Vec<u8>, options: &ReadOptions) -> Result<Opened, FileError> {
    let Some(format) = Format::of_content(&bytes) else {
        return Err(FileError::UnknownFormat { path: name.to_owned() });
    };
    let length = bytes.len() as u64;
    let size = header(format, &mut Cursor::new(&bytes))
        .and_then(|size| check(size, length, options))
        .map_err(|fault| fault.named(name))?;
    let file = Held::Memory(bytes);
    Ok(Opened { path: name.to_owned(), file, length, format, size, options: *options })
}

/// Reads a header; a decoder that panics is an error of the file.
fn header(format: Format, reader: &mut (impl BufRead + Seek)) -> Result<Size, Fault> {
    let size = catch_panic(|| match format {
        Format::Png => png::header(reader),
        Format::Jpeg => jpeg::header(reader),
        Format::Tiff => tiff::header(reader),
        Format::WebP => webp::header(reader),
        Format::Bmp => bmp::header(reader),
        Format::Gif => gif::header(reader),
    });
    size.unwrap_or_else(|| Err(Fault::Damaged("the decoder panicked on its header".into())))
}

/// Images of fewer pixels may have any number of pixels a byte: they take little memory and time.
const SPARSE: u64 = 1 << 25;

/// Refuses what is empty or too large.
fn check(size: Size, length: u64, options: &ReadOptions) -> Result<Size, Fault> {
    let Size { width, height, .. } = size;
    if width == 0 || height == 0 {
        return Err(Fault::Damaged(format!("its header declares {width}x{height} pixels")));
    }
    if size.pixels() > options.max_pixels {
        return Err(Fault::TooLarge(format!(
            "it has {width}x{height} pixels, but the limit is {} (--max-pixels)",
            options.max_pixels
        )));
    }
    if size.pixels() > SPARSE && size.pixels().div_ceil(length.max(1)) > options.max_pixels_per_byte {
        return Err(Fault::TooLarge(format!(
            "its {length} bytes unpack to {width}x{height} pixels, more than {} a byte, as no photograph does. If it is \
             meant to be so, allow it with --max-pixels {}",
            options.max_pixels_per_byte,
            size.pixels()
        )));
    }
    check_memory(size, size.memory(length), options)?;
    Ok(size)
}

fn check_memory(size: Size, memory: u64, options: &ReadOptions) -> Result<u64, Fault> {
    let Size { width, height, .. } = size;
    if memory > options.max_memory {
        return Err(Fault::TooLarge(format!(
            "its {width}x{height} pixels may need {} MiB of memory, but the limit is {} (--max-memory)",
            memory.div_ceil(1 << 20),
            options.max_memory >> 20
        )));
    }
    Ok(memory)
}

impl Opened {
    /// The most memory that reading and analysing the image takes, in bytes, as far as the header shows.
    pub fn memory(&self) -> u64 {
        self.size.memory(self.length)
    }

    /// The most memory that the image takes until it is written in a format, with `beside` bytes for what is
    /// read with it.
    ///
    /// # Errors
    ///
    /// [`FileError::TooLarge`] when it is more than the options allow.
    pub fn memory_until_written(&self, format: Format, beside: u64) -> Result<u64, FileError> {
        // What surrounds a scene is kept beside it.
        let whole = if self.options.border == Border::None { 0 } else { self.memory_of_pixels() };
        let memory = self.memory().saturating_add(beside).max(self.size.memory_to_write(format));
        let memory = memory.saturating_add(whole);
        check_memory(self.size, memory, &self.options).map_err(|fault| fault.named(&self.path))
    }

    /// The file.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Pixels of the image.
    pub fn pixels(&self) -> u64 {
        self.size.pixels()
    }

    /// Columns and rows, from its header.
    pub fn size(&self) -> (u64, u64) {
        (self.size.width, self.size.height)
    }

    /// Decodes the image.
    ///
    /// # Errors
    ///
    /// [`FileError`] when the file is damaged, was cut short, or changed since it was opened.
    pub fn decode(self) -> Result<ImageFile, FileError> {
        self.decode_seeing(|_| {})
    }

    /// Decodes the image, and shows the bytes of its file.
    pub(crate) fn decode_seeing(mut self, see: impl FnOnce(&[u8])) -> Result<ImageFile, FileError> {
        count(Step::ImageDecoded);
        if !is_memory(self.memory()) {
            return Err(FileError::NoMemory { path: self.path, bytes: self.size.memory(self.length) });
        }
        let image = self.decoded(see).map_err(|fault| fault.named(&self.path))?;
        let unfit = |error| FileError::UnfitBorder { path: self.path.clone(), error };
        image.with_water_map(self.options.water_map).cut_to_scene(self.options.border).map_err(unfit)
    }

    /// Memory that its pixels take once decoded, in bytes.
    pub fn memory_of_pixels(&self) -> u64 {
        self.size.memory_of_pixels()
    }

    fn decoded(&mut self, see: impl FnOnce(&[u8])) -> Result<ImageFile, Fault> {
        let bytes = match &mut self.file {
            Held::Memory(bytes) => std::mem::take(bytes),
            Held::Disk(file) => {
                let mut bytes = Vec::new();
                file.rewind()?;
                Read::by_ref(file).take(self.length).read_to_end(&mut bytes)?;
                bytes
            }
        };
        // What is decoded is what was measured.
        if bytes.len() as u64 != self.length || header(self.format, &mut Cursor::new(&bytes))? != self.size {
            return Err(Fault::Damaged("it changed while it was read".into()));
        }
        see(&bytes);
        decode(self.format, &bytes, self.options.lenient)
    }
}

pub(super) fn from_bytes(name: &Path, bytes: &[u8], options: &ReadOptions) -> Result<ImageFile, FileError> {
    open_bytes(name, bytes.to_owned(), options)?.decode()
}

/// Decodes; a decoder that panics is an error of the file.
fn decode(format: Format, bytes: &[u8], lenient: bool) -> Result<ImageFile, Fault> {
    let decoded = catch_panic(|| match format {
        Format::Png => png::decode(bytes, lenient),
        Format::Jpeg => jpeg::decode(bytes, lenient),
        Format::Tiff => tiff::decode(bytes),
        Format::WebP => webp::decode(bytes, lenient),
        Format::Bmp => bmp::decode(bytes, lenient),
        Format::Gif => gif::decode(bytes, lenient),
    });
    let Decoded { pixels, metadata, damage } =
        decoded.unwrap_or_else(|| Err(Fault::Damaged("the decoder panicked on it".into())))?;
    Ok(ImageFile { metadata, damage, ..ImageFile::new(pixels) })
}

/// Size and kind of pixels from a decoder of `image`.
fn size_of(decoder: &impl ImageDecoder) -> Size {
    let (width, height) = decoder.dimensions();
    let colour = decoder.color_type();
    let decoded = colour.bytes_per_pixel();
    let sample = decoded.checked_div(colour.channel_count()).unwrap_or(decoded).into();
    let channels = if colour.has_alpha() { 4 } else { 3 };
    // What is colour alone is kept as it is decoded; the rest is taken apart.
    let beside = if colour.channel_count() == 3 { 0 } else { decoded.into() };
    Size { width: width.into(), height: height.into(), channels, sample, beside, tables: 0 }
}

/// What is said where XMP is left behind.
const XMP: &str = "its XMP";

/// Decodes by `image`, whose own limits act on what its decoders need beside the pixels.
fn by_image(mut decoder: impl ImageDecoder) -> Result<Decoded, Fault> {
    let mut limits = Limits::no_limits();
    limits.max_alloc = Some(decoder.total_bytes().saturating_mul(2).saturating_add(64 << 20));
    decoder.set_limits(limits)?;
    let mut metadata = Metadata::default();
    let profile = decoder.icc_profile()?;
    metadata.set_profile(profile);
    metadata.set_exif(decoder.exif_metadata()?);
    metadata.leave_out(decoder.xmp_metadata()?.is_some(), XMP);
    let pixels = of_dynamic(DynamicImage::from_decoder(decoder)?)?;
    Ok(Decoded { pixels, metadata, damage: None })
}

fn of_dynamic(image: DynamicImage) -> Result<Pixels, Fault> {
    let (w, h) = (image.width() as usize, image.height() as usize);
    let pixels = match image {
        DynamicImage::ImageRgb8(image) => {
            aquafuse::image::Image::from_raw(w, h, image.into_raw()).map(Pixels::from)
        }
        DynamicImage::ImageRgb16(image) => {
            aquafuse::image::Image::from_raw(w, h, image.into_raw()).map(Pixels::from)
        }
        DynamicImage::ImageRgba8(image) => Layers::of_rgba(w, h, &image).map(Pixels::Bytes),
        DynamicImage::ImageLuma8(image) => Layers::of_grey(w, h, &image).map(Pixels::Bytes),
        DynamicImage::ImageLumaA8(image) => Layers::of_grey_alpha(w, h, &image).map(Pixels::Bytes),
        DynamicImage::ImageRgba16(image) => Layers::of_rgba(w, h, &image).map(Pixels::Words),
        DynamicImage::ImageLuma16(image) => Layers::of_grey(w, h, &image).map(Pixels::Words),
        DynamicImage::ImageLumaA16(image) => Layers::of_grey_alpha(w, h, &image).map(Pixels::Words),
        DynamicImage::ImageRgb32F(image) => {
            aquafuse::image::Image::from_raw(w, h, image.into_raw()).map(Pixels::from)
        }
        DynamicImage::ImageRgba32F(image) => Layers::of_rgba(w, h, &image).map(Pixels::Floats),
        other => {
            return Err(Fault::Unsupported(
                format!("of kind {:?}", other.color()),
                "Save it as plain RGB first",
            ));
        }
    };
    pixels.map_err(|size| Fault::Damaged(size.to_string()))
}
