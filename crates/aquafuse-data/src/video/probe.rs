//! What a video is: its first frame is decoded, and what ffmpeg says about file and frame is read.

use std::path::Path;
use std::process::Stdio;

use super::ffmpeg::{Ffmpeg, input};
use super::log::{Colour, Shown};
use super::{Ratio, VideoError};

/// What a video is.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct VideoInfo {
    /// Columns of a frame, as it is shown: rotated, if the file says so.
    pub width: usize,
    /// Rows of a frame.
    pub height: usize,
    /// The name that ffmpeg has for the format of its pixels.
    pub pixel_format: String,
    /// The unit of times, in seconds.
    pub time_base: Ratio,
    /// Frames a second, where the file says so; a mean if the rate varies.
    pub rate: Option<Ratio>,
    /// How long it is, in seconds.
    pub duration: Option<f64>,
    /// Width of a pixel over its height, if it is not 1.
    pub pixel_aspect: Option<Ratio>,
    /// Whether frames consist of two halves of different times.
    pub is_interlaced: bool,
    /// All streams of the file.
    pub streams: Vec<StreamInfo>,
    /// When its first stream begins, in seconds.
    pub(super) start: f64,
    pub(super) colour: Colour,
}

/// A stream of a file.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct StreamInfo {
    /// Its number in the file.
    pub index: usize,
    /// What it holds.
    pub kind: StreamKind,
    /// The name that ffmpeg has for its codec.
    pub codec: String,
}

/// What a stream holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum StreamKind {
    /// Frames.
    Video,
    /// A picture that goes with the file, as a cover.
    Cover,
    /// Sound.
    Audio,
    /// Subtitles.
    Subtitles,
    /// Fonts and other files.
    Attachment,
    /// Anything else, as telemetry.
    Data,
}

impl VideoInfo {
    /// Reads what a video is.
    ///
    /// # Errors
    ///
    /// [`VideoError`] when the file is no video, or no frame of it can be decoded.
    pub fn read(ffmpeg: &Ffmpeg, path: &Path) -> Result<Self, VideoError> {
        // A file that is not there has an error of its own, with its remedy.
        let about = std::fs::File::open(path)
            .and_then(|file| file.metadata())
            .map_err(|error| crate::files::FileError::Read { path: path.to_owned(), error })?;
        if about.is_dir() {
            return Err(VideoError::Folder { path: path.to_owned() });
        }
        let mut command = ffmpeg.command();
        command.args(input(path)).args(["-map", "0:V:0", "-frames:v", "1", "-vf", "showinfo=checksum=0"]);
        command.args(["-f", "null", "-"]).stdin(Stdio::null()).stdout(Stdio::null());
        let mut running = ffmpeg.start(&mut command)?;
        let mut found = Found::default();
        running.shown.iter().for_each(|shown| found.take(shown));
        let (_, said) = running.end();
        let path = path.to_owned();
        match found.info() {
            Some(info) => Ok(info),
            None if found.streams.is_empty() => Err(VideoError::Unreadable { path, said: said.words() }),
            None if !found.streams.iter().any(|stream| stream.kind == StreamKind::Video) => {
                Err(VideoError::NoVideoStream { path })
            }
            None => Err(VideoError::NoFrames { path, said: said.words() }),
        }
    }

    /// How many frames it has, about.
    pub fn frames(&self) -> Option<u64> {
        let count = self.duration? * self.rate?.value()?;
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a cast of a float saturates"
        )]
        Some(count.round() as u64)
    }

    /// Whether times are kept as they are: a stream that was broadcast may begin at any time, and then the file begins at 0.
    pub(super) fn keeps_start(&self) -> bool {
        self.start.abs() < 1.0
    }

    /// Whether values have more than 8 bits.
    pub fn is_deep(&self) -> bool {
        bits(&self.pixel_format) > 8
    }
}

/// What was read so far.
#[derive(Default)]
struct Found {
    streams: Vec<StreamInfo>,
    duration: Option<f64>,
    start: f64,
    stream: Option<(Ratio, Option<Ratio>)>,
    frame: Option<super::log::FrameInfo>,
    colour: Option<Colour>,
}

impl Found {
    fn take(&mut self, shown: Shown) {
        match shown {
            // What follows the configuration is about the output.
            Shown::Input(line) if self.stream.is_none() => {
                if let Some(duration) = line.strip_prefix("Duration: ") {
                    self.duration = seconds(duration.split(',').next().unwrap_or_default());
                    let start = duration.split_once("start: ").and_then(|(_, rest)| rest.split(',').next());
                    self.start = start.and_then(|start| start.parse().ok()).unwrap_or(0.0);
                }
                self.streams.extend(stream(&line));
            }
            Shown::Stream { time_base, rate } if self.stream.is_none() => {
                self.stream = Some((time_base, rate));
            }
            Shown::Frame(frame) if self.frame.is_none() => self.frame = Some(*frame),
            Shown::Colour(colour) if self.colour.is_none() => self.colour = Some(colour),
            _ => {}
        }
    }

