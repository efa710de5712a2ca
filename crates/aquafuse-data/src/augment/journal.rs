//! The manifest of a run that goes on.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::manifest::{Entry, Header, Line, Manifest, Written, parse, sealed_text};
use super::{AugmentError, Shard};
use crate::dataset::inside;
use crate::picture::{FileError, write_text};
use crate::settings::differences;

/// What the names of manifests begin and end with.
const NAMES: (&str, &str) = ("manifest", ".jsonl");

/// A manifest, open and locked against other processes until dropped.
#[derive(Debug)]
pub(super) struct Journal {
    path: PathBuf,
    file: Mutex<File>,
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
    /// Begins the manifest in `folder`, or goes on with it: gives what is known of each picture by now, from this shard's
    /// manifest and from those of others.
    ///
    /// With `overwrite`, what a run of other settings made is removed.
    pub(super) fn open(
        folder: &Path,
        shard: Shard,
        header: &Header,
        overwrite: bool,
    ) -> Result<(Self, BTreeMap<String, Entry>), AugmentError> {
        let path = folder.join(shard.manifest());
        let cannot_write =
            |error: std::io::Error| FileError::Write { path: path.clone(), cause: error.to_string() };
        let options = OpenOptions::new().read(true).append(true).create(true).open(&path);
        let mut file = options.map_err(cannot_write)?;
        if let Err(TryLockError::WouldBlock) = file.try_lock() {
            return Err(FileError::Busy { folder: folder.to_owned() }.into());
        }
        let mut text = Vec::new();
        file.read_to_end(&mut text).map_err(|error| FileError::Read { path: path.clone(), error })?;
        let mut known = BTreeMap::new();
        let mut kept = 0;
        // A process that was killed at once has left no whole line.
        if text.contains(&b'\n') {
            match parse(&text) {
                Ok(found) if found.header.makes_as(header) => {
                    kept = found.body;
                    learn(&mut known, found);
                }
                Ok(found) if overwrite => remove(folder, &found),
                Ok(found) => return Err(other_settings(folder, &found.header, header)),
                Err(line) => return Err(AugmentError::Manifest { path, line }),
            }
        }
        for other in manifests(folder)?.into_iter().filter(|other| *other != path) {
            let found = Manifest::read(&other)?;
            if !found.header.makes_as(header) {
                return Err(other_settings(folder, &found.header, header));
            }
            learn(&mut known, found);
        }
        file.set_len(kept as u64).map_err(cannot_write)?;
        let journal = Self { path: path.clone(), file: Mutex::new(file) };
        if kept == 0 {
            journal.add(&[Line::Job(Box::new(header.clone()))])?;
        }
        Ok((journal, known))
    }

    fn file(&self) -> MutexGuard<'_, File> {
        self.file.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds lines, all or none.
    pub(super) fn add(&self, lines: &[Line]) -> Result<(), FileError> {
        let failed =
            |error: std::io::Error| FileError::Write { path: self.path.clone(), cause: error.to_string() };
        let text: String = lines.iter().map(Line::text).collect();
        let mut file = self.file();
        let whole = file.metadata().map_err(failed)?.len();
        file.write_all(text.as_bytes()).map_err(|error| {
            // Half a line on a full disk would spoil the next one.
            let _ = file.set_len(whole);
            failed(error)
        })
    }

    /// Writes the manifest of a run that has ended.
    pub(super) fn seal(
        self,
        header: &Header,
        entries: BTreeMap<String, Entry>,
        indices: Vec<Written>,
    ) -> Result<(), FileError> {
        write_text(&self.path, &sealed_text(header, entries, indices), true)
    }
}

/// What is said where a folder was filled with other settings.
fn other_settings(folder: &Path, was: &Header, is: &Header) -> AugmentError {
    let value = |header: &Header| serde_json::to_value(header).unwrap_or_default();
    let differences = differences(&value(was), &value(is));
    FileError::OtherSettings { folder: folder.to_owned(), differences }.into()
}

/// Adds what a manifest says to what is known.
fn learn(known: &mut BTreeMap<String, Entry>, found: Manifest) {
    for (key, entry) in found.entries {
        // What was skipped or failed is tried again.
        let Entry { original, container, variants, .. } = entry;
        let known = known.entry(key).or_default();
        known.container = container.or(known.container.take());
        known.original = original.or(known.original.take());
        known.variants.extend(variants);
    }
}

/// Removes what a manifest lists.
fn remove(folder: &Path, found: &Manifest) {
    for written in found.written() {
        if let Ok(path) = inside(&written.output) {
            let _ = std::fs::remove_file(folder.join(path));
        }
    }
}
