//! Image formats: detected by content when reading, by name when writing.

use std::path::Path;

/// An image format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// PNG: 8 and 16 bits, palettes, transparency.
    Png,
    /// JPEG; written without chroma subsampling.
    Jpeg,
    /// TIFF: 8 and 16 bits, floats.
    Tiff,
    /// WebP; written lossless.
    WebP,
    /// BMP; read only.
    Bmp,
    /// GIF, its first frame; read only, and only where the file itself is named.
    Gif,
}

/// What the names of the files we write end in.
pub const WRITTEN: &str = ".png, .jpg, .jpeg, .tif, .tiff or .webp";
/// What the names of the images of a folder end in.
pub const LISTED: &str = ".png, .jpg, .jpeg, .tif, .tiff, .webp or .bmp";

/// Extensions of pictures that are not read.
const OTHERS: [&str; 20] = [
    "heic", "heif", "avif", "jp2", "j2k", "jxl", "dng", "arw", "cr2", "cr3", "nef", "nrw", "gpr", "orf",
    "pef", "raf", "rw2", "srw", "insp", "psd",
];

impl Format {
    /// The format a file name asks for, by its extension.
    pub fn of(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        match extension.as_str() {
            "png" => Some(Self::Png),
            "jpg" | "jpeg" | "jpe" | "jfif" | "mpo" => Some(Self::Jpeg),
            "tif" | "tiff" => Some(Self::Tiff),
            "webp" => Some(Self::WebP),
            "bmp" => Some(Self::Bmp),
            "gif" => Some(Self::Gif),
            _ => None,
        }
    }

    /// The format a file name asks for, if we write it.
    pub fn written(path: &Path) -> Option<Self> {
        Self::of(path).filter(|format| !matches!(format, Self::Bmp | Self::Gif))
    }

    /// What the names of its files end in.
    #[cfg(feature = "parquet")]
    pub(crate) fn extension(self) -> &'static str {
        match self {
            Self::Png => "png",
            Self::Jpeg => "jpg",
            Self::Tiff => "tif",
            Self::WebP => "webp",
            Self::Bmp => "bmp",
            Self::Gif => "gif",
        }
    }

    /// Whether files of this name are among the images of a folder. A GIF is as often a drawing or an
    /// animation: it is read where it is named itself.
    pub fn listed(path: &Path) -> bool {
        Self::of(path).is_some_and(|format| format != Self::Gif)
    }

    /// Whether a file of this name is a picture in a format that is not read: a camera's raw file, or of another coding.
    pub fn is_other(path: &Path) -> bool {
        let extension = path.extension().and_then(|extension| extension.to_str());
        extension.is_some_and(|extension| OTHERS.iter().any(|other| extension.eq_ignore_ascii_case(other)))
    }

    /// The format of a file that begins so.
    pub(crate) fn of_content(head: &[u8]) -> Option<Self> {
        match head {
            [0x89, b'P', b'N', b'G', ..] => Some(Self::Png),
            [0xff, 0xd8, 0xff, ..] => Some(Self::Jpeg),
            [b'I', b'I', 42 | 43, 0, ..] | [b'M', b'M', 0, 42 | 43, ..] => Some(Self::Tiff),
            [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => Some(Self::WebP),
            [b'B', b'M', ..] => Some(Self::Bmp),
            [b'G', b'I', b'F', b'8', ..] => Some(Self::Gif),
            _ => None,
        }
    }
}
