//! Files that videos are written to, and the codecs that go into them.

use std::path::Path;

use super::probe::{bits, is_rgb};
use super::{StreamInfo, StreamKind, VideoError, VideoInfo};
use crate::files::FileError;

/// How frames are compressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Codec {
    /// H.264, which every player shows.
    H264,
    /// H.265, also called HEVC: smaller and slower.
    H265,
    /// VP9, for .webm.
    Vp9,
    /// FFV1, in red, green and blue: every pixel as it was computed.
    Ffv1,
}

impl Codec {
    /// All of them.
    pub const ALL: &'static [Self] = &[Self::H264, Self::H265, Self::Vp9, Self::Ffv1];

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::H264 => "h264",
            Self::H265 => "h265",
            Self::Vp9 => "vp9",
            Self::Ffv1 => "ffv1",
        }
    }

    /// The constant rate factor that is taken if none is given: hardly any loss is visible. `None` if nothing is lost.
    #[must_use]
    pub fn default_crf(self) -> Option<u8> {
        match self {
            Self::H264 => Some(18),
            Self::H265 => Some(20),
            Self::Vp9 => Some(24),
            Self::Ffv1 => None,
        }
    }

    /// The arguments that choose the encoder.
    pub(super) fn arguments(self, crf: Option<u8>, container: Container) -> Vec<String> {
        let encoder: &[&str] = match self {
            Self::H264 => &["libx264"],
            // Apple's players know it by this name alone.
            Self::H265 if container.holds_mp4_tags() => &["libx265", "-tag:v", "hvc1"],
            Self::H265 => &["libx265"],
            Self::Vp9 => &["libvpx-vp9", "-b:v", "0", "-deadline", "good", "-cpu-used", "4", "-row-mt", "1"],
            Self::Ffv1 => &["ffv1", "-level", "3", "-slices", "16", "-g", "1"],
        };
        let crf = self.default_crf().map(|default| crf.unwrap_or(default));
        let crf = crf.into_iter().flat_map(|crf| ["-crf".to_owned(), crf.to_string()]);
        ["-c:v"].iter().chain(encoder).map(|word| (*word).to_owned()).chain(crf).collect()
    }

    /// The pixel format that frames are written in: the source's where the codec has it.
    pub(super) fn pixel_format(self, info: &VideoInfo) -> String {
        let is_deep = info.is_deep();
        if self == Self::Ffv1 {
            return if is_deep { "gbrp16le" } else { "bgr0" }.to_owned();
        }
        planar(info, is_deep)
    }
}

/// The format of planes with the colour resolution and the bits, at most 10, of the source.
pub(super) fn planar(info: &VideoInfo, is_deep: bool) -> String {
    let format = info.pixel_format.as_str();
    let is_odd = |length: usize| length % 2 == 1;
    let half = ["422", "yuyv", "uyvy", "yvyu", "p210"].iter().any(|name| format.contains(name));
    // Colour at half the resolution needs an even number of columns and rows.
    let chroma = if format.contains("444") || is_rgb(format) || is_odd(info.width) {
        "444"
    } else if half || is_odd(info.height) {
        "422"
    } else {
        "420"
    };
    format!("yuv{chroma}p{}", if is_deep { "10le" } else { "" })
}

/// A kind of file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Container {
    Mp4,
    Mov,
    Matroska,
    Webm,
}

impl Container {
    /// The extensions, in words.
    pub(super) const EXTENSIONS: &'static str = ".mp4, .m4v, .mov, .mkv or .webm";

    /// The kind of a file, by its name.
    pub(super) fn of(path: &Path) -> Result<Self, FileError> {
        let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
        match extension.to_ascii_lowercase().as_str() {
            "mp4" | "m4v" => Ok(Self::Mp4),
            "mov" => Ok(Self::Mov),
            "mkv" => Ok(Self::Matroska),
            "webm" => Ok(Self::Webm),
            _ => Err(FileError::UnknownExtension { path: path.to_owned(), expected: Self::EXTENSIONS }),
        }
    }

    /// The name that ffmpeg has for it.
    pub(super) fn muxer(self) -> &'static str {
        match self {
            Self::Mp4 => "mp4",
            Self::Mov => "mov",
            Self::Matroska => "matroska",
            Self::Webm => "webm",
        }
    }

    pub(super) fn holds_mp4_tags(self) -> bool {
        matches!(self, Self::Mp4 | Self::Mov)
    }

    /// The codec for frames in such a file.
    pub(super) fn codec(self, wanted: Option<Codec>, path: &Path) -> Result<Codec, VideoError> {
        let default = if self == Self::Webm { Codec::Vp9 } else { Codec::H264 };
        let codec = wanted.unwrap_or(default);
        let goes = match self {
            Self::Matroska => true,
            Self::Webm => codec == Codec::Vp9,
            Self::Mp4 => codec != Codec::Ffv1,
            Self::Mov => matches!(codec, Codec::H264 | Codec::H265),
        };
        let remedy = if codec == Codec::Vp9 { ".webm or .mkv" } else { ".mkv" };
        match goes {
            true => Ok(codec),
            false => Err(VideoError::Codec { path: path.to_owned(), codec: codec.name(), remedy }),
        }
    }

    /// How a stream beside the frames goes into such a file: copied, or converted to this codec. `None` if it does not.
    pub(super) fn takes(self, stream: &StreamInfo) -> Option<&'static str> {
        const PICTURES: [&str; 4] = ["hdmv_pgs_subtitle", "dvd_subtitle", "dvb_subtitle", "xsub"];
        match stream.kind {
            StreamKind::Audio => Some("copy"),
            StreamKind::Subtitles => {
                let is_text = !PICTURES.contains(&stream.codec.as_str());
                match self {
                    Self::Mp4 | Self::Mov if stream.codec == "mov_text" => Some("copy"),
                    Self::Mp4 | Self::Mov => is_text.then_some("mov_text"),
                    Self::Matroska if stream.codec == "mov_text" => Some("srt"),
                    Self::Matroska => Some("copy"),
                    Self::Webm => is_text.then_some("webvtt"),
                }
            }
            StreamKind::Attachment if self == Self::Matroska => Some("copy"),
            _ => None,
        }
    }
}

/// What an output in this codec loses, in words.
pub(super) fn losses(info: &VideoInfo, codec: Codec) -> Option<String> {
    let bits = bits(&info.pixel_format);
    (bits > 10 && codec != Codec::Ffv1).then(|| format!("{bits} bits become 10"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codecs_go_into_the_files_that_hold_them() {
        let codec = |name: &str, wanted| {
            let path = Path::new(name);
            Container::of(path).map_err(VideoError::from).and_then(|container| container.codec(wanted, path))
        };
        assert_eq!(codec("a.MP4", None).unwrap(), Codec::H264);
        assert_eq!(codec("a.webm", None).unwrap(), Codec::Vp9);
        assert_eq!(codec("a.mkv", Some(Codec::Ffv1)).unwrap(), Codec::Ffv1);
        assert!(codec("a.mp4", Some(Codec::Ffv1)).unwrap_err().to_string().ends_with("Write to .mkv"));
        assert!(codec("a.avi", None).is_err() && codec("mp4", None).is_err());
    }
}
