//! The image of a message, changed.

use std::path::Path;

use aquafuse::depth::Supplied;
use aquafuse::image::Image;
use aquafuse::scene_area::Border;

use super::message::{self, Kind, Raw};
use crate::image_file::{ImageFile, Pixels, ReadOptions};
use crate::pipeline::{PixelEncoding, analyse_supplied};
use crate::video::{AtDepth, Frames, VideoError};

/// What became of a message.
pub(super) enum Outcome {
    /// It is this one now.
    Changed(Vec<u8>),
    /// It stays, for this reason.
    Kept(String),
    /// It stays, for it is damaged.
    Damaged(String),
}

/// The images of a topic, one after another.
pub(super) enum Sequence {
    /// Depth is estimated of each, from its colours or by a network.
    ByColour(Box<Frames<u8>>),
    /// Depth comes with each.
    AtDepth(Box<AtDepth>),
}

impl Sequence {
    /// Changes the next image; in words, why it stays.
    fn change(
        &mut self,
        image: &mut Image<u8>,
        depth: Option<Supplied>,
        options: &ReadOptions,
    ) -> Result<(), String> {
        if let Self::ByColour(frames) = self {
            let memory = frames.network_memory(image.pixels().len() as u64);
            if memory > options.max_memory {
                let [needed, limit] = [memory, options.max_memory].map(|bytes| bytes.div_ceil(1 << 20));
                return Err(format!(
                    "the network needs {needed} MiB of memory, more than {limit} MiB (--max-memory)"
                ));
            }
        }
        match (self, depth) {
            (Self::ByColour(frames), _) => {
                frames.change(image.view_mut()).map(|_| ()).map_err(|error| error.to_string())
            }
            (Self::AtDepth(at_depth), Some(map)) => {
                let analyse = |scene: &ImageFile| {
                    analyse_supplied(PixelEncoding::Encoded, scene, map)
                        .map_err(|error| VideoError::Request(format!("its depth: {error}")))
                };
                let done = at_depth.change(image.view_mut(), analyse);
                done.map(|_| ()).map_err(|error| error.to_string())
            }
            (Self::AtDepth(_), None) => Err("it has no depth".into()),
        }
    }
}

/// Quality of JPEG files.
const QUALITY: u8 = 95;

/// Changes the next message of a topic.
pub(super) fn changed(
    kind: Kind,
    bytes: &[u8],
    sequence: &mut Sequence,
    depth: Option<Supplied>,
    topic: &Path,
    options: &ReadOptions,
) -> Outcome {
    let cut = || Outcome::Damaged("the message is cut short, or has other fields than its schema".into());
    match kind {
        Kind::Raw(wire) => match message::raw(bytes, wire) {
            Some(raw) => raw_changed(bytes, &raw, (sequence, depth), options),
            None => cut(),
        },
        Kind::Packed(_) | Kind::Foxglove => {
            let packed = match kind {
                Kind::Packed(wire) => message::packed(bytes, wire),
                _ => message::foxglove(bytes),
            };
            let Some(packed) = packed else { return cut() };
            if packed.format.contains("compressedDepth") {
                return Outcome::Kept("it is depth".into());
            }
            let file = bytes.get(packed.data.clone()).unwrap_or_default();
            match file_changed(file, packed.format, (sequence, depth), topic, options) {
                Ok(file) => match packed.with(bytes, &file) {
                    Some(message) => Outcome::Changed(message),
                    None => Outcome::Kept("its file would be too long".into()),
                },
                Err(outcome) => outcome,
            }
        }
    }
}

/// Places of red, green and blue in a pixel, and its bytes.
fn colours(encoding: &str) -> Option<([usize; 3], usize)> {
    Some(match encoding {
        "rgb8" => ([0, 1, 2], 3),
        // OpenCV's order, in which images without a named order are as a rule.
        "bgr8" | "8UC3" => ([2, 1, 0], 3),
        "rgba8" => ([0, 1, 2], 4),
        "bgra8" | "8UC4" => ([2, 1, 0], 4),
        _ => return None,
    })
}

