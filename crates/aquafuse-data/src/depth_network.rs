//! Depth by a network from a file of ONNX, which the user brings; none is shipped or downloaded.
//!
//! The names of a file's inputs and outputs choose what its numbers are ([`NetworkKind`]):
//!
//! | outputs | taken as | input |
//! |---|---|---|
//! | `depth` or `predicted_depth` alone (Depth Anything V2) | inverse | RGB / 255, mean and deviation of ImageNet |
//! | `disparity`, `disp` or `inverse_depth` | inverse | the same |
//! | `metric_depth` | metric | the same |
//! | `predicted_depth` beside `predicted_normal` (Metric3D) | relative | RGB from 0 to 255 |
//! | `depth` beside `points`, `mask`, `normal` or `confidence` (as MoGe) | relative | RGB / 255 |
//!
//! Any other file needs [`NetworkOptions::kind`], and is given what Depth Anything is. The output is scaled from the size that it
//! really has.

#[cfg(feature = "onnx")]
mod cache;
mod coarse;
#[cfg(feature = "onnx")]
mod contents;
#[cfg(feature = "onnx")]
mod in_time;
#[cfg(feature = "onnx")]
mod messages;
#[cfg(feature = "onnx")]
mod network;
#[cfg(feature = "onnx")]
mod preset;
#[cfg(feature = "onnx")]
mod tensor;

#[cfg(not(feature = "onnx"))]
use std::path::Path;

#[cfg(not(feature = "onnx"))]
use crate::files::FileError;

pub(crate) use coarse::{refined, scaled};
#[cfg(feature = "onnx")]
pub use network::DepthNetwork;

/// What the numbers of a network are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NetworkKind {
    /// Inverse distance of unknown scale and shift: larger is nearer.
    Inverse,
    /// Distance in metres: larger is farther.
    Metric,
    /// Distance of unknown scale, 0 at the camera: larger is farther.
    Relative,
}

impl NetworkKind {
    /// All kinds.
    pub const ALL: &'static [Self] = &[Self::Inverse, Self::Metric, Self::Relative];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Inverse => "inverse",
            Self::Metric => "metric",
            Self::Relative => "relative",
        }
    }
}

impl std::str::FromStr for NetworkKind {
    type Err = UnknownKind;

    fn from_str(name: &str) -> Result<Self, UnknownKind> {
        let named = Self::ALL.iter().find(|kind| kind.name() == name);
        named.copied().ok_or_else(|| UnknownKind(name.to_owned()))
    }
}

/// A name that is no kind of network.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no kind of network {0:?}: give inverse, metric or relative")]
pub struct UnknownKind(String);

/// How a network is used, where its file does not settle it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NetworkOptions {
    /// What its numbers are; by default its inputs and outputs choose it.
    pub kind: Option<NetworkKind>,
    /// The image is scaled to about the area of a square of so many pixels; 518 by default. Only for networks that take any size.
    pub side: Option<u32>,
    /// The longest that reading the network, or one image, may take, in seconds; 600 by default. A network that once took longer is
    /// refused from then on.
    pub seconds: Option<u32>,
}

impl NetworkOptions {
    /// [`seconds`](Self::seconds) by default.
    pub const SECONDS: u32 = 600;
}

/// The folder, in the output folder of a run, in which the outputs of a network are kept.
pub const CACHE: &str = ".aquafuse-depth";

/// What became of the maps of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct CacheCounts {
    /// They were there.
    pub found: u64,
    /// They were computed and kept.
    pub kept: u64,
    /// A file was damaged, and computed again.
    pub damaged: u64,
    /// They were computed and not kept: there are 2 GiB already, or the folder could not be written.
    pub not_kept: u64,
}

/// The sides that an input may have.
pub const SIDES: std::ops::RangeInclusive<u32> = 14..=4096;

/// A network of depth. There is none: the feature `onnx` is off.
#[cfg(not(feature = "onnx"))]
#[derive(Clone, Debug, PartialEq)]
pub enum DepthNetwork {}

#[cfg(not(feature = "onnx"))]
impl DepthNetwork {
    /// Reads a network.
    ///
    /// # Errors
    ///
    /// [`FileError`], always: the feature `onnx` is off.
    pub fn read(path: &Path, _: &NetworkOptions) -> Result<Self, FileError> {
        Err(FileError::UnfitNetwork {
            path: path.to_owned(),
            cause: "this program was built without networks".into(),
            remedy: "Build it with `--features onnx`".into(),
        })
    }

    /// Its name in reports.
    pub fn name(&self) -> &str {
        match *self {}
    }

    pub(crate) fn memory(&self) -> u64 {
        match *self {}
    }

    /// What became of the maps that are kept.
    pub fn cached(&self) -> Option<CacheCounts> {
        match *self {}
    }

    /// The longest that an image has taken so far.
    pub fn slowest(&self) -> std::time::Duration {
        match *self {}
    }

    /// The same.
    #[must_use]
    pub fn kept_in(&self, _: &Path) -> Self {
        match *self {}
    }

    /// The depth of an image.
    ///
    /// # Errors
    ///
    /// None, for there is no network.
    pub fn depth(
        &self,
        _: &aquafuse::image::Image<u8>,
        _: aquafuse::image::TopEdge,
    ) -> Result<aquafuse::depth::SuppliedDepth, FileError> {
        match *self {}
    }

    /// What its numbers are taken as.
    pub fn kind(&self) -> NetworkKind {
        match *self {}
    }

    /// Where it was read from, its SHA-256, and the options that read it again.
    pub fn origin(&self) -> (&Path, &str, NetworkOptions) {
        match *self {}
    }
}
