//! What a picture may ask for, told from its header before memory is taken.

use crate::memory::Budget;

/// How pictures are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReadOptions {
    /// The most pixels a picture may have. Default: 268,435,456, a square of 16,384.
    pub most_pixels: u64,
    /// The most memory that work on one picture may take, in bytes, as far as its header tells. Default: 2 GiB.
    pub most_memory: u64,
    /// Take a file that was cut short for what is left of it; [`Picture::damage`](super::Picture::damage) then
    /// says so. By default that is an error.
    pub lenient: bool,
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self { most_pixels: 1 << 28, most_memory: 2 << 30, lenient: false }
    }
}

impl ReadOptions {
    /// The budget that these options allow a run.
    pub fn budget(&self) -> Budget {
        Budget::new(self.most_memory)
    }
}

/// What a header says of a picture's pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Size {
    pub(crate) width: u64,
    pub(crate) height: u64,
    /// Bytes that the decoder gives for a pixel.
    pub(crate) decoded: u64,
    /// Bytes of a sample as it is kept.
    pub(crate) sample: u64,
}

/// What work on a picture takes beside its pixels, in bytes a pixel: depth before and after its median and as
/// seen by the estimators, and a view in bytes of finer samples.
const WORK: u64 = 8;
/// Tables, buffers and what allocators keep.
const BESIDE: u64 = 4 << 20;

impl Size {
    pub(crate) fn pixels(&self) -> u64 {
        self.width.saturating_mul(self.height)
    }

    /// Memory that reading, fusing and writing it take, at most, if its file has `length` bytes.
    pub(crate) fn memory(&self, length: u64) -> u64 {
        // As decoded and as kept, which for a moment are both there; kept twice where it is turned or smoothed.
        let kept = 4 * self.sample;
        let a_pixel = kept + self.decoded.max(kept) + WORK * self.sample;
        self.pixels().saturating_mul(a_pixel).saturating_add(length).saturating_add(BESIDE)
    }
}
