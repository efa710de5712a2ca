//! Depth maps as files: PNG, TIFF, OpenEXR, NPY and PFM, one channel.
//!
//! | format | read | written |
//! |---|---|---|
//! | PNG | grey, 8 and 16 bits | 16 bits: relative 65535 = 1, metres in millimetres |
//! | TIFF | grey, 8 and 16 bits, 32- and 64-bit float; plain, LZW, deflate | 32-bit float |
//! | OpenEXR | channel Z, Y, R or the only one; half, float | 32-bit float, channel Z |
//! | NPY | two-dimensional `u1`, `u2`, `i2`, `i4`, `f2`, `f4`, `f8`, either byte and memory order | `<f4` |
//! | COLMAP | `IMAGE.geometric.bin`, 32-bit float; 0 is no depth | not |
//! | PFM | `Pf`, either byte order; the size of its scale is not applied | little-endian |
//!
//! What the numbers mean is not in the file: see [`SuppliedKind`].

mod colmap;
mod exr;
mod folder;
mod npy;
mod pfm;
mod png;
mod tiff;

use std::io::{BufRead, BufReader, Cursor, Read, Seek};
use std::path::Path;

pub use folder::DepthFolder;

use aquafuse::depth::{DepthKind, DepthMap, Supplied, SuppliedError, SuppliedKind};

use crate::files::{FileError, Patient, catch_panic, is_memory, one_line, write_atomically};
use crate::image_file::{WriteOptions, open_file, whole};

/// Values of a file, row by row from the top, in its own unit.
#[derive(Clone, Debug, PartialEq)]
struct Raster {
    width: usize,
    height: usize,
    values: Vec<f32>,
    /// The largest whole number its type holds; none for floats.
    full_range: Option<f32>,
}

/// Why a file cannot be read, before its name is known.
#[derive(Debug)]
enum Fault {
    Read(std::io::Error),
    Damaged(String),
    TooLarge(String),
    Unsupported(String, &'static str),
    Unfit(SuppliedError),
    UnknownFormat,
}

impl From<std::io::Error> for Fault {
    fn from(error: std::io::Error) -> Self {
        match error.kind() {
            std::io::ErrorKind::UnexpectedEof => Self::Damaged("it ends too early".into()),
            // What unpacks says the latter, and so does the system of a place in a file that is none.
            std::io::ErrorKind::InvalidData | std::io::ErrorKind::InvalidInput => {
                Self::Damaged(error.to_string())
            }
            _ => Self::Read(error),
        }
    }
}

/// What a decoded file may take, as for images.
const MOST_BYTES: u64 = 512 << 20;

/// The sizes that a map may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Wanted {
    /// Any.
    Any,
    /// These columns and rows.
    Exact((usize, usize)),
    /// So many values at most, to be scaled to an image of this size.
    AtMost(u64, (usize, usize)),
}

/// A map may have so many times the values of its image, if it is scaled to it: it takes memory too.
const LARGER: u64 = 4;

/// Refuses, from the header, sizes that are not wanted, would take more memory than allowed, or none at all.
fn check_size(wanted: Wanted, width: u64, height: u64, bytes_a_place: u64) -> Result<(usize, usize), Fault> {
    let bytes = width.checked_mul(height).and_then(|places| places.checked_mul(bytes_a_place.max(4)));
    if bytes.is_none_or(|bytes| bytes > MOST_BYTES) {
        return Err(Fault::TooLarge(format!("{width}x{height} values exceed the limit")));
    }
    let places = width.saturating_mul(height);
    if !is_memory(places.saturating_mul(bytes_a_place.max(4).saturating_add(4))) {
        return Err(Fault::TooLarge(format!("the system has not the memory for {width}x{height} values")));
    }
    match (usize::try_from(width), usize::try_from(height)) {
        (Ok(width @ 1..), Ok(height @ 1..)) => match wanted {
            Wanted::Exact(image) if image != (width, height) => {
                Err(Fault::Unfit(SuppliedError::Size { map: (width, height), image }))
            }
            Wanted::AtMost(most, (columns, rows)) if places > most => Err(Fault::TooLarge(format!(
                "its {width}x{height} values are more than {LARGER} times the {columns}x{rows} pixels of its image"
            ))),
            _ => Ok((width, height)),
        },
        _ => Err(Fault::Damaged(format!("it declares {width}x{height} values"))),
    }
}

