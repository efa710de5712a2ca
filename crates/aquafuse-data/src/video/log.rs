//! Lines of ffmpeg's log, at `-loglevel level+info`.

use super::Ratio;

/// A line that means something to us.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Line {
    /// Something of the filter `showinfo`.
    Shown(Shown),
    /// An error.
    Complaint(String),
    /// The last report: frames that were written.
    Frames(u64),
}

/// What the filter `showinfo` says.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Shown {
    /// Of the stream: the unit of its times in seconds, and its frames a second.
    Stream { time_base: Ratio, rate: Option<Ratio> },
    /// Of a frame.
    Frame(Box<FrameInfo>),
    /// How its colours are coded.
    Colour(Colour),
    /// A stream or the duration of the file, as ffmpeg lists them.
    Input(String),
}

/// A frame of a video, without its pixels.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct FrameInfo {
    /// When it is shown, in units of the time base; unknown in damaged files.
    pub(super) time: Option<i64>,
    pub(super) width: usize,
    pub(super) height: usize,
    /// The name of its pixel format.
    pub(super) format: String,
    /// Width of a pixel over its height; 0 if unknown.
    pub(super) pixel_aspect: Ratio,
    pub(super) is_interlaced: bool,
}

/// How colours are coded, by ffmpeg's names; `unknown` where the file does not say.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Colour {
    pub(super) range: String,
    pub(super) space: String,
    pub(super) primaries: String,
    pub(super) transfer: String,
}

impl Line {
    pub(super) fn parse(line: &str) -> Option<Self> {
        let line = line.trim_end();
        let (who, level, rest) = parts(line)?;
        if matches!(level, "error" | "fatal" | "panic") {
            return Some(Self::Complaint(rest.trim().to_owned()));
        }
        if who.starts_with("Parsed_showinfo") {
            return shown(rest).map(Self::Shown);
        }
        if !who.is_empty() {
            return None;
        }
        if let Some(frames) = rest.strip_prefix("frame=") {
            return frames.split_whitespace().next()?.parse().ok().map(Self::Frames);
        }
        let listed = rest.strip_prefix("  ")?;
        let is_ours = listed.starts_with("Stream #0:") || listed.starts_with("Duration: ");
        is_ours.then(|| Self::Shown(Shown::Input(listed.to_owned())))
    }
}

/// Who speaks, the level, and what is said: `[WHO @ 0x..] [LEVEL] ...` or `[LEVEL] ...`.
fn parts(line: &str) -> Option<(&str, &str, &str)> {
    const LEVELS: [&str; 8] = ["panic", "fatal", "error", "warning", "info", "verbose", "debug", "trace"];
    let mut rest = line;
    let mut who = "";
    // Some have two names, one for the file and one for what reads it.
    for _ in 0..4 {
        let (name, after) = rest
            .strip_prefix('[')?
            .split_once("] ")
            .or_else(|| rest.strip_prefix('[')?.strip_suffix(']').map(|name| (name, "")))?;
        if LEVELS.contains(&name) {
            return Some((who, name, after));
        }
        (who, rest) = (name, after);
    }
    None
}

fn shown(text: &str) -> Option<Shown> {
    if let Some(config) = text.strip_prefix("config in time_base: ") {
        let (time_base, rate) = config.split_once(", frame_rate: ")?;
        return Some(Shown::Stream { time_base: time_base.parse().ok()?, rate: rate.trim().parse().ok() });
    }
    if text.starts_with("n:") {
        return frame(text).map(|frame| Shown::Frame(Box::new(frame)));
    }
    if text.starts_with("color_range:") {
        let value = |name| field(text, name).unwrap_or("unknown").to_owned();
        return Some(Shown::Colour(Colour {
            range: value("color_range:"),
            space: value("color_space:"),
            primaries: value("color_primaries:"),
            transfer: value("color_trc:"),
        }));
    }
    None
}

fn frame(text: &str) -> Option<FrameInfo> {
    let (width, height) = field(text, " s:")?.split_once('x')?;
    Some(FrameInfo {
        time: field(text, " pts:").and_then(|time| time.parse().ok()),
        width: width.parse().ok().filter(|&width| width > 0)?,
        height: height.parse().ok().filter(|&height| height > 0)?,
        format: field(text, " fmt:")?.to_owned(),
        pixel_aspect: field(text, " sar:").and_then(|sar| sar.parse().ok()).unwrap_or(Ratio(0, 1)),
        is_interlaced: !matches!(field(text, " i:"), Some("P") | None),
    })
}

/// The word after a name; there may be spaces between.
fn field<'t>(text: &'t str, name: &str) -> Option<&'t str> {
    text.split_once(name)?.1.split_whitespace().next()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_and_their_colours_are_read() {
        let line = "[Parsed_showinfo_1 @ 0x55a979ff9100] [info] n:   1 pts:    512 pts_time:0.0333333 pos:    37861 \
                    fmt:yuv420p sar:4/3 s:1920x1080 i:T iskey:0 type:P ";
        let Some(Line::Shown(Shown::Frame(frame))) = Line::parse(line) else { panic!("no frame") };
        assert_eq!((frame.time, frame.width, frame.height), (Some(512), 1920, 1080));
        assert_eq!(
            (frame.format.as_str(), frame.pixel_aspect, frame.is_interlaced),
            ("yuv420p", Ratio(4, 3), true)
        );
        let line =
            "[Parsed_showinfo_1 @ 0x5] [info] n: 0 pts:NOPTS pts_time:NOPTS fmt:gray sar:0/1 s:8x8 i:P";
        let Some(Line::Shown(Shown::Frame(frame))) = Line::parse(line) else { panic!("no frame") };
        assert_eq!(frame.time, None);
        let line = "[Parsed_showinfo_0 @ 0x5] [info] color_range:tv color_space:bt709 color_primaries:unknown color_trc:bt709";
        let Some(Line::Shown(Shown::Colour(colour))) = Line::parse(line) else { panic!("no colour") };
        assert_eq!((colour.range.as_str(), colour.transfer.as_str()), ("tv", "bt709"));
    }

    #[test]
    fn errors_are_complaints_whoever_makes_them() {
        for line in [
            "[error] no such thing",
            "[h264 @ 0x1] [error] no such thing",
            "[file @ 0x1] [mov @ 0x2] [fatal] no such thing",
        ] {
            assert_eq!(Line::parse(line), Some(Line::Complaint("no such thing".into())));
        }
        for line in
            ["", "[", "[info]", "[warning] a", "[x @ 0x1] [info] n: 0", "title : [error] x", "[] [] [] [] []"]
        {
            assert_eq!(Line::parse(line), None, "{line}");
        }
        assert_eq!(Line::parse("[info] frame=   90 fps=0.0 q=-1.0"), Some(Line::Frames(90)));
    }
}
