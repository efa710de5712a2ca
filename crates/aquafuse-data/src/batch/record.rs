//! The record of a folder's job: what is begun and what is done, so that a job that was stopped goes on.
//!
//! One JSON object a line. The first says what the folder is made with; then each image has a line when its
//! output is about to get its name, and one when it has it, or failed. An image with the first line but not the
//! second may be there or not: it is made again. A line without its end was being written when the process was
//! killed, and is cut off. What failed is listed for people; it decides nothing.

use std::collections::HashMap;
use std::ffi::{OsStr, OsString};
use std::fs::{File, OpenOptions};
use std::hash::{BuildHasher as _, Hash, RandomState};
use std::io::{self, BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::UNIX_EPOCH;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::Item;
use crate::files::FileError;
use crate::files::lock;
use crate::pipeline::DepthSource;
use crate::run::differences;

/// The name of the record in the folder of a job's outputs.
pub const RECORD: &str = "aquafuse-job.jsonl";
/// More than any settings or names take; a line's values take up to fifty times its length while it is read.
const MOST_LINE: usize = 1 << 20;

/// A record, open and locked against other processes until dropped.
#[derive(Debug)]
pub struct Record {
    path: PathBuf,
    /// The folder of the outputs.
    folder: PathBuf,
    file: Mutex<File>,
    items: Items,
}

/// What is known of the outputs, as digests: a record may have a million lines.
#[derive(Debug, Default)]
struct Items {
    keys: [RandomState; 2],
    known: HashMap<u128, Digests>,
}

/// What is compared of an output.
#[derive(Clone, Copy, Debug)]
struct Digests {
    /// Whether it has its name; one that was begun may have it or not.
    is_done: bool,
    /// Of the path of its content, and how its depth is obtained.
    of: u64,
    /// Of all that is known of its source.
    source: u64,
    /// Of what was written, or, of one that was begun, of what stood there before and was not ours.
    stamp: u64,
}

impl Items {
    /// A digest that nobody can foresee: its keys are drawn for each run.
    fn digest(&self, value: &impl Hash) -> u64 {
        let [key, _] = &self.keys;
        key.hash_one(value)
    }

    fn place(&self, output: &OsStr) -> u128 {
        let [high, low] = self.keys.each_ref().map(|key| u128::from(key.hash_one(output)));
        (high << 64) | low
    }

    fn insert(&mut self, output: &OsStr, is_done: bool, source: &Source, stamp: Option<&Stamp>) {
        let digests = Digests {
            is_done,
            of: self.digest(&source.identity()),
            source: self.digest(source),
            stamp: self.digest(&stamp),
        };
        self.known.insert(self.place(output), digests);
    }

    fn get(&self, output: &OsStr) -> Option<&Digests> {
        self.known.get(&self.place(output))
    }
}

/// What stands at the output of an item.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// A run before this one has made it.
    Made,
    /// There is no such file.
    Missing,
    /// There is a file that is ours, or that may be replaced.
    Replaceable,
    /// There is a file that is not ours, or was changed since.
    Foreign,
}

/// What an output is made from.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
struct Source {
    /// The content, by its absolute path as it was named: to follow links would double the time of a resume.
    path: Name,
    content: Stamp,
    /// How its depth is obtained.
    depth: String,
    /// The file of its depth.
    map: Option<Stamp>,
}

/// Size and time of a file.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
struct Stamp {
    bytes: u64,
    modified_ns: u64,
}

impl Stamp {
    fn of(path: &Path) -> io::Result<Self> {
        let about = path.metadata()?;
        let modified = about.modified().ok().and_then(|time| time.duration_since(UNIX_EPOCH).ok());
        let modified_ns = modified.and_then(|since| u64::try_from(since.as_nanos()).ok()).unwrap_or(0);
        Ok(Self { bytes: about.len(), modified_ns })
    }
}

impl Source {
    fn of(item: &Item) -> io::Result<Self> {
        let map = match &item.depth {
            DepthSource::Supplied { path, .. } => Some(Stamp::of(path)?),
            DepthSource::Estimated(_) => None,
        };
        Ok(Self {
            path: Name::of(std::path::absolute(&item.input)?.as_os_str()),
            content: Stamp::of(&item.input)?,
            depth: format!("{:?}", item.depth),
            map,
        })
    }

    /// Which image it is and how its depth is obtained, be the files changed or not.
    fn identity(&self) -> (&Name, &str) {
        (&self.path, &self.depth)
    }
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Line {
    Job { schema: u32, settings: Value },
    Begun { output: Name, source: Source, before: Option<Stamp> },
    Done { output: Name, source: Source, stamp: Stamp },
    Failed { output: Name, error: String },
}

const SCHEMA: u32 = 1;

/// A file name: as text where it is text.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(untagged)]
enum Name {
    Text(String),
    Bytes(Vec<u8>),
}

impl Name {
    fn of(name: &OsStr) -> Self {
        match name.to_str() {
            Some(text) => Self::Text(text.to_owned()),
            None => Self::Bytes(name.as_encoded_bytes().to_vec()),
        }
    }