/// Reads the values, of `N` bytes, of a map whose size was checked: memory grows with what is there, not with what
/// the header promises.
fn read_values<const N: usize>(
    mut reader: impl Read,
    (width, height): (usize, usize),
    value: impl Fn([u8; N]) -> f32,
) -> Result<Vec<f32>, Fault> {
    const AT_ONCE: usize = 1 << 16;
    let count = width.saturating_mul(height);
    let mut values = Vec::new();
    let mut stored = vec![[0; N]; AT_ONCE.min(count)];
    while values.len() < count {
        stored.truncate(count.saturating_sub(values.len()));
        reader.read_exact(stored.as_flattened_mut())?;
        values.extend(stored.iter().map(|&bytes| value(bytes)));
    }
    Ok(values)
}

/// The nearest float of 32 bits.
#[allow(
    clippy::cast_possible_truncation,
    reason = "nothing else makes it; what is too large becomes infinite, which is no depth"
)]
fn narrowed(value: f64) -> f32 {
    value as f32
}

/// Reads a depth map of a declared kind. The format is detected by the content.
///
/// # Errors
///
/// [`FileError`] when the file cannot be opened, is damaged, takes more than 512 MiB, or holds another format or
/// kind of values.
pub fn read(path: &Path, kind: SuppliedKind) -> Result<Supplied, FileError> {
    read_wanted(path, kind, Wanted::Any)
}

/// Reads the depth map of an image of `size` columns and rows; another size is refused from the header.
///
/// # Errors
///
/// [`FileError`] as for [`read`], and when the map has another size than the image.
pub fn read_for(path: &Path, kind: SuppliedKind, size: (usize, usize)) -> Result<Supplied, FileError> {
    read_wanted(path, kind, Wanted::Exact(size))
}

/// Reads the depth map of an image of `size` columns and rows, and scales it to that size by the nearest value, which
/// mixes no near and far ones.
///
/// # Errors
///
/// [`FileError`] as for [`read`], and when the map has other proportions than the image, or more than four times its
/// values.
pub fn read_scaled(path: &Path, kind: SuppliedKind, size: (usize, usize)) -> Result<Supplied, FileError> {
    let (file, _) = open_file(path)?;
    let pixels = u64::try_from(size.0.saturating_mul(size.1)).unwrap_or(u64::MAX);
    let wanted = Wanted::AtMost(pixels.saturating_mul(LARGER), size);
    let raster = decode(BufReader::new(Patient(file)), wanted).and_then(|raster| scaled(&raster, size));
    supplied(path, raster, kind)
}

/// The nearest value for each pixel of an image of this size, if the proportions are the same but for rounding.
fn scaled(raster: &Raster, image @ (width, height): (usize, usize)) -> Result<Raster, Fault> {
    let map = (raster.width, raster.height);
    let (wide, high) = (map.0 as f64 * height as f64, map.1 as f64 * width as f64);
    if (wide - high).abs() > PROPORTIONS * wide.max(high) {
        return Err(Fault::Unfit(SuppliedError::Size { map, image }));
    }
    let nearest = |at: usize, from: usize, to: usize| {
        // The middle of a pixel, in the other grid.
        let at = at.saturating_mul(2).saturating_add(1).saturating_mul(from);
        at.checked_div(to.saturating_mul(2)).unwrap_or(0).min(from.saturating_sub(1))
    };
    let columns: Vec<usize> = (0..width).map(|x| nearest(x, map.0, width)).collect();
    let mut values = Vec::with_capacity(width.saturating_mul(height));
    for y in 0..height {
        let begin = nearest(y, map.1, height).saturating_mul(map.0);
        let row = raster.values.get(begin..begin.saturating_add(map.0)).unwrap_or_default();
        values.extend(columns.iter().filter_map(|x| row.get(*x)));
    }
    Ok(Raster { width, height, values, full_range: raster.full_range })
}

/// Proportions that differ by more than this share are of another image, or of a part of it.
const PROPORTIONS: f64 = 0.02;

fn read_wanted(path: &Path, kind: SuppliedKind, wanted: Wanted) -> Result<Supplied, FileError> {
    let (file, _) = open_file(path)?;
    supplied(path, decode(BufReader::new(Patient(file)), wanted), kind)
}

/// Reads a depth map whose file is in memory already; errors call it `name`.
///
/// # Errors
///
/// [`FileError`] as for [`read`].
pub fn from_bytes(name: &Path, bytes: &[u8], kind: SuppliedKind) -> Result<Supplied, FileError> {
    supplied(name, decode(Cursor::new(bytes), Wanted::Any), kind)
}

fn supplied(path: &Path, raster: Result<Raster, Fault>, kind: SuppliedKind) -> Result<Supplied, FileError> {
    let raster = raster.map_err(|fault| named(path, fault))?;
    let map = Supplied::new(raster.width, raster.height, raster.values, kind)
        .map_err(|size| named(path, Fault::Damaged(size.to_string())))?;
    Ok(match raster.full_range {
        Some(most) => map.with_full_range(most),
        None => map,
    })
}

