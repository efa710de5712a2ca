//! Limits on size and memory, checked from the header before memory is allocated.

use std::num::Saturating;

use aquafuse::scene_area::Border;
use aquafuse::waterbody::WaterMap;

use super::Format;

/// How images are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReadOptions {
    /// The most pixels an image may have. Default: 268,435,456, a square of 16,384.
    pub max_pixels: u64,
    /// The most pixels that a byte of the file may stand for, in images of more than 33,554,432. Default: 64. A few hundred
    /// bytes can say that they are 268 million pixels, and photographs of that size have less than 30 a byte.
    pub max_pixels_per_byte: u64,
    /// The most memory that one image may take, and that all images of a run share, in bytes. Default: 2 GiB.
    pub max_memory: u64,
    /// Take a file that was cut short for what is left of it; [`ImageFile::damage`](super::ImageFile::damage) then
    /// says so. By default that is an error.
    pub lenient: bool,
    /// What surrounds the scene of an image and is cut off once it is decoded
    /// ([`ImageFile::cut_to_scene`](super::ImageFile::cut_to_scene)). Default: nothing, as for masks and other images that
    /// must keep their size.
    pub border: Border,
    /// What says where an image shows open water. Default: rules.
    pub water_map: WaterMap,
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self {
            max_pixels: 1 << 28,
            max_pixels_per_byte: 64,
            max_memory: 2 << 30,
            lenient: false,
            border: Border::None,
            water_map: WaterMap::default(),
        }
    }
}

impl ReadOptions {
    /// The most bytes of a file that goes along with images: what is made of its text takes at most thrice as many beside.
    pub(crate) fn most_beside(&self) -> u64 {
        self.max_memory / 4
    }
}

/// What a header says of an image's pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Size {
    pub(crate) width: u64,
    pub(crate) height: u64,
    /// Samples of a pixel as it is kept: colour, and opacity if there may be one.
    pub(crate) channels: u64,
    /// Bytes of a sample.
    pub(crate) sample: u64,
    /// Bytes of a pixel that decoding takes beside those.
    pub(crate) beside: u64,
    /// Bytes that decoding takes for tables, whatever the pixels are.
    pub(crate) tables: u64,
}

/// What the estimators' view takes of a pixel of more than 8 bits: colour and depth in bytes.
const VIEW: Saturating<u64> = Saturating(4);
/// What the encoder of WebP takes of a pixel: its own four samples, and as much again for the coded image.
const WEBP: Saturating<u64> = Saturating(8);
/// What depth takes of a pixel: steps and levels, and what `layout` reads.
const DEPTH: Saturating<u64> = Saturating(4);
/// Tables, buffers, the program itself and what allocators keep.
const OVERHEAD: Saturating<u64> = Saturating(16 << 20);

impl Size {
    pub(crate) fn pixels(&self) -> u64 {
        self.width.saturating_mul(self.height)
    }

    /// Memory that reading, analysing and fusing it take, at most, if its file has `length` bytes.
    ///
    /// As all sizes here it saturates: what is too large for a number is too large for every limit.
    pub(crate) fn memory(&self, length: u64) -> u64 {
        let (pixels, kept) = (Saturating(self.pixels()), self.kept());
        let reading =
            pixels * (kept + Saturating(self.beside)) + Saturating(length) + Saturating(self.tables);
        let view = if self.sample > 1 { VIEW } else { Saturating(0) };
        let analysing = pixels * (kept + DEPTH + view);
        (reading.max(analysing) + OVERHEAD).0
    }

    /// Memory that turning, smoothing and writing it take, at most.
    pub(crate) fn memory_to_write(&self, format: Format) -> u64 {
        let (pixels, kept) = (Saturating(self.pixels()), self.kept());
        let copy_if = |is_made: bool| if is_made { kept } else { Saturating(0) };
        // Side by side with its opacity, and in bytes or words of the other order.
        let copies = copy_if(self.channels == 4) + copy_if(self.sample > 1);
        let encoder = match format {
            Format::WebP => WEBP,
            // The compressed image, which may be as large.
            Format::Png => kept,
            _ => Saturating(0),
        };
        let writing = kept + copies + encoder;
        (pixels * writing.max(kept + kept) + OVERHEAD).0
    }

    /// Memory of the pixels as they are kept.
    pub(crate) fn memory_of_pixels(&self) -> u64 {
        (Saturating(self.pixels()) * self.kept()).0
    }

    /// Bytes of a pixel as it is kept.
    fn kept(&self) -> Saturating<u64> {
        Saturating(self.channels) * Saturating(self.sample)
    }
}