    fn into_os(self) -> OsString {
        match self {
            Self::Text(text) => text.into(),
            #[cfg(unix)]
            Self::Bytes(bytes) => std::os::unix::ffi::OsStringExt::from_vec(bytes),
            #[cfg(not(unix))]
            Self::Bytes(bytes) => String::from_utf8_lossy(&bytes).into_owned().into(),
        }
    }
}

/// What a record says.
#[derive(Debug, Default)]
struct Recorded {
    settings: Option<Value>,
    items: Items,
    /// The bytes of its whole lines.
    whole: u64,
}

/// What every record begins with.
const BEGINS: &[u8] = b"{\"job\":{\"schema\":";

/// Why a record cannot be read.
#[derive(Debug)]
enum NoRecord {
    Read(io::Error),
    /// The number of the line that is none.
    Line(usize),
}

/// Reads a record line by line; a last line without its end is left out.
fn parse(mut text: impl BufRead) -> Result<Recorded, NoRecord> {
    let (mut recorded, mut line) = (Recorded::default(), Vec::new());
    for number in 1.. {
        line.clear();
        let most = (MOST_LINE as u64).saturating_add(1);
        let length = text.by_ref().take(most).read_until(b'\n', &mut line).map_err(NoRecord::Read)?;
        let wrong = || NoRecord::Line(number);
        if !line.ends_with(b"\n") {
            // Of a process that was killed at once there is a part of the first line; of ours alone.
            let is_ours = recorded.settings.is_some()
                || line.iter().zip(BEGINS).all(|(found, expected)| found == expected);
            return if length <= MOST_LINE && is_ours { Ok(recorded) } else { Err(wrong()) };
        }
        recorded.whole = recorded.whole.saturating_add(length as u64);
        if line == b"\n" {
            continue;
        }
        let (name, is_done, source, stamp) = match serde_json::from_slice(&line).map_err(|_| wrong())? {
            Line::Job { schema: SCHEMA, settings } if recorded.settings.is_none() => {
                recorded.settings = Some(settings);
                continue;
            }
            Line::Begun { output, source, before } if recorded.settings.is_some() => {
                (output, false, source, before)
            }
            Line::Done { output, source, stamp } if recorded.settings.is_some() => {
                (output, true, source, Some(stamp))
            }
            Line::Failed { .. } if recorded.settings.is_some() => continue,
            _ => return Err(wrong()),
        };
        recorded.items.insert(&name.into_os(), is_done, &source, stamp.as_ref());
    }
    Ok(recorded)
}

/// Reads a record for nothing but that: a target of fuzzing.
#[cfg(feature = "fuzz-targets")]
pub(crate) fn try_parse(text: &[u8]) {
    let _ = parse(text);
}

impl Record {
    /// Opens the record in `folder`, or begins one.
    ///
    /// `settings` is everything but the files themselves that decides what the outputs hold. With `overwrite`, a
    /// record of other settings is started again.
    ///
    /// # Errors
    ///
    /// [`FileError`] when another process works in the folder, the folder was made with other settings, a link or something
    /// else than a record has its name, or the record cannot be read or written. The file is then as it was.
    pub fn open(folder: &Path, settings: &Value, overwrite: bool) -> Result<Self, FileError> {
        let path = folder.join(RECORD);
        let cannot_write =
            |error: io::Error| FileError::Write { path: path.clone(), cause: error.to_string() };
        // Before opening: a link would lead to a file of somebody else, and a pipe would be waited for.
        if path.symlink_metadata().is_ok_and(|about| !about.is_file()) {
            return Err(FileError::ForeignRecord { path });
        }
        let file =
            OpenOptions::new().read(true).append(true).create(true).open(&path).map_err(cannot_write)?;
        if !lock(&file) {
            return Err(FileError::Busy { folder: folder.to_owned() });
        }
        let recorded = match parse(BufReader::new(&file)) {
            Ok(recorded) => recorded,
            Err(NoRecord::Read(error)) => return Err(FileError::Read { path, error }),
            Err(NoRecord::Line(line)) => return Err(FileError::DamagedRecord { path, line }),
        };
        let Recorded { settings: made_with, items, whole } = recorded;
        let is_same = made_with.as_ref() == Some(settings);
        if let Some(made_with) = made_with.filter(|_| !is_same && !overwrite) {
            let differences = differences(&made_with, settings);
            return Err(FileError::OtherSettings { folder: folder.to_owned(), differences });
        }
        // From here on the file is known to be ours.
        let items = if is_same { items } else { Items::default() };
        file.set_len(if is_same { whole } else { 0 }).map_err(cannot_write)?;
        let record = Self { path: path.clone(), folder: folder.to_owned(), file: Mutex::new(file), items };
        if !is_same {
            record.append(&Line::Job { schema: SCHEMA, settings: settings.clone() })?;
        }
        Ok(record)
    }

