//! Frames to a video file, by ffmpeg, which copies everything else from the source.
//!
//! Frames are passed in IVF: a header, and before each frame its length and its time. It is the simplest of all formats in which a
//! frame has a time, and ffmpeg reads it with pixels of any kind.

use std::ffi::OsString;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process::{ChildStdin, ExitStatus, Stdio};

use super::container::{Codec, Container, planar};
use super::decode::{is_full, matrix};
use super::ffmpeg::{Ffmpeg, Running, Said, file, input};
use super::{Frame, Ratio, Shape, Sink, StreamKind, VideoError, VideoInfo};

/// Frames a second of a stream that does not say it.
const USUAL_RATE: Ratio = Ratio(25, 1);

/// A file to write.
pub(super) struct Target<'p> {
    /// The file that is filled.
    pub(super) part: &'p Path,
    /// The name it gets, for messages.
    pub(super) path: &'p Path,
    /// The file that everything but the frames is copied from.
    pub(super) source: Option<&'p Path>,
    pub(super) container: Container,
    pub(super) codec: Codec,
    pub(super) crf: Option<u8>,
}

/// A video that is encoded.
#[derive(Debug)]
pub(super) struct Encoder {
    running: Running,
    pixels: Option<BufWriter<ChildStdin>>,
    path: PathBuf,
    /// Whether it reads the time of each frame.
    has_times: bool,
    frames: u64,
}

impl Encoder {
    /// Starts to write a file; `first` is the time of its first frame.
    pub(super) fn to_file(
        ffmpeg: &Ffmpeg,
        target: &Target<'_>,
        info: &VideoInfo,
        shape: Shape,
        first: i64,
    ) -> Result<Self, VideoError> {
        let mut arguments = frames_in(info, first);
        if let Some(source) = target.source {
            arguments.extend(["-fflags".into(), "+discardcorrupt".into()]);
            arguments.extend(input(source));
        }
        arguments.extend(["-map", "0:v:0"].map(OsString::from));
        if info.keeps_start() {
            arguments.push("-copyts".into());
        }
        if target.source.is_some() {
            arguments.extend(copies(info, target.container).into_iter().map(OsString::from));
        }
        let format = target.codec.pixel_format(info);
        arguments.extend(frames_out(ffmpeg, info, &format).into_iter().map(OsString::from));
        let codec = target.codec.arguments(target.crf, target.container);
        arguments.extend(codec.into_iter().map(OsString::from));
        if target.container.holds_mp4_tags() && info.time_base.0 == 1 {
            arguments.extend(["-video_track_timescale".into(), info.time_base.1.to_string().into()]);
        }
        arguments.extend(last_duration(ffmpeg, info).into_iter().map(OsString::from));
        arguments.extend(["-y", "-f", target.container.muxer()].map(OsString::from));
        arguments.push(file(target.part));
        let mut encoder = Self::start(ffmpeg, arguments, Stdio::null(), target.path)?;
        encoder.has_times = true;
        encoder.send(&[&header(info.time_base, shape)])?;
        Ok(encoder)
    }

    /// Starts to write YUV4MPEG2 to standard output. It has a rate and no times.
    pub(super) fn to_y4m(ffmpeg: &Ffmpeg, info: &VideoInfo, shape: Shape) -> Result<Self, VideoError> {
        let Ratio(above, below) = info.rate.unwrap_or(USUAL_RATE);
        let (size, rate) = (format!("{}x{}", shape.width, shape.height), format!("{above}/{below}"));
        let frames = [
            "-f",
            "rawvideo",
            "-pixel_format",
            shape.raw_format(),
            "-video_size",
            &size,
            "-framerate",
            &rate,
        ];
        let mut arguments: Vec<OsString> = frames.map(OsString::from).into();
        arguments.extend(["-i", "pipe:0", "-vf"].map(OsString::from));
        arguments.push(filters(info, &planar(info, shape.is_deep)).into());
        arguments.extend(["-strict", "-1", "-f", "yuv4mpegpipe", "pipe:1"].map(OsString::from));
        Self::start(ffmpeg, arguments, Stdio::inherit(), Path::new("-"))
    }

    fn start(
        ffmpeg: &Ffmpeg,
        arguments: Vec<OsString>,
        stdout: Stdio,
        path: &Path,
    ) -> Result<Self, VideoError> {
        let mut command = ffmpeg.command();
        command.args(arguments).stdin(Stdio::piped()).stdout(stdout);
        let running = ffmpeg.start(&mut command)?;
        let pixels = running.program.stdin().map(BufWriter::new);
        Ok(Self { running, pixels, path: path.to_owned(), has_times: false, frames: 0 })
    }