fn decode(mut reader: impl BufRead + Seek, wanted: Wanted) -> Result<Raster, Fault> {
    let head = reader.fill_buf()?;
    let decoder = match head {
        [0x89, b'P', b'N', b'G', ..] => png::decode,
        [b'I', b'I', 42 | 43, 0, ..] | [b'M', b'M', 0, 42 | 43, ..] => tiff::decode,
        [0x76, 0x2f, 0x31, 0x01, ..] => exr::decode,
        [0x93, b'N', b'U', b'M', b'P', b'Y', ..] => npy::decode,
        [b'P', b'f' | b'F', b' ' | b'\t' | b'\r' | b'\n', ..] => pfm::decode,
        head if colmap::begins(head) => colmap::decode,
        _ => return Err(Fault::UnknownFormat),
    };
    catch_panic(|| decoder(reader, wanted))
        .unwrap_or_else(|| Err(Fault::Damaged("the decoder panicked on it".into())))
}

fn named(path: &Path, fault: Fault) -> FileError {
    let path = path.to_owned();
    match fault {
        Fault::Read(error) => FileError::Read { path, error },
        Fault::Damaged(cause) => FileError::Damaged { path, cause: one_line(&cause) },
        Fault::TooLarge(cause) => FileError::TooLarge { path, cause: one_line(&cause) },
        Fault::Unsupported(found, remedy) => {
            FileError::UnsupportedDepth { path, found: one_line(&found), remedy }
        }
        // Whoever knows how the image is turned says more of it.
        Fault::Unfit(error) => FileError::UnfitDepth { path, error, turned: false },
        Fault::UnknownFormat => FileError::UnknownDepthFormat { path },
    }
}

/// A format depth is written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Png,
    Tiff,
    Exr,
    Npy,
    Pfm,
}

/// What the names of depth maps end in.
const EXTENSIONS: [(&str, Format); 6] = [
    ("png", Format::Png),
    ("tif", Format::Tiff),
    ("tiff", Format::Tiff),
    ("exr", Format::Exr),
    ("npy", Format::Npy),
    ("pfm", Format::Pfm),
];

fn format_of(path: &Path) -> Option<Format> {
    let extension = path.extension()?.to_str()?;
    EXTENSIONS.into_iter().find(|(known, _)| extension.eq_ignore_ascii_case(known)).map(|(_, format)| format)
}

/// Writes a depth map in the format its extension names, whole or not at all: PNG of 16 bits, relative depth with
/// 65535 = 1 and metres in millimetres (65.535 m at most; what is farther is written as that), the others in
/// 32-bit floats.
///
/// # Errors
///
/// [`FileError`] when the name has another extension, the file exists and may not be replaced, or the system
/// refuses.
pub fn write(path: &Path, depth: &DepthMap, options: &WriteOptions) -> Result<(), FileError> {
    let Some(format) = format_of(path) else {
        return Err(FileError::UnknownExtension {
            path: path.to_owned(),
            expected: ".png, .tif, .tiff, .exr, .npy or .pfm",
        });
    };
    let (width, height) = depth.size();
    write_atomically(path, options.overwrite, |out| match format {
        Format::Png => crate::image_file::encode_grey16(out, width, height, &steps(depth))
            .map_err(|error| error.to_string()),
        Format::Tiff => out.write_all(&tiff::encode(depth)?).map_err(|error| error.to_string()),
        Format::Exr => out.write_all(&exr::encode(depth)?).map_err(|error| error.to_string()),
        Format::Npy => npy::encode(out, &format!("{height}, {width}"), depth.distances())
            .map_err(|error| error.to_string()),
        Format::Pfm => pfm::encode(out, depth).map_err(|error| error.to_string()),
    })
}

/// Writes three numbers for each pixel as an NPY array of 32-bit floats and the shape (height, width, 3), whole or not at all.
pub(crate) fn write_channels(
    path: &Path,
    (width, height): (usize, usize),
    values: &[[f32; 3]],
    options: &WriteOptions,
) -> Result<(), FileError> {
    write_atomically(path, options.overwrite, |out| {
        npy::encode(out, &format!("{height}, {width}, 3"), values.as_flattened().iter().copied())
            .map_err(|error| error.to_string())
    })
}

/// Depth in whole numbers of 16 bits.
fn steps(depth: &DepthMap) -> Vec<u16> {
    let steps_per_unit = match depth.kind() {
        DepthKind::Metres => 1000.0,
        _ => 65535.0,
    };
    let stored = |z: f32| u16::try_from(whole((z * steps_per_unit).into())).unwrap_or(u16::MAX);
    depth.distances().into_iter().map(stored).collect()
}

#[cfg(test)]
mod tests;
