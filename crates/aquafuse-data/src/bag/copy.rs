//! A log, read record by record and written again.

use std::collections::{BTreeMap, HashMap};
use std::fs::File;
use std::io::{BufWriter, Read, Seek, Write};
use std::path::Path;

use mcap::records::Record;
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};
use mcap::write::PrivateRecordOptions;
use mcap::{Attachment, Compression, McapError, WriteOptions, Writer};

use super::depth::Ahead;
use super::message::{self, Kind};
use super::picture::{Outcome, Sequence, changed};
use super::records::{LONGEST, Next, Records};
use super::{BagError, DepthTopic, Summary, Topic};
use crate::files::{FileError, Staged};
use crate::image_file::ReadOptions;
use crate::run::RunOptions;
use crate::video::{AtDepth, Recipe};

pub(super) struct Job<'a> {
    pub(super) input: &'a Path,
    pub(super) output: &'a Path,
    pub(super) topics: &'a [String],
    pub(super) depth: Option<&'a DepthTopic>,
    pub(super) overwrite: bool,
    pub(super) recipe: &'a Recipe,
    pub(super) options: &'a RunOptions,
}

pub(super) fn run(job: &Job<'_>, each: &mut dyn FnMut()) -> Result<Summary, BagError> {
    // Made before anything is read: that it may not be replaced is then known at once.
    let staged = Staged::empty(job.output, job.overwrite)?;
    let failed = |cause: String| FileError::Write { path: job.output.to_owned(), cause };
    let part = File::options().write(true).open(staged.part()).map_err(|error| failed(error.to_string()))?;
    let (profile, compression) = head(job.input)?;
    let options = WriteOptions::new()
        .profile(profile)
        .library(concat!("aquafuse ", env!("CARGO_PKG_VERSION")))
        .compression(compression);
    let writer = options.create(BufWriter::new(part)).map_err(|error| failed(error.to_string()))?;
    let mut copying = Copying {
        job,
        writer,
        schemas: HashMap::new(),
        images: HashMap::new(),
        sequences: HashMap::new(),
        depth: job.depth.map(|topic| Ahead::new(job.input, topic)).transpose()?,
        topics: BTreeMap::new(),
        messages: 0,
    };
    let mut records = Records::new(job.input)?;
    let cut = loop {
        match records.next()? {
            Next::Record(record) => {
                each();
                copying.take(record)?;
            }
            Next::End => break None,
            Next::Cut(why) => break Some(why),
        }
    };
    let summary = copying.end(cut)?;
    staged.persist()?;
    Ok(summary)
}

/// The profile of a log, and the compression of its first chunk.
fn head(path: &Path) -> Result<(String, Option<Compression>), BagError> {
    let mut file = File::open(path).map_err(|error| FileError::Read { path: path.to_owned(), error })?;
    let mut reader = LinearReader::new_with_options(
        LinearReaderOptions::default().with_emit_chunks(true).with_record_length_limit(LONGEST),
    );
    let mut profile = String::new();
    while let Some(event) = reader.next_event() {
        match event {
            Ok(LinearReadEvent::ReadRequest(wanted)) => {
                let read = file.read(reader.insert(wanted));
                reader.notify_read(read.map_err(|error| FileError::Read { path: path.to_owned(), error })?);
            }
            Ok(LinearReadEvent::Record { data, opcode }) => match mcap::parse_record(opcode, data) {
                Ok(Record::Header(header)) => profile = header.profile,
                Ok(Record::Chunk { header, .. }) => {
                    let compression = match header.compression.as_str() {
                        "lz4" => Some(Compression::Lz4),
                        "" => None,
                        _ => Some(Compression::Zstd),
                    };
                    return Ok((profile, compression));
                }
                Ok(Record::Message { .. } | Record::DataEnd(_)) => return Ok((profile, None)),
                _ => {}
            },
            // The second reading says what is wrong.
            Err(_) => return Ok((profile, None)),
        }
    }
    Ok((profile, None))
}

struct Copying<'a, W: Write + Seek> {
    job: &'a Job<'a>,
    writer: Writer<W>,
    /// Names by number.
    schemas: HashMap<u16, String>,
    /// Channels with images: what these are, and the topic.
    images: HashMap<u16, (Kind, String)>,
    sequences: HashMap<u16, Sequence>,
    /// Where depth comes from, if not from colour.
    depth: Option<Ahead<'a>>,
    topics: BTreeMap<String, Topic>,
    messages: u64,
}