    fn send(&mut self, parts: &[&[u8]]) -> Result<(), VideoError> {
        let sent = match &mut self.pixels {
            Some(pixels) => parts.iter().try_for_each(|part| pixels.write_all(part)),
            None => return Ok(()),
        };
        sent.map_err(|_| {
            self.pixels = None;
            let (status, said) = self.running.end();
            self.failed(status, &said)
        })
    }

    fn failed(&self, status: Option<ExitStatus>, said: &Said) -> VideoError {
        VideoError::Encoder {
            path: self.path.clone(),
            frames: self.frames,
            status: status.map_or("no status".to_owned(), |status| status.to_string()),
            said: said.words(),
            remedy: remedy(status, said),
        }
    }
}

impl Sink for Encoder {
    fn write(&mut self, frame: &Frame) -> Result<(), VideoError> {
        let length = u32::try_from(frame.bytes.len()).unwrap_or(u32::MAX);
        if self.has_times {
            self.send(&[&length.to_le_bytes(), &frame.time.to_le_bytes()])?;
        }
        self.send(&[&frame.bytes])?;
        self.frames = self.frames.saturating_add(1);
        Ok(())
    }

    fn finish(&mut self) -> Result<(), VideoError> {
        let flushed = self.pixels.take().map_or(Ok(()), |mut pixels| pixels.flush());
        let (status, said) = self.running.end();
        // It may end without an error though the disk was full: what it wrote counts.
        let is_all = said.frames.is_none_or(|frames| frames == self.frames);
        let is_cut = ["No space left", "Error writing trailer", "av_interleaved_write_frame"];
        let is_whole = is_all && !is_cut.iter().any(|words| said.has(words));
        match flushed.is_ok() && is_whole && status.is_some_and(|status| status.success()) {
            true => Ok(()),
            false => Err(self.failed(status, &said)),
        }
    }
}

/// The arguments by which frames are read. Where a file begins at 0, ffmpeg takes the time of the first frame off all others: it is
/// added again.
fn frames_in(info: &VideoInfo, first: i64) -> Vec<OsString> {
    if info.keeps_start() {
        return ["-f", "ivf", "-c:v", "rawvideo", "-i", "pipe:0"].map(OsString::from).into();
    }
    let Ratio(above, below) = info.time_base;
    let micros = i128::from(first).saturating_mul(i128::from(above)).saturating_mul(1_000_000);
    let micros = micros.checked_div(i128::from(below)).unwrap_or(0);
    let sign = if micros < 0 { "-" } else { "" };
    let (seconds, rest) = (micros.unsigned_abs() / 1_000_000, micros.unsigned_abs() % 1_000_000);
    let offset = format!("{sign}{seconds}.{rest:06}");
    ["-f", "ivf", "-c:v", "rawvideo", "-itsoffset", &offset, "-i", "pipe:0"].map(OsString::from).into()
}

/// The arguments by which the last frame is shown for a while: a frame has a time, and no duration.
fn last_duration(ffmpeg: &Ffmpeg, info: &VideoInfo) -> Vec<String> {
    let ticks = info.rate.and_then(|rate| Some((rate.value()? * info.time_base.value()?).recip().round()));
    match ticks {
        Some(ticks) if ffmpeg.is_new() && (1.0..1e9).contains(&ticks) => {
            vec!["-bsf:v".to_owned(), format!("setts=pts=PTS:dts=DTS:duration={ticks}")]
        }
        _ => Vec::new(),
    }
}

/// The header of IVF.
fn header(Ratio(above, below): Ratio, shape: Shape) -> [u8; 32] {
    let mut header = [0; 32];
    let size = |length: usize| u16::try_from(length).unwrap_or(u16::MAX).to_le_bytes();
    let number = |number: i64| u32::try_from(number).unwrap_or(1).to_le_bytes();
    let depth = if shape.is_deep { 48 } else { 24 };
    let parts: [&[u8]; 8] = [
        b"DKIF",
        &[0, 0, 32, 0],
        &[b'R', b'G', b'B', depth],
        &size(shape.width),
        &size(shape.height),
        &number(below),
        &number(above),
        &[0; 8],
    ];
    header.iter_mut().zip(parts.concat()).for_each(|(to, from)| *to = from);
    header
}

