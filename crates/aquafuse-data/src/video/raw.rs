//! Frames on standard input and output: raw ones, and the header of YUV4MPEG2.

use std::io::{ErrorKind, Read, Write, stdin, stdout};
use std::str::FromStr;

use super::{Frame, Ratio, Shape, Sink, Source, VideoError, VideoInfo};

/// Raw frames: 8 bits of red, green and blue for each pixel, row by row, without anything in between.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RawFrames {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Frames a second.
    pub rate: Option<Ratio>,
}

impl FromStr for RawFrames {
    type Err = &'static str;

    /// Reads `640x480` or `640x480@30`.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        const FORM: &str = "give WIDTHxHEIGHT, or WIDTHxHEIGHT@RATE with the frames a second";
        let (size, rate) = match text.split_once('@') {
            Some((size, rate)) => (size, Some(rate.parse::<Ratio>().map_err(|_| FORM)?)),
            None => (text, None),
        };
        let (width, height) = size.split_once('x').ok_or(FORM)?;
        let side = |text: &str| text.parse().ok().filter(|side| (1..=65_535).contains(side)).ok_or(FORM);
        if rate.is_some_and(|Ratio(above, below)| above <= 0 || below <= 0) {
            return Err(FORM);
        }
        Ok(Self { width: side(width)?, height: side(height)?, rate })
    }
}

impl RawFrames {
    /// The same as a video.
    pub(super) fn info(self, pixel_format: &str) -> VideoInfo {
        let Ratio(above, below) = self.rate.unwrap_or(Ratio(25, 1));
        VideoInfo {
            width: self.width,
            height: self.height,
            pixel_format: pixel_format.to_owned(),
            time_base: Ratio(below, above),
            rate: self.rate,
            duration: None,
            pixel_aspect: None,
            is_interlaced: false,
            streams: Vec::new(),
            start: 0.0,
            colour: super::log::Colour::default(),
        }
    }
}

/// Raw frames from standard input.
pub(super) struct RawSource {
    shape: Shape,
    frames: i64,
    damage: Option<String>,
}

impl RawSource {
    pub(super) fn new(shape: Shape) -> Self {
        Self { shape, frames: 0, damage: None }
    }
}

impl Source for RawSource {
    fn next(&mut self, frame: &mut Frame) -> Result<bool, VideoError> {
        frame.bytes.resize(self.shape.bytes(), 0);
        let mut rest = frame.bytes.as_mut_slice();
        let mut from = stdin().lock();
        while !rest.is_empty() {
            match from.read(rest) {
                Ok(0) => break,
                Ok(length) => rest = rest.get_mut(length..).unwrap_or_default(),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => {
                    self.damage = Some(error.to_string());
                    return Ok(false);
                }
            }
        }
        if !rest.is_empty() {
            let there = self.shape.bytes().saturating_sub(rest.len());
            if there > 0 {
                self.damage = Some(format!("it ends {there} bytes into a frame of {}", self.shape.bytes()));
            }
            return Ok(false);
        }
        frame.time = self.frames;
        self.frames = self.frames.saturating_add(1);
        Ok(true)
    }

    fn end(&mut self) -> Option<String> {
        self.damage.take()
    }
}

/// Raw frames to standard output.
#[derive(Default)]
pub(super) struct RawSink {
    frames: u64,
}

impl Sink for RawSink {
    fn write(&mut self, frame: &Frame) -> Result<(), VideoError> {
        let mut to = stdout().lock();
        to.write_all(&frame.bytes)
            .and_then(|()| to.flush())
            .map_err(|error| VideoError::Output { frames: self.frames, cause: error.to_string() })?;
        self.frames = self.frames.saturating_add(1);
        Ok(())
    }

    fn finish(&mut self) -> Result<(), VideoError> {
        Ok(())
    }
}

/// Bytes that the header of YUV4MPEG2 may have.
const LONGEST: usize = 4096;

