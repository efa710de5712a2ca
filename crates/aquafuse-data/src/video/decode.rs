//! A video file, decoded by ffmpeg: frame after frame in red, green and blue, each with its time.

use std::io::{ErrorKind, Read};
use std::path::Path;
use std::process::{ChildStdout, Stdio};

use super::ffmpeg::{Ffmpeg, Running, Said, input};
use super::log::Shown;
use super::probe::is_rgb;
use super::{Frame, Shape, Source, VideoError, VideoInfo};
use crate::files::one_line;

/// A video that is decoded.
#[derive(Debug)]
pub(super) struct Decoder {
    running: Running,
    pixels: ChildStdout,
    shape: Shape,
    last: Option<i64>,
    damage: Option<String>,
}

/// Where ffmpeg reads the video.
pub(super) enum Place<'p> {
    /// A file.
    File(&'p Path),
    /// Standard input, by a thread of ours that has read the beginning: YUV4MPEG2.
    Y4m(Vec<u8>),
}

impl Decoder {
    pub(super) fn start(
        ffmpeg: &Ffmpeg,
        place: Place<'_>,
        info: &VideoInfo,
        shape: Shape,
    ) -> Result<Self, VideoError> {
        let mut command = ffmpeg.command();
        let stdin = match &place {
            Place::File(path) => {
                // A packet that is cut would be decoded to a frame that is half grey.
                command.args(["-fflags", "+discardcorrupt"]).args(input(path));
                if info.keeps_start() {
                    command.arg("-copyts");
                }
                Stdio::null()
            }
            Place::Y4m(_) => {
                command.args(["-f", "yuv4mpegpipe", "-i", "pipe:0"]);
                Stdio::piped()
            }
        };
        command.args(["-map", "0:V:0"]).args(ffmpeg.passthrough());
        command.args(["-vf", &filters(info, shape), "-f", "rawvideo", "pipe:1"]);
        let running = ffmpeg.start(command.stdin(stdin).stdout(Stdio::piped()))?;
        if let (Place::Y4m(begun), Some(mut stdin)) = (place, running.program.stdin()) {
            // It waits for standard input, and nobody waits for it.
            let feed = move || {
                use std::io::Write;
                let _ =
                    stdin.write_all(&begun).and_then(|()| std::io::copy(&mut std::io::stdin(), &mut stdin));
            };
            let _ = std::thread::Builder::new().spawn(feed);
        }
        let pixels = running.program.stdout().ok_or_else(|| VideoError::Start {
            program: Ffmpeg::NAME.into(),
            cause: "it has no output".into(),
        })?;
        Ok(Self { running, pixels, shape, last: None, damage: None })
    }

    /// What is shown of the next frame; nothing once there is none.
    fn shown(&mut self) -> Option<Box<super::log::FrameInfo>> {
        loop {
            match self.running.shown.recv() {
                Ok(Shown::Frame(frame)) => return Some(frame),
                Ok(_) => {}
                Err(_) => return None,
            }
        }
    }
}

impl Source for Decoder {
    fn next(&mut self, frame: &mut Frame) -> Result<bool, VideoError> {
        frame.bytes.resize(self.shape.bytes(), 0);
        match self.pixels.read_exact(&mut frame.bytes) {
            Ok(()) => {}
            // The end, or within a frame.
            Err(error) if error.kind() == ErrorKind::UnexpectedEof => return Ok(false),
            Err(error) => {
                self.damage = Some(error.to_string());
                return Ok(false);
            }
        }
        let Some(shown) = self.shown() else { return Ok(false) };
        if (shown.width, shown.height) != (self.shape.width, self.shape.height) {
            let (width, height) = (shown.width, shown.height);
            self.damage =
                Some(format!("its frames change their size, to {width} x {height}; split the file there"));
            return Ok(false);
        }
        // Times rise from frame to frame, whatever a damaged file says.
        let next = self.last.map_or(0, |last| last.saturating_add(1));
        let time = shown.time.filter(|&time| self.last.is_none() || time >= next).unwrap_or(next);
        self.last = Some(time);
        frame.time = time;
        Ok(true)
    }

    fn end(&mut self) -> Option<String> {
        if self.damage.is_some() {
            return self.damage.take();
        }
        let (status, said) = self.running.end();
        let Said { count, .. } = said;
        let is_fine = status.is_some_and(|status| status.success());
        (count > 0 || !is_fine).then(|| match (is_fine, status) {
            (false, Some(status)) if count == 0 => one_line(&format!("ffmpeg ended with {status}")),
            _ => said.words(),
        })
    }
}

/// From the pixels of the file to red, green and blue, over the whole range.
pub(super) fn filters(info: &VideoInfo, shape: Shape) -> String {
    let format = shape.raw_format();
    if is_rgb(&info.pixel_format) {
        return format!("format={format},showinfo=checksum=0");
    }
    let matrix = matrix(info);
    let range = if is_full(info) { "pc" } else { "tv" };
    format!(
        "scale=in_color_matrix={matrix}:in_range={range}:out_range=pc:flags=bicubic,format={format},showinfo=checksum=0"
    )
}

/// Whether values take the whole range.
pub(super) fn is_full(info: &VideoInfo) -> bool {
    info.colour.range == "pc" || info.pixel_format.starts_with("yuvj")
}

/// The matrix from red, green and blue, by the name that the filter `scale` has for it. Where the file does not say, it goes by
/// the size, as players do.
pub(super) fn matrix(info: &VideoInfo) -> &'static str {
    match info.colour.space.as_str() {
        "bt709" => "bt709",
        "smpte170m" | "bt470bg" => "bt601",
        "fcc" => "fcc",
        "smpte240m" => "smpte240m",
        "bt2020nc" | "bt2020c" => "bt2020",
        _ if info.height >= 720 || info.width >= 1280 => "bt709",
        _ => "bt601",
    }
}
