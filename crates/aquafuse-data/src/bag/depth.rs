//! The depth of images, from another topic of the same log.

use std::collections::{HashMap, VecDeque};
use std::path::Path;

use aquafuse::depth::{Supplied, SuppliedKind};
use mcap::records::Record;

use super::message::{self, Kind, Raw};
use super::records::{Next, Records};
use super::{BagError, DepthTopic};
use crate::depth_file;

/// Depth maps older than the one that is wanted, which are kept: cameras take turns, and none is far behind another.
const KEPT: usize = 8;
/// Bytes of the head of `compressedDepth`: its kind, and two numbers for kinds that are not whole millimetres.
const HEAD: usize = 12;

/// A second reader of the log, ahead of the first: depth is often logged after the image it belongs to.
pub(super) struct Ahead<'a> {
    path: &'a Path,
    records: Records<'a>,
    topic: &'a DepthTopic,
    schemas: HashMap<u16, String>,
    channels: HashMap<u16, Kind>,
    /// Messages with their times, in the order of the log.
    near: VecDeque<(i64, Kind, Vec<u8>)>,
    has_ended: bool,
}

impl<'a> Ahead<'a> {
    pub(super) fn new(path: &'a Path, topic: &'a DepthTopic) -> Result<Self, BagError> {
        Ok(Self {
            path,
            records: Records::new(path)?,
            topic,
            schemas: HashMap::new(),
            channels: HashMap::new(),
            near: VecDeque::new(),
            has_ended: false,
        })
    }

    /// The depth map whose time is nearest to the image's; in words, why there is none.
    pub(super) fn of(&mut self, stamp: i64) -> Result<Result<Supplied, String>, BagError> {
        while !self.has_ended && self.near.back().is_none_or(|(time, ..)| *time < stamp) {
            self.step()?;
        }
        if self.channels.is_empty() && self.has_ended {
            return Err(BagError::NoDepth { path: self.path.to_owned(), topic: self.topic.name.clone() });
        }
        while self.near.iter().filter(|(time, ..)| *time < stamp).count() > KEPT {
            self.near.pop_front();
        }
        let nearest = self.near.iter().min_by_key(|(time, ..)| time.abs_diff(stamp));
        let within = u64::try_from(self.topic.within.as_nanos()).unwrap_or(u64::MAX);
        let Some((_, kind, bytes)) = nearest.filter(|(time, ..)| time.abs_diff(stamp) <= within) else {
            let DepthTopic { name, within } = self.topic;
            return Ok(Err(format!("{name} has no depth within {} ms", within.as_millis())));
        };
        Ok(decoded(*kind, bytes).map_err(|cause| format!("its depth on {}: {cause}", self.topic.name)))
    }

    fn step(&mut self) -> Result<(), BagError> {
        match self.records.next()? {
            Next::End | Next::Cut(_) => self.has_ended = true,
            Next::Record(Record::Schema { header, .. }) => {
                self.schemas.insert(header.id, header.name);
            }
            Next::Record(Record::Channel(channel)) if channel.topic == self.topic.name => {
                let schema = self.schemas.get(&channel.schema_id).map_or("", String::as_str);
                if let Some(kind) = Kind::of(schema, &channel.message_encoding) {
                    self.channels.insert(channel.id, kind);
                }
            }
            Next::Record(Record::Message { header, data }) => {
                if let Some(kind) = self.channels.get(&header.channel_id)
                    && let Some(time) = message::stamp(*kind, &data)
                {
                    self.near.push_back((time, *kind, data.into_owned()));
                }
            }
            Next::Record(_) => {}
        }
        Ok(())
    }
}

/// The depth map of a message, or what is wrong with it.
pub(super) fn decoded(kind: Kind, bytes: &[u8]) -> Result<Supplied, String> {
    let cut = || "the message is cut short".to_owned();
    let packed = match kind {
        Kind::Raw(wire) => return raw(bytes, &message::raw(bytes, wire).ok_or_else(cut)?),
        Kind::Packed(wire) => message::packed(bytes, wire),
        Kind::Foxglove => message::foxglove(bytes),
    };
    let packed = packed.ok_or_else(cut)?;
    let file = bytes.get(packed.data.clone()).unwrap_or_default();
    let is_depth = packed.format.contains("compressedDepth");
    if packed.format.starts_with("32FC1") && is_depth {
        return Err(
            "32FC1 as compressedDepth is not read; log it as sensor_msgs/Image, or in millimetres".into()
        );
    }
    let file = if is_depth { file.get(HEAD..).ok_or_else(cut)? } else { file };
    depth_file::from_bytes(Path::new("its map"), file, SuppliedKind::Millimetres)
        .map_err(|error| error.to_string())
}

fn raw(bytes: &[u8], raw: &Raw<'_>) -> Result<Supplied, String> {
    let Raw { width, height, step, is_big, .. } = *raw;
    let (kind, size) = match raw.encoding {
        "16UC1" | "mono16" => (SuppliedKind::Millimetres, 2),
        "32FC1" => (SuppliedKind::Metres, 4),
        other => return Err(format!("{other} is no depth; 16UC1 is, in millimetres, and 32FC1, in metres")),
    };
    let row = width.checked_mul(size).filter(|row| *row > 0 && *row <= step);
    let whole = step.checked_mul(height).filter(|whole| *whole > 0 && *whole <= raw.data.len());
    let (Some(row), Some(_)) = (row, whole) else {
        return Err(format!(
            "{} bytes cannot be {width}x{height} values of {}",
            raw.data.len(),
            raw.encoding
        ));
    };
    let data = bytes.get(raw.data.clone()).unwrap_or_default();
    let rows = data.chunks(step).take(height).map(|line| line.get(..row).unwrap_or_default());
    let values: Vec<f32> = match size {
        2 => rows
            .flat_map(|line| line.as_chunks::<2>().0)
            .map(|&word| f32::from(if is_big { u16::from_be_bytes(word) } else { u16::from_le_bytes(word) }))
            .collect(),
        _ => rows
            .flat_map(|line| line.as_chunks::<4>().0)
            .map(|&word| if is_big { f32::from_be_bytes(word) } else { f32::from_le_bytes(word) })
            .collect(),
    };
    Supplied::new(width, height, values, kind).map_err(|error| error.to_string())
}