    fn info(&self) -> Option<VideoInfo> {
        let frame = self.frame.clone()?;
        let (time_base, rate) = self.stream?;
        Some(VideoInfo {
            width: frame.width,
            height: frame.height,
            pixel_format: frame.format,
            time_base,
            rate: rate.filter(|rate| rate.value().is_some_and(|rate| rate > 0.0)),
            duration: self.duration,
            pixel_aspect: Some(frame.pixel_aspect).filter(|&Ratio(a, b)| a > 0 && b > 0 && a != b),
            is_interlaced: frame.is_interlaced,
            streams: self.streams.clone(),
            start: self.start,
            colour: self.colour.clone().unwrap_or_default(),
        })
    }
}

/// Reads a log.
#[cfg(feature = "fuzz-targets")]
pub(crate) fn try_log(bytes: &[u8]) {
    let mut found = Found::default();
    for line in bytes.split(|&byte| byte == b'\n') {
        if let Some(super::log::Line::Shown(shown)) = super::log::Line::parse(&String::from_utf8_lossy(line))
        {
            found.take(shown);
        }
    }
    if let Some(info) = found.info() {
        assert!(info.width > 0 && info.height > 0, "a frame has pixels");
        std::hint::black_box((info.frames(), info.is_deep(), info.keeps_start()));
    }
}

/// `01:02:03.50` in seconds.
fn seconds(text: &str) -> Option<f64> {
    text.split(':').try_fold(0.0, |sum, part| Some(60.0 * sum + part.trim().parse::<f64>().ok()?))
}

/// `Stream #0:1[0x2](und): Audio: aac (LC) ...`
fn stream(line: &str) -> Option<StreamInfo> {
    let rest = line.strip_prefix("Stream #0:")?;
    let index = rest.split(|c: char| !c.is_ascii_digit()).next()?.parse().ok()?;
    let mut parts = rest.splitn(3, ": ");
    let (_, kind, about) = (parts.next()?, parts.next()?, parts.next()?);
    let codec = about.split([' ', ',']).next()?.to_owned();
    let kind = match kind {
        "Video" if about.contains("(attached pic)") => StreamKind::Cover,
        "Video" => StreamKind::Video,
        "Audio" => StreamKind::Audio,
        "Subtitle" => StreamKind::Subtitles,
        "Attachment" => StreamKind::Attachment,
        _ => StreamKind::Data,
    };
    Some(StreamInfo { index, kind, codec })
}

/// How many bits the values of a pixel format have, by its name.
pub(super) fn bits(format: &str) -> u32 {
    const PACKED: [&str; 7] = ["rgb48", "bgr48", "rgba64", "bgra64", "ya16", "gray16", "xyz12"];
    if PACKED.iter().any(|packed| format.starts_with(packed)) {
        return 16;
    }
    if ["x2rgb10", "x2bgr10", "v30x", "p010", "p210", "p410"].iter().any(|ten| format.starts_with(ten)) {
        return 10;
    }
    if format.contains("f32") || format.contains("f16") {
        return 16;
    }
    let stem = format.trim_end_matches("le").trim_end_matches("be");
    let digits = stem.len().saturating_sub(2);
    match stem.split_at_checked(digits) {
        Some((before, bits)) if before.ends_with('p') || before == "gray" => bits.parse().unwrap_or(8),
        _ if stem.ends_with("p9") || stem.ends_with("gray9") => 9,
        _ if stem.starts_with("p016") || stem.starts_with("p012") => 16,
        _ => 8,
    }
}

/// Whether a pixel format holds red, green and blue.
pub(super) fn is_rgb(format: &str) -> bool {
    const RGB: [&str; 10] = ["rgb", "bgr", "gbr", "argb", "abgr", "0rgb", "0bgr", "x2rgb", "x2bgr", "pal8"];
    RGB.iter().any(|rgb| format.starts_with(rgb))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_and_durations_are_read() {
        let line = "Stream #0:1[0x2](und): Audio: aac (LC) (mp4a / 0x6134706D), 44100 Hz, mono, fltp, 69 kb/s (default)";
        let audio = StreamInfo { index: 1, kind: StreamKind::Audio, codec: "aac".into() };
        assert_eq!(stream(line), Some(audio));
        let line = "Stream #0:12: Video: mjpeg (Baseline), yuvj420p(pc), 8x8, 90k tbr (attached pic)";
        assert_eq!(stream(line).map(|stream| (stream.index, stream.kind)), Some((12, StreamKind::Cover)));
        assert_eq!(stream("Stream #0:"), None);
        assert_eq!((seconds("00:01:03.50"), seconds("N/A")), (Some(63.5), None));
    }

    #[test]
    fn pixel_formats_say_how_many_bits_they_have() {
        for (format, wanted) in [
            ("yuv420p", 8),
            ("yuvj420p", 8),
            ("yuv420p10le", 10),
            ("yuv422p12be", 12),
            ("gbrp16le", 16),
            ("gray10le", 10),
            ("gray", 8),
            ("nv12", 8),
            ("p010le", 10),
            ("rgb48le", 16),
            ("rgb24", 8),
            ("yuv411p", 8),
            ("yuva420p", 8),
            ("gbrp9le", 9),
            ("pal8", 8),
            ("", 8),
        ] {
            assert_eq!(bits(format), wanted, "{format}");
        }
    }
}