/// The arguments by which everything but the frames is copied.
fn copies(info: &VideoInfo, container: Container) -> Vec<String> {
    let mut arguments: Vec<String> = Vec::new();
    let mut codecs: Vec<String> = Vec::new();
    let mut tags = Vec::new();
    let kinds = [(StreamKind::Audio, "a"), (StreamKind::Subtitles, "s"), (StreamKind::Attachment, "t")];
    for (kind, letter) in kinds {
        let streams = info.streams.iter().filter(|stream| stream.kind == kind);
        let taken = streams.filter_map(|stream| Some((stream, container.takes(stream)?)));
        for (i, (stream, how)) in taken.enumerate() {
            arguments.extend(["-map".to_owned(), format!("1:{}", stream.index)]);
            codecs.extend([format!("-c:{letter}:{i}"), how.to_owned()]);
            tags.push((letter, i, stream.index));
        }
    }
    arguments.extend(codecs);
    arguments.extend(["-map_metadata", "1", "-map_chapters", "1"].map(str::to_owned));
    if let Some(video) = info.streams.iter().find(|stream| stream.kind == StreamKind::Video) {
        tags.push(("v", 0, video.index));
        // Frames are rotated already, and their bytes are others.
        for old in ["rotate", "BPS", "BPS-eng", "NUMBER_OF_BYTES", "NUMBER_OF_BYTES-eng"] {
            arguments.extend(["-metadata:s:v:0".to_owned(), format!("{old}=")]);
        }
    }
    // Once those of one stream are named, no others are copied unless they are named too.
    for (letter, i, index) in tags {
        arguments.extend([format!("-map_metadata:s:{letter}:{i}"), format!("1:s:{index}")]);
    }
    arguments.extend(["-max_muxing_queue_size", "9999"].map(str::to_owned));
    arguments
}

/// The arguments from red, green and blue to the pixels of the file, at the times of the frames.
fn frames_out(ffmpeg: &Ffmpeg, info: &VideoInfo, format: &str) -> Vec<String> {
    let Ratio(above, below) = info.time_base;
    let mut arguments: Vec<String> = ffmpeg.passthrough().map(str::to_owned).into();
    arguments.extend(["-enc_time_base".to_owned(), format!("{above}/{below}")]);
    arguments.extend(["-vf".to_owned(), filters(info, format)]);
    if format.starts_with("yuv") {
        let tags = colour_tags(info).into_iter().filter(|(_, _, value)| *value != "unknown");
        arguments.extend(tags.flat_map(|(option, _, value)| [option.to_owned(), value.to_owned()]));
    }
    arguments
}

/// From red, green and blue to the pixels of the file.
fn filters(info: &VideoInfo, format: &str) -> String {
    let mut filters = Vec::new();
    if format.starts_with("yuv") {
        let range = if is_full(info) { "pc" } else { "tv" };
        let matrix = matrix(info);
        filters.push(format!("scale=in_range=pc:out_color_matrix={matrix}:out_range={range}:flags=bicubic"));
    }
    filters.push(format!("format={format}"));
    if format.starts_with("yuv") {
        // From version 7 on, the tags of frames count and the options do not.
        let tags = colour_tags(info).map(|(_, tag, value)| format!("{tag}={value}"));
        filters.push(format!("setparams={}", tags.join(":")));
    }
    if let Some(Ratio(above, below)) = info.pixel_aspect {
        filters.push(format!("setsar={above}/{below}"));
    }
    filters.join(",")
}

/// How colours are coded, by name and value; where the source does not say it, it is `unknown`.
fn colour_tags(info: &VideoInfo) -> [(&'static str, &'static str, &str); 4] {
    const SPACES: [&str; 7] = ["bt709", "fcc", "bt470bg", "smpte170m", "smpte240m", "bt2020nc", "bt2020c"];
    const PRIMARIES: [&str; 10] = [
        "bt709",
        "bt470m",
        "bt470bg",
        "smpte170m",
        "smpte240m",
        "film",
        "bt2020",
        "smpte428",
        "smpte431",
        "smpte432",
    ];
    const TRANSFERS: [&str; 9] = [
        "bt709",
        "smpte170m",
        "smpte240m",
        "linear",
        "iec61966-2-1",
        "bt2020-10",
        "bt2020-12",
        "smpte2084",
        "arib-std-b67",
    ];
    let colour = &info.colour;
    // Other names may mean something else as an option, or nothing.
    let known = |names: &[&str], name| if names.contains(&name) { name } else { "unknown" };
    [
        ("-colorspace", "colorspace", known(&SPACES, colour.space.as_str())),
        ("-color_primaries", "color_primaries", known(&PRIMARIES, colour.primaries.as_str())),
        ("-color_trc", "color_trc", known(&TRANSFERS, colour.transfer.as_str())),
        ("-color_range", "range", if is_full(info) { "pc" } else { "tv" }),
    ]
}

/// What to do about an encoder that failed.
fn remedy(status: Option<ExitStatus>, said: &Said) -> &'static str {
    if said.has("No space left") {
        return "Free space on its disk, and run the command again";
    }
    if said.has("supported in container")
        || said.has("Could not write header")
        || said.has("supported for WebM")
    {
        return "Write to a .mkv file, which takes sound and subtitles of any kind";
    }
    if said.has("Unknown encoder") {
        return "This ffmpeg lacks the encoder: install a complete one, or give another --codec";
    }
    if status.is_some_and(|status| status.code().is_none()) {
        return "Something ended it: if the system was out of memory, close other programs. Run the command again";
    }
    "Check that this ffmpeg can write such a file, or give another --codec"
}
