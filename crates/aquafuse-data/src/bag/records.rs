//! The records of a log, one after another.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use mcap::McapError;
use mcap::records::Record;
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};

use super::BagError;
use crate::files::{FileError, catch_panic};

/// The longest record that is read: an image of 8K in 16 bits takes 200 MB.
pub(super) const LONGEST: usize = 512 << 20;

/// Reads a log from its beginning.
pub(super) struct Records<'a> {
    path: &'a Path,
    file: File,
    reader: LinearReader,
    count: u64,
}

/// What comes next in a log.
pub(super) enum Next {
    Record(Record<'static>),
    /// Nothing more.
    End,
    /// Nothing more, and why the log ends too early.
    Cut(String),
}

impl<'a> Records<'a> {
    pub(super) fn new(path: &'a Path) -> Result<Self, BagError> {
        let file = File::open(path).map_err(|error| FileError::Read { path: path.to_owned(), error })?;
        let options =
            LinearReaderOptions::default().with_validate_chunk_crcs(true).with_record_length_limit(LONGEST);
        Ok(Self { path, file, reader: LinearReader::new_with_options(options), count: 0 })
    }

    pub(super) fn next(&mut self) -> Result<Next, BagError> {
        let Self { path, file, reader, count } = self;
        let damaged = |error: &McapError| match error {
            McapError::BadMagic => BagError::Foreign { path: path.to_path_buf() },
            error => BagError::Damaged { path: path.to_path_buf(), cause: error.to_string() },
        };
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
                path: path.to_path_buf(),
                cause: "its reader panicked".into(),
            })?;
            match event {
                Ok(None) => return Ok(Next::End),
                Ok(Some(Ok(wanted))) => {
                    let read = file
                        .read(reader.insert(wanted))
                        .map_err(|error| FileError::Read { path: path.to_path_buf(), error })?;
                    reader.notify_read(read);
                }
                Ok(Some(Err(record))) => {
                    *count = count.saturating_add(1);
                    return Ok(Next::Record(record));
                }
                Err(McapError::UnexpectedEof | McapError::UnexpectedEoc) if *count > 0 => {
                    return Ok(Next::Cut("it ends in the middle of a record".into()));
                }
                Err(error) => return Err(damaged(&error)),
            }
        }
    }
}