    /// The path of an output in the folder.
    fn name_of<'i>(&self, item: &'i Item) -> &'i OsStr {
        let within = item.output.strip_prefix(&self.folder).ok();
        within.map_or_else(|| item.output.file_name().unwrap_or_default(), Path::as_os_str)
    }

    fn file(&self) -> std::sync::MutexGuard<'_, File> {
        self.file.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn append(&self, line: &Line) -> Result<(), FileError> {
        let failed = |cause: String| FileError::Write { path: self.path.clone(), cause };
        let mut text = serde_json::to_vec(line).map_err(|error| failed(error.to_string()))?;
        text.push(b'\n');
        let mut file = self.file();
        let whole = file.metadata().map_err(|error| failed(error.to_string()))?.len();
        file.write_all(&text).map_err(|error| {
            // Half a line on a full disk would spoil the next one.
            let _ = file.set_len(whole);
            failed(error.to_string())
        })
    }

    /// What stands at the output of an item.
    pub fn state(&self, item: &Item, overwrite: bool) -> State {
        let there = Stamp::of(&item.output).ok();
        if there.is_none() && item.output.symlink_metadata().is_err() {
            return State::Missing;
        }
        let source = Source::of(item).ok();
        let ours = self.items.get(self.name_of(item)).is_some_and(|known| {
            let is_there = known.stamp == self.items.digest(&there.as_ref());
            // What stood there before it was begun is still nobody's but its owner's.
            let is_ours = known.is_done == is_there;
            is_ours && source.as_ref().is_some_and(|source| known.of == self.items.digest(&source.identity()))
        });
        let is_made = |known: &Digests| {
            let is_same = source.as_ref().is_some_and(|source| known.source == self.items.digest(source));
            known.is_done && is_same
        };
        if ours && self.items.get(self.name_of(item)).is_some_and(is_made) {
            return State::Made;
        }
        if ours || overwrite { State::Replaceable } else { State::Foreign }
    }

    /// Makes one output that is no image of a [`Plan`](super::Plan), unless it is done; says whether it was.
    ///
    /// The argument of `write` says whether it may replace an existing file.
    ///
    /// # Errors
    ///
    /// What `write` says, or [`FileError`] when the record cannot be written.
    pub fn make<E: From<FileError>>(
        &self,
        item: &Item,
        overwrite: bool,
        write: impl FnOnce(bool) -> Result<(), E>,
    ) -> Result<bool, E> {
        let may_replace = match self.state(item, overwrite) {
            State::Made => return Ok(true),
            State::Replaceable => true,
            State::Missing | State::Foreign => overwrite,
        };
        let sources = self.sources(item)?;
        self.begin(item, &sources)?;
        write(may_replace)?;
        self.done(item, sources)?;
        Ok(false)
    }

    /// Remembers what an output will be made from, before its files are read.
    pub(super) fn sources(&self, item: &Item) -> Result<Sources, FileError> {
        let source = Source::of(item).map_err(|error| FileError::Read { path: item.input.clone(), error })?;
        let is_ours = self.state(item, false) != State::Foreign;
        let before = if is_ours { None } else { Stamp::of(&item.output).ok() };
        Ok(Sources { source, before })
    }

    /// An output is about to get its name. The record is on the disk before it has it: after a power cut no output of
    /// ours is unknown.
    pub(super) fn begin(&self, item: &Item, sources: &Sources) -> Result<(), FileError> {
        let Sources { source, before } = sources.clone();
        self.append(&Line::Begun { output: Name::of(self.name_of(item)), source, before })?;
        let failed =
            |error: io::Error| FileError::Write { path: self.path.clone(), cause: error.to_string() };
        // Not under the lock: others may add their lines meanwhile.
        let file = self.file().try_clone().map_err(failed)?;
        file.sync_data().map_err(failed)
    }

    /// An output has its name.
    pub(super) fn done(&self, item: &Item, sources: Sources) -> Result<(), FileError> {
        let stamp =
            Stamp::of(&item.output).map_err(|error| FileError::Read { path: item.output.clone(), error })?;
        self.append(&Line::Done { output: Name::of(self.name_of(item)), source: sources.source, stamp })
    }

    /// An item failed.
    pub(super) fn failed(&self, item: &Item, error: &FileError) -> Result<(), FileError> {
        self.append(&Line::Failed { output: Name::of(self.name_of(item)), error: error.to_string() })
    }
}

/// What an output is made from, as it was before it was read.
#[derive(Clone, Debug)]
pub(super) struct Sources {
    source: Source,
    before: Option<Stamp>,
}

#[cfg(test)]
mod tests;
