//! A log, read record by record and written again.

use std::collections::{BTreeMap, HashMap};
use std::fs::File;
use std::io::{BufWriter, Read, Seek, Write};
use std::path::Path;

use mcap::records::Record;
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};
use mcap::write::PrivateRecordOptions;
use mcap::{Attachment, Compression, McapError, WriteOptions, Writer};

use super::message::Kind;
use super::picture::{Outcome, changed};
use super::{BagError, Summary, Topic};
use crate::files::{FileError, Staged, catch_panic};
use crate::image_file::ReadOptions;
use crate::run::RunOptions;
use crate::video::{Frames, Recipe};

/// The longest record that is read: an image of 8K in 16 bits takes 200 MB.
const LONGEST: usize = 512 << 20;

pub(super) struct Job<'a> {
    pub(super) input: &'a Path,
    pub(super) output: &'a Path,
    pub(super) topics: &'a [String],
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
        streams: HashMap::new(),
        topics: BTreeMap::new(),
        messages: 0,
    };
    let cut = each_record(job.input, &mut |record| {
        each();
        copying.take(record)
    })?;
    let summary = copying.end(cut)?;
    staged.persist()?;
    Ok(summary)
}

/// Calls `take` with each record; says why, if the log ends too early.
fn each_record(
    path: &Path,
    take: &mut dyn FnMut(Record<'_>) -> Result<(), BagError>,
) -> Result<Option<String>, BagError> {
    let unread = |error| FileError::Read { path: path.to_owned(), error };
    let mut file = File::open(path).map_err(unread)?;
    let options =
        LinearReaderOptions::default().with_validate_chunk_crcs(true).with_record_length_limit(LONGEST);
    let mut reader = LinearReader::new_with_options(options);
    let damaged = |error: &McapError| match error {
        McapError::BadMagic => BagError::Foreign { path: path.to_owned() },
        error => BagError::Damaged { path: path.to_owned(), cause: error.to_string() },
    };
    let mut records = 0_u64;
    loop {
        // The library trusts some lengths; whatever it does with a bad file, it is the file that is named.
        let event = catch_panic(|| {
            let request = match reader.next_event() {
                None => return Ok(None),
                Some(Ok(LinearReadEvent::ReadRequest(wanted))) => wanted,
                Some(Ok(LinearReadEvent::Record { data, opcode })) => {
                    return mcap::parse_record(opcode, data).map(|record| Some(Err(record.into_owned())));
                }
                Some(Err(error)) => return Err(error),
            };
            Ok(Some(Ok(request)))
        });
        let event = event.ok_or_else(|| BagError::Damaged {
            path: path.to_owned(),
            cause: "its reader panicked".into(),
        })?;
        match event {
            Ok(None) => return Ok(None),
            Ok(Some(Ok(wanted))) => {
                let read = file.read(reader.insert(wanted)).map_err(unread)?;
                reader.notify_read(read);
            }
            Ok(Some(Err(record))) => {
                records = records.saturating_add(1);
                take(record)?;
            }
            Err(McapError::UnexpectedEof | McapError::UnexpectedEoc) if records > 0 => {
                return Ok(Some("it ends in the middle of a record".into()));
            }
            Err(error) => return Err(damaged(&error)),
        }
    }
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
    streams: HashMap<u16, Frames<u8>>,
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
        let frames = match self.streams.entry(channel) {
            std::collections::hash_map::Entry::Occupied(frames) => frames.into_mut(),
            std::collections::hash_map::Entry::Vacant(place) => place.insert(self.job.recipe.frames()?),
        };
        let reading: &ReadOptions = &self.job.options.reading;
        let outcome = changed(*kind, data, frames, Path::new(name), reading);
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
