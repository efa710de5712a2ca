//! What is read and where it is written, checked before the first frame.

use std::path::{Path, PathBuf};

use super::container::{Container, losses};
use super::raw::y4m_header;
use super::{Codec, Ffmpeg, RawFrames, Shape, StreamKind, VideoError, VideoInfo};
use crate::files::{FileError, make_folder_of, refuse_inputs, remove_stale_parts};
use crate::image_file::ReadOptions;
use crate::run::RunOptions;

/// Where frames come from.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Input {
    /// A video file.
    File(PathBuf),
    /// YUV4MPEG2 on standard input.
    Y4m,
    /// Raw frames on standard input.
    Raw(RawFrames),
}

/// Where frames go.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Output {
    /// A video file.
    File(PathBuf),
    /// Standard output: raw frames if those are read, else YUV4MPEG2.
    Stdout,
}

/// What is asked for.
#[derive(Clone, Debug)]
pub struct Request {
    /// Where frames come from.
    pub input: Input,
    /// Where they go.
    pub output: Output,
    /// Files that are read beside it and must not be replaced.
    pub inputs: Vec<PathBuf>,
    /// Whether an existing output is replaced. Default: no.
    pub overwrite: bool,
    /// How frames are compressed. Default: by the kind of file.
    pub codec: Option<Codec>,
}

impl Request {
    /// From one file to another; `-` is YUV4MPEG2 on standard input and output.
    pub fn new(input: impl Into<PathBuf>, output: impl Into<PathBuf>) -> Self {
        let (input, output) = (input.into(), output.into());
        let is_stream = |path: &Path| path.as_os_str() == "-";
        Self {
            input: if is_stream(&input) { Input::Y4m } else { Input::File(input) },
            output: if is_stream(&output) { Output::Stdout } else { Output::File(output) },
            inputs: Vec::new(),
            overwrite: false,
            codec: None,
        }
    }
}

/// A video to be made: what is read is known, and nothing is written yet.
#[derive(Debug)]
pub struct Plan {
    pub(super) input: Input,
    pub(super) output: Output,
    pub(super) overwrite: bool,
    /// Not there where raw frames come and go.
    pub(super) ffmpeg: Option<Ffmpeg>,
    pub(super) file: Option<(Container, Codec)>,
    pub(super) info: VideoInfo,
    pub(super) shape: Shape,
    /// What was read of standard input already.
    pub(super) begun: Vec<u8>,
}

/// Frames that are in work at once.
pub(super) const BUFFERS: usize = 6;
/// Bytes a pixel that the work on a frame takes beside it, at most.
const BESIDE: u64 = 32;

impl Plan {
    /// Looks at what is read, and refuses what can be refused before the first frame.
    ///
    /// # Errors
    ///
    /// [`VideoError`] when ffmpeg is not there, the input is no video or too large, or the output may not be written.
    pub fn new(request: &Request, options: &RunOptions) -> Result<Self, VideoError> {
        let Request { input, output, inputs, overwrite, codec } = request;
        let file = match output {
            Output::File(path) => {
                let read = inputs.iter().map(PathBuf::as_path).chain(input.path());
                refuse_inputs([path.as_path()], read)?;
                if !overwrite && path.symlink_metadata().is_ok() {
                    return Err(FileError::Exists { path: path.clone() }.into());
                }
                let container = Container::of(path)?;
                Some((container, container.codec(*codec, path)?))
            }
            Output::Stdout => None,
        };
        let needs_ffmpeg = file.is_some() || !matches!(input, Input::Raw(_));
        let ffmpeg = needs_ffmpeg.then(Ffmpeg::find).transpose()?;
        let mut begun = Vec::new();
        let info = match (input, &ffmpeg) {
            (Input::File(path), Some(ffmpeg)) => VideoInfo::read(ffmpeg, path)?,
            (Input::Raw(raw), _) => {
                if file.is_some() && raw.rate.is_none() {
                    let why = "raw frames have no times; give their rate, as --raw WIDTHxHEIGHT@30";
                    return Err(VideoError::Request(why.into()));
                }
                raw.info("rgb24")
            }
            _ => {
                let (header, info) = y4m_header()?;
                begun = header;
                info
            }
        };
        let shape = Shape { width: info.width, height: info.height, is_deep: info.is_deep() };
        check_size(input, shape, &options.reading, 0)?;
        if let Output::File(path) = output {
            remove_stale_parts(make_folder_of(path)?);
        }
        Ok(Self {
            input: input.clone(),
            output: output.clone(),
            overwrite: *overwrite,
            ffmpeg,
            file,
            info,
            shape,
            begun,
        })
    }

    /// What the video is.
    #[must_use]
    pub fn info(&self) -> &VideoInfo {
        &self.info
    }

    /// What of the source the output will lack, and what to know about it, in words.
    #[must_use]
    pub fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        if let Some((container, codec)) = self.file {
            let mut videos = 0_usize;
            for stream in &self.info.streams {
                let what = match stream.kind {
                    StreamKind::Video => {
                        videos = videos.saturating_add(1);
                        if videos == 1 {
                            continue;
                        }
                        "video"
                    }
                    _ if container.takes(stream).is_some() => continue,
                    StreamKind::Cover => "cover picture",
                    StreamKind::Subtitles => "subtitles",
                    StreamKind::Attachment => "attachment",
                    _ => "data",
                };
                notes.push(format!("left out: stream {}, {what} ({})", stream.index, stream.codec));
            }
            notes.extend(losses(&self.info, codec));
        }
        if self.info.is_interlaced {
            notes.push("frames are interlaced and are taken as they are; deinterlace the video first".into());
        }
        notes
    }
}

impl Input {
    /// The file, if it is one.
    pub(super) fn path(&self) -> Option<&Path> {
        match self {
            Self::File(path) => Some(path),
            Self::Y4m | Self::Raw(_) => None,
        }
    }

    /// Its name in messages.
    pub(super) fn name(&self) -> PathBuf {
        self.path().unwrap_or(Path::new("standard input")).to_owned()
    }
}

/// Refuses frames that are too large, or that need too much memory with the bytes that are needed beside them.
pub(super) fn check_size(
    input: &Input,
    shape: Shape,
    reading: &ReadOptions,
    beside: u64,
) -> Result<(), VideoError> {
    let Shape { width, height, .. } = shape;
    let pixels = (width as u64).saturating_mul(height as u64);
    let too_large = |limit: String| Err(VideoError::TooLarge { path: input.name(), width, height, limit });
    if pixels > reading.max_pixels {
        return too_large(format!("exceed the limit of {} (--max-pixels)", reading.max_pixels));
    }
    let frames = (shape.bytes() as u64).saturating_mul(BUFFERS as u64);
    let memory = frames.saturating_add(pixels.saturating_mul(BESIDE)).saturating_add(beside);
    if memory > reading.max_memory {
        let [needed, limit] = [memory, reading.max_memory].map(|bytes| bytes.div_ceil(1 << 20));
        return too_large(format!("need {needed} MiB of memory, more than {limit} MiB (--max-memory)"));
    }
    Ok(())
}
