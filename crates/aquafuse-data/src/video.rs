//! Videos: decoded and encoded by the program ffmpeg, their frames fused, restored or enhanced in between.
//!
//! Three stages run at once, on threads: ffmpeg decodes, the frames are changed, ffmpeg encodes. Buffers go round, so that memory does
//! not grow with the number of frames. Each frame keeps its time; sound, subtitles, chapters and metadata are copied.
//!
//! # Examples
//!
//! ```no_run
//! use aquafuse_data::image_file::ImageFile;
//! use aquafuse_data::pipeline::{DepthSource, Operation, analyse};
//! use aquafuse_data::run::RunOptions;
//! use aquafuse_data::video::{Plan, Recipe, Request};
//!
//! let reference = analyse(&ImageFile::read("green.jpg".as_ref())?, &DepthSource::default())?.estimate;
//! let recipe = Recipe::new(Operation::Fuse { reference: reference.into(), options: Default::default() });
//! let options = RunOptions::default();
//! let plan = Plan::new(&Request::new("dive.mp4", "green_dive.mp4"), &options)?;
//! let summary = plan.run(&recipe, &options, &|_| ())?;
//! println!("{} frames", summary.frames);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod at_depth;
mod change;
mod container;
mod decode;
mod encode;
mod error;
mod ffmpeg;
mod frames;
mod log;
mod one_water;
mod plan;
mod probe;
mod raw;
mod run;

use std::str::FromStr;

#[cfg(feature = "bag")]
pub(crate) use at_depth::AtDepth;
pub use change::{ContentWater, Recipe};
pub use container::Codec;
pub use error::VideoError;
pub use ffmpeg::{Ffmpeg, VARIABLE};
pub use frames::{FrameReport, Frames};
pub use plan::{Input, Output, Plan, Request};
#[cfg(feature = "fuzz-targets")]
pub(crate) use probe::try_log;
pub use probe::{StreamInfo, StreamKind, VideoInfo};
pub use raw::RawFrames;
#[cfg(feature = "fuzz-targets")]
pub(crate) use raw::try_y4m;
pub use run::{Damage, Summary, VideoEvent, VideoListener};

/// A quotient of two whole numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ratio(pub i64, pub i64);

impl Ratio {
    /// The number; `None` for a denominator of 0.
    #[must_use]
    pub fn value(self) -> Option<f64> {
        #[allow(clippy::cast_precision_loss, reason = "times and rates need no more")]
        (self.1 != 0).then(|| self.0 as f64 / self.1 as f64)
    }
}

impl FromStr for Ratio {
    type Err = std::num::ParseIntError;

    /// Reads `30000/1001`, `4:3` or `25`.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text.split_once(['/', ':']) {
            Some((above, below)) => Ok(Self(above.parse()?, below.parse()?)),
            None => Ok(Self(text.parse()?, 1)),
        }
    }
}

/// The size of frames, and whether their samples are words of 16 bits instead of bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Shape {
    width: usize,
    height: usize,
    is_deep: bool,
}

impl Shape {
    /// Bytes of a frame: three samples a pixel.
    fn bytes(self) -> usize {
        let samples = self.width.saturating_mul(self.height).saturating_mul(3);
        samples.saturating_mul(if self.is_deep { 2 } else { 1 })
    }

    /// The name that ffmpeg has for such pixels.
    fn raw_format(self) -> &'static str {
        if self.is_deep { "rgb48le" } else { "rgb24" }
    }
}

/// A frame on its way: red, green and blue, row by row, in bytes or in words of two bytes, the lower one first.
#[derive(Clone, Debug, Default)]
struct Frame {
    bytes: Vec<u8>,
    /// When it is shown, in units of the time base.
    time: i64,
}

/// Where frames come from.
trait Source: Send {
    /// Reads the next frame; false once there is none.
    fn next(&mut self, frame: &mut Frame) -> Result<bool, VideoError>;
    /// After the last frame: what is wrong with the video, if anything is.
    fn end(&mut self) -> Option<String>;
}

/// Where frames go.
trait Sink: Send {
    /// Writes a frame.
    fn write(&mut self, frame: &Frame) -> Result<(), VideoError>;
    /// Writes what is left, and waits until all is written.
    fn finish(&mut self) -> Result<(), VideoError>;
}
