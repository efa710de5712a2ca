//! The manifest of a run that goes on.
//!
//! Records are kept only in the file. Memory holds the positions of each image's lines, so that it does not grow with
//! their length.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::header::Header;
use super::line::{Line, Listed, Written};
use super::manifest::{Entry, Manifest, Part, Place, ScanError, Scanned, Sealing, most_line, scan};
use super::{AugmentError, Shard};
use crate::dataset::inside;
use crate::files::lock;
use crate::files::{FileError, write_atomically};
use crate::image_file::ReadOptions;
use crate::run::differences;

/// What every manifest begins with.
const BEGINS: &[u8] = b"{\"line\":\"job\",";
/// What the names of manifests begin and end with.
const NAMES: (&str, &str) = ("manifest", ".jsonl");

/// A manifest, open and locked against other processes until dropped.
///
/// Images are called by their places in the dataset.
#[derive(Debug)]
pub(super) struct Journal {
    path: PathBuf,
    state: Mutex<State>,
}

#[derive(Debug)]
struct State {
    file: File,
    /// The bytes of whole lines.
    end: u64,
    /// The lines of each image that hold, in the order of a manifest.
    lines: BTreeMap<usize, Vec<(Slot, Place)>>,
    /// Lines that could not be added when they should have been.
    owed: Vec<(usize, Line)>,
}

/// What a line says of an image; a later line of the same slot replaces an earlier one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Slot {
    Original,
    Container,
    Variant(u32),
    Skipped,
    Failed,
}

impl Slot {
    fn of(line: &Line) -> Option<Self> {
        match line {
            Line::Original(_) => Some(Self::Original),
            Line::Container(_) => Some(Self::Container),
            Line::Variant(variant) => Some(Self::Variant(variant.number)),
            Line::Skipped { .. } => Some(Self::Skipped),
            Line::Failed { .. } => Some(Self::Failed),
            Line::Job(_) | Line::Index(_) | Line::End { .. } => None,
        }
    }

    /// Whether it is something that was made: what was skipped or failed is tried again.
    fn is_made(self) -> bool {
        !matches!(self, Self::Skipped | Self::Failed)
    }
}

/// The manifests in a folder: one, or one a shard.
pub(super) fn manifests(folder: &Path) -> Result<Vec<PathBuf>, FileError> {
    let failed = |error| FileError::Read { path: folder.to_owned(), error };
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        if name.starts_with(NAMES.0) && name.ends_with(NAMES.1) {
            found.push(path);
        }
    }
    found.sort();
    Ok(found)
}

impl Journal {
    /// Begins the manifest in `folder`, or goes on with it and with what the manifests of other shards say of this one's
    /// images. `place` gives the place of an image that takes part, by its key.
    ///
    /// With `overwrite`, what a run of other settings made is removed.
    pub(super) fn open(
        folder: &Path,
        shard: Shard,
        header: &Header,
        overwrite: bool,
        reading: &ReadOptions,
        place: &dyn Fn(&str) -> Option<usize>,
    ) -> Result<Self, AugmentError> {
        let most_line = most_line(reading);
        let path = folder.join(shard.manifest());
        let cannot_write = |error: io::Error| cannot_write(&path, &error);
        // Before opening: a link would lead to a file of somebody else, and a pipe would be waited for.
        if path.symlink_metadata().is_ok_and(|about| !about.is_file()) {
            return Err(FileError::ForeignRecord { path }.into());
        }
        let options = OpenOptions::new().read(true).append(true).create(true).open(&path);
        let mut file = options.map_err(cannot_write)?;
        if !lock(&file) {
            return Err(FileError::Busy { folder: folder.to_owned() }.into());
        }
        let mut lines: BTreeMap<usize, Vec<(Slot, Place)>> = BTreeMap::new();
        let known = scan(BufReader::new(&file), most_line, |line, at| {
            let slot = Slot::of(&line).filter(|slot| slot.is_made());
            if let (Some(slot), Some(sample)) = (slot, line.key().and_then(place)) {
                put(lines.entry(sample).or_default(), slot, at);
            }
        });
        let end = match known {
            Ok(Scanned { header: was, body, .. }) if was.makes_as(header) => body,
            Ok(_) if overwrite => {
                let was =
                    Manifest::of(&file, most_line).and_then(|mut was| was.show(|part| remove(folder, &part)));
                was.map_err(|error| error.of(&path))?;
                lines.clear();
                0
            }
            Ok(Scanned { header: was, .. }) => return Err(other_settings(folder, &was, header)),
            // A process that was killed at once has left no whole line.
            Err(ScanError::Line(1)) if is_begun(&mut file, most_line).map_err(cannot_write)? => 0,
            Err(error) => return Err(error.of(&path)),
        };
        file.set_len(end).map_err(cannot_write)?;
        let state = Mutex::new(State { file, end, lines, owed: Vec::new() });
        let journal = Self { path: path.clone(), state };
        if end == 0 {
            journal.state().write(&[Line::Job(Box::new(header.clone()))]).map_err(cannot_write)?;
        }
        for other in manifests(folder)?.into_iter().filter(|other| *other != path) {
            journal.adopt(folder, &other, header, most_line, place)?;
        }
        Ok(journal)
    }

