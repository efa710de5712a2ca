//! Where the image is in a message.

use std::ops::Range;

use super::wire::{Fields, Wire, time};

/// What the messages of a channel hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// `sensor_msgs/Image`.
    Raw(Wire),
    /// `sensor_msgs/CompressedImage`.
    Packed(Wire),
    /// `foxglove.CompressedImage`.
    Foxglove,
}

impl Kind {
    /// By the schema and the encoding of messages; nothing where they are no images that are known.
    pub(super) fn of(schema: &str, encoding: &str) -> Option<Self> {
        let wire = match encoding {
            "cdr" => Wire::Cdr,
            "ros1" => Wire::Ros1,
            "protobuf" if schema == "foxglove.CompressedImage" => return Some(Self::Foxglove),
            _ => return None,
        };
        match schema {
            "sensor_msgs/msg/Image" | "sensor_msgs/Image" => Some(Self::Raw(wire)),
            "sensor_msgs/msg/CompressedImage" | "sensor_msgs/CompressedImage" => Some(Self::Packed(wire)),
            _ => None,
        }
    }
}

/// When the image of a message was taken, in nanoseconds; nothing where the message is cut short.
pub(super) fn stamp(kind: Kind, bytes: &[u8]) -> Option<i64> {
    match kind {
        Kind::Raw(wire) | Kind::Packed(wire) => Fields::new(bytes, wire)?.header(),
        Kind::Foxglove => foxglove(bytes).map(|packed| packed.stamp),
    }
}

/// `sensor_msgs/Image`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Raw<'a> {
    pub(super) width: usize,
    pub(super) height: usize,
    /// Bytes from row to row.
    pub(super) step: usize,
    pub(super) encoding: &'a str,
    /// Whether words begin with their largest digits.
    pub(super) is_big: bool,
    pub(super) data: Range<usize>,
}

/// The image of a message; nothing where it is cut short.
pub(super) fn raw(bytes: &[u8], wire: Wire) -> Option<Raw<'_>> {
    let mut fields = Fields::new(bytes, wire)?;
    fields.header()?;
    let [height, width] = [fields.number()?, fields.number()?].map(usize::try_from);
    let encoding = fields.text()?;
    let is_big = fields.byte()? != 0;
    let step = usize::try_from(fields.number()?).ok()?;
    let data = fields.block()?;
    Some(Raw { width: width.ok()?, height: height.ok()?, step, encoding, is_big, data })
}

/// A message that holds the file of an image.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Packed<'a> {
    /// When it was taken, in nanoseconds.
    pub(super) stamp: i64,
    pub(super) format: &'a str,
    pub(super) data: Range<usize>,
    /// Where the length of the data begins.
    length_at: usize,
    length: Length,
}

/// How the length of the data is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Length {
    Number { is_big: bool },
    Varint,
}

impl Packed<'_> {
    /// The message with another file; nothing where that is too long.
    pub(super) fn with(&self, bytes: &[u8], file: &[u8]) -> Option<Vec<u8>> {
        let mut message = bytes.get(..self.length_at)?.to_vec();
        match self.length {
            Length::Varint => varint(&mut message, file.len() as u64),
            Length::Number { is_big } => {
                let length = u32::try_from(file.len()).ok()?;
                message.extend(if is_big { length.to_be_bytes() } else { length.to_le_bytes() });
            }
        }
        message.extend(file);
        message.extend(bytes.get(self.data.end..)?);
        Some(message)
    }
}

/// The file of a message of ROS; nothing where it is cut short.
pub(super) fn packed(bytes: &[u8], wire: Wire) -> Option<Packed<'_>> {
    let mut fields = Fields::new(bytes, wire)?;
    let stamp = fields.header()?;
    let format = fields.text()?;
    let is_big = fields.is_big();
    let data = fields.block()?;
    let length_at = data.start.checked_sub(4)?;
    Some(Packed { stamp, format, data, length_at, length: Length::Number { is_big } })
}

/// Fields of `foxglove.CompressedImage`.
const STAMP: u64 = 1;
const DATA: u64 = 2;
const FORMAT: u64 = 3;

/// The file of a message of Foxglove; nothing where it is cut short or has none. Of a field that is there twice the last counts, as
/// protocol buffers have it, and then nothing is changed.
pub(super) fn foxglove(bytes: &[u8]) -> Option<Packed<'_>> {
    let (mut at, mut found, mut format, mut stamp) = (0, None, "", 0);
    while at < bytes.len() {
        let tag = read_varint(bytes, &mut at)?;
        match tag & 7 {
            0 => {
                read_varint(bytes, &mut at)?;
            }
            1 => at = at.checked_add(8)?,
            5 => at = at.checked_add(4)?,
            2 => {
                let length_at = at;
                let length = usize::try_from(read_varint(bytes, &mut at)?).ok()?;
                let data = at..at.checked_add(length)?;
                let content = bytes.get(data.clone())?;
                at = data.end;
                match tag >> 3 {
                    DATA if found.is_some() => return None,
                    DATA => found = Some((length_at, data)),
                    STAMP => stamp = timestamp(content)?,
                    FORMAT => format = std::str::from_utf8(content).ok()?,
                    _ => {}
                }
            }
            _ => return None,
        }
    }
    let (length_at, data) = found.filter(|_| at == bytes.len())?;
    Some(Packed { stamp, format, data, length_at, length: Length::Varint })
}

/// `google.protobuf.Timestamp`: seconds and nanoseconds, each left out where it is 0.
fn timestamp(bytes: &[u8]) -> Option<i64> {
    let (mut at, mut parts) = (0, [0_u64; 2]);
    while at < bytes.len() {
        let tag = read_varint(bytes, &mut at)?;
        let value = (tag & 7 == 0).then(|| read_varint(bytes, &mut at)).flatten()?;
        let part = usize::try_from(tag >> 3).ok()?.checked_sub(1)?;
        *parts.get_mut(part)? = value;
    }
    let [seconds, nanoseconds] = parts.map(u64::cast_signed);
    time(seconds, nanoseconds)
}

fn read_varint(bytes: &[u8], at: &mut usize) -> Option<u64> {
    let mut value = 0_u64;
    for place in 0..10_u32 {
        let byte = *bytes.get(*at)?;
        *at = at.checked_add(1)?;
        value |= u64::from(byte & 127).checked_shl(place.checked_mul(7)?)?;
        if byte < 128 {
            return Some(value);
        }
    }
    None
}

fn varint(bytes: &mut Vec<u8>, mut value: u64) {
    while value >= 128 {
        bytes.push((value & 127) as u8 | 128);
        value >>= 7;
    }
    bytes.push((value & 127) as u8);
}
