//! Logs of robots in MCAP: the images of their cameras are fused, restored or enhanced, and everything else is copied.
//!
//! | schema | encoding of messages | what is changed |
//! |---|---|---|
//! | `sensor_msgs/msg/Image`, `sensor_msgs/Image` | `cdr`, `ros1` | the colours; size, step and header stay, byte for byte |
//! | `sensor_msgs/msg/CompressedImage`, `sensor_msgs/CompressedImage` | `cdr`, `ros1` | the JPEG, PNG or WebP file in it |
//! | `foxglove.CompressedImage` | `protobuf` | the same |
//!
//! Depth is estimated from colour, or comes from another topic ([`DepthTopic`]).
//!
//! Each topic is a sequence of its own. Grey images, depth and Bayer patterns are no colours and stay as they are. Schemas, channels,
//! times, attachments, metadata and the messages of other topics are copied byte for byte; chunks and indices are written again.

mod copy;
mod depth;
mod error;
mod message;
mod picture;
mod records;
mod wire;

use std::path::{Path, PathBuf};
use std::time::Duration;

pub use error::BagError;

use crate::files::refuse_inputs;
use crate::run::RunOptions;
use crate::video::Recipe;

/// What is read and written.
#[derive(Clone, Debug)]
pub struct Request {
    /// The log.
    pub input: PathBuf,
    /// The log to write.
    pub output: PathBuf,
    /// Further files that are read, which the output must not replace.
    pub inputs: Vec<PathBuf>,
    /// The topics that are changed; empty: all that have images in colour.
    pub topics: Vec<String>,
    /// The topic that depth comes from; none: it is estimated from colour.
    pub depth: Option<DepthTopic>,
    /// Replace an existing output.
    pub overwrite: bool,
}

/// A topic with the depth of the images, from a camera's view of the same size.
///
/// `sensor_msgs/Image` in `16UC1` or `mono16` is in millimetres and in `32FC1` in metres; `sensor_msgs/CompressedImage` is a PNG of 16 bits
/// in millimetres, also as `compressedDepth`. An image takes the map whose time, by their headers, is nearest; one
/// without a map stays as it is. Waters are then per metre.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DepthTopic {
    /// Its name.
    pub name: String,
    /// The times of an image and its depth differ by no more than this.
    pub within: Duration,
}

impl Request {
    /// A log and where it goes, with nothing else asked for.
    pub fn new(input: impl Into<PathBuf>, output: impl Into<PathBuf>) -> Self {
        let (input, output) = (input.into(), output.into());
        Self { input, output, inputs: Vec::new(), topics: Vec::new(), depth: None, overwrite: false }
    }
}

/// What was done.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Summary {
    /// Topics with images, by name.
    pub topics: Vec<Topic>,
    /// All messages.
    pub messages: u64,
    /// Why not all of the log was read, if it is cut short.
    pub cut: Option<String>,
}

/// The images of a topic.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Topic {
    /// Its name.
    pub name: String,
    /// Images that were changed.
    pub changed: u64,
    /// Images that stay as they are, because they are no colours or of a kind that is not known; and what the first of them is.
    pub kept: u64,
    /// The reason for the first of them.
    pub kept_for: Option<String>,
    /// Messages that are damaged and stay as they are.
    pub damaged: u64,
    /// The fault of the first of them.
    pub fault: Option<String>,
}

/// Changes the images of a log. `each` hears of every message.
///
/// The output takes its name when it is whole. A log that is cut short is written as far as its messages are whole, and
/// [`Summary::cut`] says so.
///
/// # Errors
///
/// [`BagError`] when the log cannot be read or is damaged, no topic is one of those asked for, or the output cannot be written;
/// there is then no output.
///
/// # Examples
///
/// ```no_run
/// use aquafuse_data::bag::{self, Request};
/// use aquafuse_data::pipeline::Operation;
/// use aquafuse_data::video::Recipe;
///
/// let recipe = Recipe::new(Operation::Enhance { levels: Default::default() });
/// let summary = bag::change(&Request::new("dive.mcap", "clear.mcap"), &recipe, &Default::default(), &mut || ())?;
/// println!("{} topics with images", summary.topics.len());
/// # Ok::<(), aquafuse_data::bag::BagError>(())
/// ```
pub fn change(
    request: &Request,
    recipe: &Recipe,
    options: &RunOptions,
    each: &mut dyn FnMut(),
) -> Result<Summary, BagError> {
    let Request { input, output, inputs, topics, depth, overwrite } = request;
    let inputs = inputs.iter().map(PathBuf::as_path).chain([input.as_path()]);
    refuse_inputs([output.as_path()], inputs.collect::<Vec<&Path>>())?;
    let depth = depth.as_ref();
    copy::run(&copy::Job { input, output, topics, depth, overwrite: *overwrite, recipe, options }, each)
}

/// Any bytes as a message of a log, for fuzzing.
#[cfg(feature = "fuzz-targets")]
pub(crate) fn try_message(bytes: &[u8], options: &crate::image_file::ReadOptions) {
    picture::try_message(bytes, options);
}