    /// Adds what another manifest says was made of images of this shard, where this one says nothing.
    fn adopt(
        &self,
        folder: &Path,
        other: &Path,
        header: &Header,
        most_line: u64,
        place: &dyn Fn(&str) -> Option<usize>,
    ) -> Result<(), AugmentError> {
        let open = || File::open(other).map_err(|error| FileError::Read { path: other.to_owned(), error });
        let Scanned { header: theirs, .. } =
            scan(BufReader::new(open()?), most_line, |_, _| {}).map_err(|error| error.of(other))?;
        if !theirs.makes_as(header) {
            return Err(other_settings(folder, &theirs, header));
        }
        let mut failure = None;
        let scanned = scan(BufReader::new(open()?), most_line, |line, _| {
            let slot = Slot::of(&line).filter(|slot| slot.is_made());
            if let (Some(slot), Some(sample), None) = (slot, line.key().and_then(place), &failure)
                && !self.slots(sample).contains(&slot)
            {
                failure = self.add(sample, &[line]).err();
            }
        });
        scanned.map_err(|error| error.of(other))?;
        failure.map_or(Ok(()), |error| Err(error.into()))
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds lines about an image, all or none.
    pub(super) fn add(&self, sample: usize, lines: &[Line]) -> Result<(), FileError> {
        let mut state = self.state();
        let places = state.write(lines).map_err(|error| cannot_write(&self.path, &error))?;
        let of_sample = state.lines.entry(sample).or_default();
        for (line, place) in lines.iter().zip(places) {
            if let Some(slot) = Slot::of(line) {
                put(of_sample, slot, place);
            }
        }
        Ok(())
    }

    /// Adds a line about an image now if that can be done, or else when the run ends.
    pub(super) fn add_or_owe(&self, sample: usize, line: Line) {
        if self.add(sample, std::slice::from_ref(&line)).is_err() {
            self.state().owed.push((sample, line));
        }
    }

    /// What was made of an image does not hold any more.
    pub(super) fn forget(&self, sample: usize, slot: Slot) {
        if let Some(lines) = self.state().lines.get_mut(&sample) {
            lines.retain(|(other, _)| *other != slot);
        }
    }

    /// What is known of an image, in the order of a manifest.
    pub(super) fn slots(&self, sample: usize) -> Vec<Slot> {
        let state = self.state();
        state.lines.get(&sample).into_iter().flatten().map(|(slot, _)| *slot).collect()
    }

    /// What its lines say of an image.
    pub(super) fn entry(&self, sample: usize) -> Result<Entry, FileError> {
        let mut state = self.state();
        let places = state.lines.get(&sample).cloned().unwrap_or_default();
        let mut entry = Entry::default();
        for (_, place) in places {
            let line = state.read(place).and_then(|text| Ok(Line::read(&text)?));
            entry.learn(line.map_err(|error| FileError::Read { path: self.path.clone(), error })?);
        }
        Ok(entry)
    }

    /// Writes the manifest of a run that has ended.
    pub(super) fn seal(self, header: &Header, indices: Vec<Written>) -> Result<(), FileError> {
        let owed = std::mem::take(&mut self.state().owed);
        for (sample, line) in owed {
            self.add(sample, &[line])?;
        }
        let mut state = self.state();
        write_atomically(&self.path, true, |out| -> io::Result<()> {
            let mut sealing = Sealing::begin(out, header)?;
            let places: Vec<Place> = state.lines.values().flatten().map(|(_, place)| *place).collect();
            for place in places {
                sealing.add(&state.read(place)?)?;
            }
            sealing.end(indices).map(|_| ())
        })
    }
}

impl State {
    /// Writes lines behind all others, and says where they stand.
    fn write(&mut self, lines: &[Line]) -> io::Result<Vec<Place>> {
        let (mut text, mut places) = (String::new(), Vec::new());
        for line in lines {
            let line = line.text();
            places.push(Place { first: self.end.saturating_add(text.len() as u64), bytes: line.len() });
            text.push_str(&line);
        }
        if let Err(error) = self.file.write_all(text.as_bytes()) {
            // Half a line on a full disk would spoil the next one.
            let _ = self.file.set_len(self.end);
            return Err(error);
        }
        self.end = self.end.saturating_add(text.len() as u64);
        Ok(places)
    }

    /// The line that stands at a place.
    fn read(&mut self, Place { first, bytes }: Place) -> io::Result<Vec<u8>> {
        let mut text = vec![0; bytes];
        self.file.seek(SeekFrom::Start(first))?;
        self.file.read_exact(&mut text)?;
        Ok(text)
    }
}

/// Puts a line into its order, instead of another of its slot.
fn put(lines: &mut Vec<(Slot, Place)>, slot: Slot, place: Place) {
    match lines.binary_search_by_key(&slot, |(slot, _)| *slot) {
        Ok(at) => lines.iter_mut().skip(at).take(1).for_each(|line| line.1 = place),
        Err(at) => lines.insert(at, (slot, place)),
    }
}

/// Whether a file holds nothing but a part of a manifest's first line.
fn is_begun(file: &mut File, most_line: u64) -> io::Result<bool> {
    file.rewind()?;
    let mut text = Vec::new();
    BufReader::new(file).take(most_line).read_until(b'\n', &mut text)?;
    Ok(!text.ends_with(b"\n") && text.iter().zip(BEGINS).all(|(found, expected)| found == expected))
}

fn cannot_write(path: &Path, error: &io::Error) -> FileError {
    FileError::Write { path: path.to_owned(), cause: error.to_string() }
}

/// What is said where a folder was filled with other settings.
fn other_settings(folder: &Path, was: &Header, is: &Header) -> AugmentError {
    let value = |header: &Header| serde_json::to_value(header.bounded()).unwrap_or_default();
    let differences = differences(&value(was), &value(is));
    FileError::OtherSettings { folder: folder.to_owned(), differences }.into()
}

/// Removes what a part of a manifest lists.
fn remove(folder: &Path, part: &Part<'_>) {
    let listed: Vec<Listed<'_>> = match part {
        Part::Entry(_, entry) => entry.listed().collect(),
        Part::Index(written) => vec![written.listed()],
    };
    for written in listed {
        if let Ok(path) = inside(written.output) {
            let _ = std::fs::remove_file(folder.join(path));
        }
    }
}