fn raw_changed(
    bytes: &[u8],
    raw: &Raw<'_>,
    (sequence, depth): (&mut Sequence, Option<Supplied>),
    options: &ReadOptions,
) -> Outcome {
    let Some((places, channels)) = colours(raw.encoding) else {
        return Outcome::Kept(format!("its encoding {} is not 8 bits of red, green and blue", raw.encoding));
    };
    let Raw { width, height, step, .. } = *raw;
    let least = width.checked_mul(channels).filter(|row| *row > 0 && *row <= step);
    let whole = step.checked_mul(height).filter(|whole| *whole > 0 && *whole <= raw.data.len());
    if least.is_none() || whole.is_none() {
        return Outcome::Damaged(format!(
            "{} bytes of data cannot be {width}x{height} pixels of {} with {step} bytes a row",
            raw.data.len(),
            raw.encoding
        ));
    }
    let mut message = bytes.to_vec();
    let data = message.get_mut(raw.data.clone()).unwrap_or_default();
    let rows = || data.chunks(step).take(height);
    let pixel = |pixel: &[u8]| places.map(|place| pixel.get(place).copied().unwrap_or_default());
    let samples: Vec<u8> =
        rows().flat_map(|line| line.chunks_exact(channels).take(width).flat_map(pixel)).collect();
    let mut image = match Image::from_raw(width, height, samples) {
        Ok(image) => image,
        Err(error) => return Outcome::Damaged(error.to_string()),
    };
    if let Err(why) = sequence.change(&mut image, depth, options) {
        return Outcome::Kept(why);
    }
    let mut changed = image.pixels().iter();
    for line in data.chunks_mut(step).take(height) {
        for (pixel, colour) in line.chunks_exact_mut(channels).take(width).zip(&mut changed) {
            for (place, value) in places.into_iter().zip(colour) {
                pixel.iter_mut().skip(place).take(1).for_each(|there| *there = *value);
            }
        }
    }
    Outcome::Changed(message)
}

/// The format of a file by its first bytes, as an extension.
fn extension(file: &[u8]) -> Option<&'static str> {
    match file {
        [0xff, 0xd8, ..] => Some("jpg"),
        [0x89, b'P', b'N', b'G', ..] => Some("png"),
        [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => Some("webp"),
        _ => None,
    }
}

fn file_changed(
    file: &[u8],
    format: &str,
    (sequence, depth): (&mut Sequence, Option<Supplied>),
    topic: &Path,
    options: &ReadOptions,
) -> Result<Vec<u8>, Outcome> {
    let Some(extension) = extension(file) else {
        return Err(Outcome::Kept(format!("its format {format} is not JPEG, PNG or WebP")));
    };
    let damaged = |error: crate::files::FileError| Outcome::Damaged(error.to_string());
    // The sequence looks for the border, as it does in images that are no files.
    let whole = ReadOptions { border: Border::None, ..*options };
    let mut image = ImageFile::from_bytes(topic, file, &whole).map_err(damaged)?;
    let mut colours: Image<u8> = match &image.pixels {
        Pixels::Bytes(layers) => layers.image.clone(),
        _ => return Err(Outcome::Kept("it has more than 8 bits".into())),
    };
    if colours.pixels().iter().all(|[red, green, blue]| red == green && green == blue) {
        return Err(Outcome::Kept("it is grey".into()));
    }
    sequence.change(&mut colours, depth, options).map_err(Outcome::Kept)?;
    if let Pixels::Bytes(layers) = &mut image.pixels {
        layers.image = colours;
    }
    image.encode(&Path::new("image").with_extension(extension), QUALITY).map_err(damaged)
}

/// Any bytes as a message, whose kind the first of them says: it stays, or is changed to one of the same shape.
#[cfg(feature = "fuzz-targets")]
pub(super) fn try_message(bytes: &[u8], options: &ReadOptions) {
    use super::wire::Wire::{Cdr, Ros1};
    let Some((first, bytes)) = bytes.split_first() else { return };
    let kind = match first % 5 {
        0 => Kind::Raw(Cdr),
        1 => Kind::Raw(Ros1),
        2 => Kind::Packed(Cdr),
        3 => Kind::Packed(Ros1),
        _ => Kind::Foxglove,
    };
    let stamp = message::stamp(kind, bytes);
    let _ = super::depth::decoded(kind, bytes);
    let recipe =
        crate::video::Recipe::new(crate::pipeline::Operation::Enhance { levels: Default::default() });
    let frames = recipe.frames().expect("levels are set frame by frame");
    let mut sequence = Sequence::ByColour(Box::new(frames));
    let Outcome::Changed(message) =
        changed(kind, bytes, &mut sequence, None, Path::new(crate::targets::NAME), options)
    else {
        return;
    };
    assert_eq!(message::stamp(kind, &message), stamp, "the header stays");
    match kind {
        Kind::Raw(wire) => assert_eq!(message::raw(&message, wire), message::raw(bytes, wire)),
        Kind::Packed(wire) => assert!(message::packed(&message, wire).is_some()),
        Kind::Foxglove => assert!(message::foxglove(&message).is_some()),
    }
}