/// Reads the header of YUV4MPEG2 from standard input: its bytes, and what it says.
pub(super) fn y4m_header() -> Result<(Vec<u8>, VideoInfo), VideoError> {
    let refused = |cause: &str| VideoError::Stream {
        cause: cause.to_owned(),
        remedy: "Pipe YUV4MPEG2 into it (`ffmpeg ... -f yuv4mpegpipe -`), or raw frames with --raw WIDTHxHEIGHT",
    };
    let mut header = Vec::new();
    let mut from = stdin().lock();
    loop {
        let mut byte = [0];
        match from.read(&mut byte) {
            Ok(0) => return Err(refused("it ends before a header")),
            Ok(_) => header.extend(byte),
            Err(error) if error.kind() == ErrorKind::Interrupted => continue,
            Err(error) => return Err(refused(&error.to_string())),
        }
        if header.ends_with(b"\n") {
            break;
        }
        let begins = b"YUV4MPEG2 ".iter().zip(&header).all(|(a, b)| a == b);
        if !begins || header.len() >= LONGEST {
            return Err(refused("it is no YUV4MPEG2"));
        }
    }
    let info = y4m_info(&String::from_utf8_lossy(&header)).ok_or_else(|| refused("its header is damaged"))?;
    Ok((header, info))
}

/// Reads a header.
#[cfg(feature = "fuzz-targets")]
pub(crate) fn try_y4m(bytes: &[u8]) {
    if let Some(info) = y4m_info(&String::from_utf8_lossy(bytes)) {
        assert!((1..=65_535).contains(&info.width) && (1..=65_535).contains(&info.height));
        std::hint::black_box((info.frames(), info.is_deep()));
    }
}

fn y4m_info(header: &str) -> Option<VideoInfo> {
    let mut words = header.trim_end().split(' ');
    if words.next() != Some("YUV4MPEG2") {
        return None;
    }
    let (mut width, mut height, mut rate, mut aspect) = (None, None, None, None);
    let (mut colour, mut is_full, mut is_interlaced) = ("420jpeg", false, false);
    for word in words {
        let value = word.get(1..).unwrap_or_default();
        match word.chars().next() {
            Some('W') => width = value.parse().ok(),
            Some('H') => height = value.parse().ok(),
            Some('F') => rate = value.parse().ok().filter(|&Ratio(a, b)| a > 0 && b > 0),
            Some('A') => aspect = value.parse().ok().filter(|&Ratio(a, b)| a > 0 && b > 0 && a != b),
            Some('C') => colour = value,
            Some('I') => is_interlaced = !matches!(value, "p" | "?"),
            Some('X') => is_full |= word == "XCOLORRANGE=FULL",
            _ => {}
        }
    }
    let within = |side: Option<usize>| side.filter(|side| (1..=65_535).contains(side));
    let frames = RawFrames { width: within(width)?, height: within(height)?, rate };
    let chroma = ["444", "422", "411"].into_iter().find(|chroma| colour.starts_with(chroma)).unwrap_or("420");
    let bits = colour.split_once('p').map(|(_, bits)| bits).filter(|bits| bits.parse::<u32>().is_ok());
    let format = match bits {
        Some(bits) => format!("yuv{chroma}p{bits}le"),
        None => format!("yuv{chroma}p"),
    };
    let info = frames.info(&format);
    let range = if is_full { "pc" } else { "tv" }.to_owned();
    let colour = super::log::Colour { range, ..info.colour };
    Some(VideoInfo { pixel_aspect: aspect, is_interlaced, colour, ..info })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn raw_frames_have_a_size_and_perhaps_a_rate() {
        let raw = |text: &str| text.parse::<RawFrames>();
        assert_eq!(raw("640x480"), Ok(RawFrames { width: 640, height: 480, rate: None }));
        assert_eq!(raw("2x1@30000/1001").unwrap().rate, Some(Ratio(30_000, 1001)));
        for wrong in ["", "640", "0x1", "1x99999999", "1x1@", "1x1@0", "1x1@1/0", "axb", "-1x1"] {
            assert!(raw(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn headers_of_y4m_are_read() {
        let info = y4m_info("YUV4MPEG2 W64 H48 F30000:1001 Ip A4:3 C422p10 XYSCSS=422P10 XCOLORRANGE=FULL\n")
            .unwrap();
        assert_eq!((info.width, info.height, info.rate), (64, 48, Some(Ratio(30_000, 1001))));
        assert_eq!((info.pixel_format.as_str(), info.is_deep()), ("yuv422p10le", true));
        assert_eq!((info.pixel_aspect, info.colour.range.as_str()), (Some(Ratio(4, 3)), "pc"));
        assert_eq!(y4m_info("YUV4MPEG2 W64 H48 F25:1 C420mpeg2").unwrap().pixel_format, "yuv420p");
        for wrong in
            ["", "YUV4MPEG2", "YUV4MPEG2 W0 H1", "YUV4MPEG2 W1 H1000000", "YUV4MPEG W1 H1", "YUV4MPEG2 W H ä"]
        {
            assert_eq!(y4m_info(wrong), None, "{wrong}");
        }
    }
}