impl<W: Write + Seek> Copying<'_, W> {
    fn take(&mut self, record: Record<'_>) -> Result<(), BagError> {
        self.job.options.stop.check(self.job.output)?;
        match record {
            Record::Schema { header, data } => {
                let written =
                    self.writer.add_schema_with_id(header.id, &header.name, &header.encoding, &data);
                self.written(written)?;
                self.schemas.insert(header.id, header.name);
            }
            Record::Channel(channel) => {
                let written = self.writer.add_channel_with_id(
                    channel.id,
                    channel.schema_id,
                    &channel.topic,
                    &channel.message_encoding,
                    &channel.metadata,
                );
                self.written(written)?;
                let schema = self.schemas.get(&channel.schema_id).map_or("", String::as_str);
                if let Some(kind) = Kind::of(schema, &channel.message_encoding) {
                    let topic = Topic { name: channel.topic.clone(), ..Topic::default() };
                    self.topics.entry(channel.topic.clone()).or_insert(topic);
                    self.images.insert(channel.id, (kind, channel.topic));
                }
            }
            Record::Message { header, data } => {
                self.messages = self.messages.saturating_add(1);
                let changed = self.changed(header.channel_id, &data)?;
                let data = changed.as_deref().unwrap_or(&data);
                let written = self.writer.write_to_known_channel(&header, data);
                self.written(written)?;
            }
            Record::Attachment { header, data, .. } => {
                let written = self.writer.attach(&Attachment {
                    log_time: header.log_time,
                    create_time: header.create_time,
                    name: header.name,
                    media_type: header.media_type,
                    data,
                });
                self.written(written)?;
            }
            Record::Metadata(metadata) => {
                let written = self.writer.write_metadata(&metadata);
                self.written(written)?;
            }
            Record::Unknown { opcode, data } if opcode >= 0x80 => {
                let options = PrivateRecordOptions::IncludeInChunks.into();
                let written = self.writer.write_private_record(opcode, &data, options);
                self.written(written)?;
            }
            // Indices and sums, which are written again.
            _ => {}
        }
        Ok(())
    }

    /// The message of a channel, if it is changed.
    fn changed(&mut self, channel: u16, data: &[u8]) -> Result<Option<Vec<u8>>, BagError> {
        let Some((kind, name)) = self.images.get(&channel) else { return Ok(None) };
        if !self.job.topics.is_empty() && !self.job.topics.contains(name) {
            return Ok(None);
        }
        if self.job.depth.is_some_and(|depth| depth.name == *name) {
            return Ok(None);
        }
        let recipe = self.job.recipe;
        let depth = match &mut self.depth {
            // A message without a time is cut short, which is found out again where it is changed.
            Some(ahead) => message::stamp(*kind, data).map(|stamp| ahead.of(stamp)).transpose()?,
            None => None,
        };
        let sequence = match self.sequences.entry(channel) {
            std::collections::hash_map::Entry::Occupied(sequence) => sequence.into_mut(),
            std::collections::hash_map::Entry::Vacant(place) => place.insert(match self.job.depth {
                Some(_) => Sequence::AtDepth(Box::new(AtDepth::new(recipe))),
                None => Sequence::ByColour(Box::new(recipe.frames()?)),
            }),
        };
        let reading: &ReadOptions = &self.job.options.reading;
        let outcome = match depth {
            Some(Err(why)) => Outcome::Kept(why),
            depth => changed(*kind, data, sequence, depth.and_then(Result::ok), Path::new(name), reading),
        };
        let Some(topic) = self.topics.get_mut(name) else { return Ok(None) };
        Ok(match outcome {
            Outcome::Changed(message) => {
                topic.changed = topic.changed.saturating_add(1);
                Some(message)
            }
            Outcome::Kept(reason) => {
                topic.kept = topic.kept.saturating_add(1);
                topic.kept_for.get_or_insert(reason);
                None
            }
            Outcome::Damaged(fault) => {
                topic.damaged = topic.damaged.saturating_add(1);
                topic.fault.get_or_insert(fault);
                None
            }
        })
    }

    /// An error of the writer: of the log, if what it is given makes no sense, else of the output.
    fn written<R>(&self, written: Result<R, McapError>) -> Result<R, BagError> {
        written.map_err(|error| match error {
            McapError::Io(error) => {
                FileError::Write { path: self.job.output.to_owned(), cause: error.to_string() }.into()
            }
            error => BagError::Damaged { path: self.job.input.to_owned(), cause: error.to_string() },
        })
    }

    /// Writes the end, and says what was done.
    fn end(mut self, cut: Option<String>) -> Result<Summary, BagError> {
        let path = self.job.input.to_owned();
        if self.topics.is_empty() {
            return Err(BagError::NoImages { path });
        }
        if let Some(topic) = self.job.topics.iter().find(|topic| !self.topics.contains_key(*topic)) {
            let there = self.topics.keys().cloned().collect::<Vec<_>>().join(", ");
            return Err(BagError::NoTopic { path, topic: topic.clone(), there });
        }
        let ended = self.writer.finish();
        self.written(ended)?;
        let asked = |topic: &Topic| self.job.topics.is_empty() || self.job.topics.contains(&topic.name);
        let topics = self.topics.values().filter(|topic| asked(topic)).cloned().collect();
        Ok(Summary { topics, messages: self.messages, cut })
    }
}
