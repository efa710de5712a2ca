//! What can go wrong with a video, and what to do about it.

use std::path::PathBuf;

use aquafuse::image::ImageError;

use crate::files::{FileError, display};

/// A video could not be read or written. Its message names the file, the cause and what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum VideoError {
    /// ffmpeg is not there.
    #[error(
        "cannot find {program}, which reads and writes video. Install it ({INSTALL}), or name the program in the \
         environment variable {}",
        super::ffmpeg::VARIABLE
    )]
    NoFfmpeg {
        /// The program that was looked for.
        program: String,
    },
    /// ffmpeg cannot be started.
    #[error(
        "cannot start {program}: {cause}. Name another ffmpeg in the environment variable {}",
        super::ffmpeg::VARIABLE
    )]
    Start {
        /// The program.
        program: String,
        /// What the system said.
        cause: String,
    },
    /// A file cannot be read, or the output not be written.
    #[error(transparent)]
    File(#[from] FileError),
    /// A frame is no image.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// A folder was given.
    #[error(
        "cannot read {} as video: it is a folder. Name a video; a folder of images is for `aquafuse fuse`, and with --sequence its \
         images are the frames of one video",
        display(path)
    )]
    Folder {
        /// The folder.
        path: PathBuf,
    },
    /// ffmpeg does not open the file.
    #[error(
        "cannot read {} as video: {said}. Check that it is a complete video; an image is for `aquafuse fuse`",
        display(path)
    )]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What ffmpeg said.
        said: String,
    },
    /// There is no video stream.
    #[error("cannot read {} as video: it has no video stream. Give a file that has one", display(path))]
    NoVideoStream {
        /// The file.
        path: PathBuf,
    },
    /// No frame can be decoded.
    #[error(
        "cannot read {}: no frame of its video can be decoded ({said}). Get an intact copy",
        display(path)
    )]
    NoFrames {
        /// The file.
        path: PathBuf,
        /// What ffmpeg said.
        said: String,
    },
    /// The frames are larger than allowed.
    #[error(
        "cannot read {}: its frames of {width} x {height} pixels {limit}. Raise the limit, or scale the video",
        display(path)
    )]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
        /// Which limit they exceed, in words.
        limit: String,
    },
    /// Standard input holds no such stream.
    #[error("cannot read standard input: {cause}. {remedy}")]
    Stream {
        /// What is wrong.
        cause: String,
        /// What to do.
        remedy: &'static str,
    },
    /// The encoder ended before it was done.
    #[error(
        "cannot write {}: ffmpeg ended after {frames} frames ({status}): {said}. {remedy}",
        display(path)
    )]
    Encoder {
        /// The output.
        path: PathBuf,
        /// Frames that it was given.
        frames: u64,
        /// How it ended.
        status: String,
        /// What it said.
        said: String,
        /// What to do.
        remedy: &'static str,
    },
    /// The codec does not go into a file of this kind.
    #[error("cannot write {}: {codec} does not go into such a file. Write to {remedy}", display(path))]
    Codec {
        /// The output.
        path: PathBuf,
        /// The codec.
        codec: &'static str,
        /// Names that would do.
        remedy: &'static str,
    },
    /// Standard output is gone, or full.
    #[error("cannot write to standard output after {frames} frames: {cause}")]
    Output {
        /// Frames that were written.
        frames: u64,
        /// What the system said.
        cause: String,
    },
    /// The request makes no sense, in words.
    #[error("{0}")]
    Request(String),
    /// The run was stopped.
    #[error(transparent)]
    Stopped(#[from] crate::run::Stopped),
}

/// How ffmpeg is installed on this system.
const INSTALL: &str = if cfg!(target_os = "macos") {
    "brew install ffmpeg"
} else if cfg!(windows) {
    "winget install ffmpeg"
} else {
    "apt install ffmpeg, dnf install ffmpeg or pacman -S ffmpeg"
};
