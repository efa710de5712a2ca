//! What can go wrong with a log, and what to do about it.

use std::path::PathBuf;

use crate::files::{FileError, display};
use crate::video::VideoError;

/// A log could not be changed. Its message names the file, the cause and what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BagError {
    /// A file cannot be read, or the output not be written.
    #[error(transparent)]
    File(#[from] FileError),
    /// The operation is not for sequences.
    #[error(transparent)]
    Recipe(#[from] VideoError),
    /// It is no log in MCAP.
    #[error(
        "cannot read {} as a log: it is no MCAP file. Convert it first: `ros2 bag convert` for ROS 2, `mcap convert` for ROS 1",
        display(path)
    )]
    Foreign {
        /// The file.
        path: PathBuf,
    },
    /// It is damaged.
    #[error("cannot read {}: {cause}. Get an intact copy, or repair it with `mcap recover`", display(path))]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        cause: String,
    },
    /// A topic is not there, or has no images.
    #[error("{} has no images on the topic {topic}; the topics with images are: {there}", display(path))]
    NoTopic {
        /// The file.
        path: PathBuf,
        /// The topic that was asked for.
        topic: String,
        /// Those that are there.
        there: String,
    },
    /// There is no depth.
    #[error(
        "{} has no depth on the topic {topic}: no sensor_msgs Image or CompressedImage. Check its topics with `mcap list channels`",
        display(path)
    )]
    NoDepth {
        /// The file.
        path: PathBuf,
        /// The topic that was asked for.
        topic: String,
    },
    /// There is nothing to change.
    #[error(
        "{} has no topic with images that are known: sensor_msgs Image and CompressedImage (cdr, ros1) and \
         foxglove.CompressedImage (protobuf). Check its topics with `mcap list channels`",
        display(path)
    )]
    NoImages {
        /// The file.
        path: PathBuf,
    },
}
