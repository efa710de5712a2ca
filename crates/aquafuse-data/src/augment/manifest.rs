//! `manifest.jsonl`: what was made from what, and how; one JSON object a line.
//!
//! While a run goes on, lines come in the order in which images get done, and a line without its end was being
//! written when the process was killed. A run that ends writes the file again: sorted, with the files about all images,
//! and a last line that holds the digest of all before it. Two runs that did the same have the same manifest.

use std::collections::BTreeMap;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::iter;
use std::path::Path;

use sha2::{Digest, Sha256};

use super::AugmentError;
use super::header::{Header, SCHEMA};
use super::line::{Container, Line, Listed, Original, Variant, Written};
use crate::files::FileError;
use crate::files::{Hashed, hexadecimal};
use crate::image_file::{ReadOptions, open_file};

/// More than the line of a shard with a million variants takes, or of a job with as many waters.
const LONGEST: u64 = 1 << 30;

/// The most bytes of a line of a manifest: a quarter of the memory, as for annotations.
pub(super) fn most_line(reading: &ReadOptions) -> u64 {
    reading.most_beside().min(LONGEST)
}

/// What a manifest says of one image.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Entry {
    pub(super) original: Option<Original>,
    pub(super) container: Option<Box<Container>>,
    pub(super) variants: BTreeMap<u32, Variant>,
    pub(super) skipped: Option<String>,
    pub(super) failed: Option<String>,
}

/// A manifest as it was read.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Manifest {
    pub(super) header: Header,
    pub(super) entries: BTreeMap<String, Entry>,
    pub(super) indices: Vec<Written>,
    /// Whether its last line is there and right; none where it has none.
    pub(super) sealed: Option<bool>,
}

impl Entry {
    /// Every file that it lists.
    pub(super) fn listed<'a>(&'a self) -> impl Iterator<Item = Listed<'a>> {
        let companions = |made: &'a [Written]| made.iter().map(Written::listed);
        let original = self.original.iter();
        let original =
            original.flat_map(move |made| iter::once(made.listed()).chain(companions(&made.companions)));
        let variants = self.variants.values();
        let variants =
            variants.flat_map(move |made| iter::once(made.listed()).chain(companions(&made.companions)));
        original.chain(variants).chain(self.container.iter().map(|made| made.listed()))
    }

    /// Every variant, with the key of the file that holds it where it is none itself.
    pub(super) fn all_variants(&self) -> impl Iterator<Item = (&Variant, Option<&str>)> {
        let own = self.variants.values().map(|variant| (variant, None));
        let held = self.container.iter().flat_map(|container| {
            container.variants.iter().map(|variant| (variant, Some(container.key.as_str())))
        });
        own.chain(held)
    }

    /// Adds what a line says of it.
    pub(super) fn learn(&mut self, line: Line) {
        match line {
            Line::Original(original) => self.original = Some(original),
            Line::Container(container) => self.container = Some(container),
            Line::Variant(variant) => {
                self.variants.insert(variant.number, variant);
            }
            Line::Skipped { why, .. } => self.skipped = Some(why),
            Line::Failed { error, .. } => self.failed = Some(error),
            Line::Job(_) | Line::Index(_) | Line::End { .. } => {}
        }
    }
}

/// A part of a manifest.
pub(super) enum Part<'a> {
    /// What it says of the image of a key.
    Entry(&'a str, &'a Entry),
    /// A file about all images.
    Index(&'a Written),
}

/// A manifest as it is written at the end of a run.
pub(super) struct Sealing<W: Write>(Hashed<W>);

impl<W: Write> Sealing<W> {
    pub(super) fn begin(out: W, header: &Header) -> io::Result<Self> {
        let mut sealing = Self(Hashed::new(out));
        sealing.add(Line::Job(Box::new(header.clone())).text().as_bytes())?;
        Ok(sealing)
    }

    /// Adds a line, with its end.
    pub(super) fn add(&mut self, line: &[u8]) -> io::Result<()> {
        self.0.write_all(line)
    }

    /// Ends it with the files about all images and the digest of all before.
    pub(super) fn end(mut self, indices: Vec<Written>) -> io::Result<W> {
        for written in indices {
            self.add(Line::Index(written).text().as_bytes())?;
        }
        let (_, sha256) = self.0.result();
        self.add(Line::End { sha256 }.text().as_bytes())?;
        Ok(self.0.into_inner())
    }
}

impl Manifest {
    /// Reads a manifest; a last line without its end is left out.
    pub(super) fn read(path: &Path, reading: &ReadOptions) -> Result<Self, AugmentError> {
        let (file, _) = open_file(path)?;
        Self::from(BufReader::new(file), most_line(reading)).map_err(|error| error.of(path))
    }

    /// Shows the parts of a manifest one after the other; says whether its last line is there and right. One of a run that ended is
    /// never whole in memory: its lines about one image stand together.
    pub(super) fn show(
        path: &Path,
        reading: &ReadOptions,
        mut each: impl FnMut(Part<'_>),
    ) -> Result<Option<bool>, AugmentError> {
        let lines = |show: &mut dyn FnMut(Line)| {
            let (file, _) = open_file(path)?;
            let scanned = scan(BufReader::new(file), most_line(reading), |line, _| show(line));
            scanned.map_err(|error| error.of(path))
        };
        let sealed = lines(&mut |_| {})?.sealed;
        if sealed.is_none() {
            let found = Self::read(path, reading)?;
            found.entries.iter().for_each(|(key, entry)| each(Part::Entry(key, entry)));
            found.indices.iter().for_each(|written| each(Part::Index(written)));
            return Ok(sealed);
        }
        let mut open: Option<(String, Entry)> = None;
        lines(&mut |line| {
            if let Line::Index(written) = &line {
                each(Part::Index(written));
            }
            let Some(key) = line.key() else { return };
            if open.as_ref().is_none_or(|(other, _)| other != key)
                && let Some((other, done)) = open.replace((key.to_owned(), Entry::default()))
            {
                each(Part::Entry(&other, &done));
            }
            if let Some((_, entry)) = &mut open {
                entry.learn(line);
            }
        })?;
        if let Some((key, done)) = open {
            each(Part::Entry(&key, &done));
        }
        Ok(sealed)
    }

    /// Reads one from anywhere.
    pub(super) fn from(source: impl BufRead, most_line: u64) -> Result<Self, ScanError> {
        let (mut entries, mut indices) = (BTreeMap::new(), Vec::new());
        let scanned = scan(source, most_line, |line, _| {
            if let Line::Index(written) = line {
                indices.push(written);
            } else if let Some(key) = line.key() {
                let entry: &mut Entry = entries.entry(key.to_owned()).or_default();
                entry.learn(line);
            }
        })?;
        let Scanned { header, sealed, .. } = scanned;
        Ok(Self { header, entries, indices, sealed })
    }

    /// Every variant, with the key of the file that holds it where it is none itself.
    pub(super) fn variants(&self) -> impl Iterator<Item = (&Variant, Option<&str>)> {
        self.entries.values().flat_map(Entry::all_variants)
    }

    /// Whether an image was carried over unchanged, without variants.
    pub(super) fn is_carried(&self, key: &str) -> bool {
        self.entries.get(key).is_some_and(|entry| entry.original.is_some() && entry.variants.is_empty())
    }

    /// Every file that it lists.
    pub(super) fn listed(&self) -> impl Iterator<Item = Listed<'_>> {
        self.entries.values().flat_map(Entry::listed).chain(self.indices.iter().map(Written::listed))
    }
}

/// Where a line stands: its first byte, and how many there are with its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Place {
    pub(super) first: u64,
    pub(super) bytes: usize,
}

/// What is known of a manifest when its lines have been seen.
pub(super) struct Scanned {
    pub(super) header: Header,
    /// Whether its last line is there and right; none where it has none.
    pub(super) sealed: Option<bool>,
    /// The bytes before the files about all images.
    pub(super) body: u64,
}

/// A manifest cannot be read.
#[derive(Debug)]
pub(super) enum ScanError {
    Read(io::Error),
    /// The number of the line that is none.
    Line(usize),
}

impl ScanError {
    pub(super) fn of(self, path: &Path) -> AugmentError {
        let path = path.to_owned();
        match self {
            Self::Read(error) => FileError::Read { path, error }.into(),
            Self::Line(line) => AugmentError::Manifest { path, line },
        }
    }
}

/// Shows every line but the first and the last to `each`, with its place; a last line without its end is left out.
pub(super) fn scan(
    mut source: impl BufRead,
    most_line: u64,
    mut each: impl FnMut(Line, Place),
) -> Result<Scanned, ScanError> {
    let (mut header, mut sealed, mut is_body) = (None, None, true);
    let (mut first, mut body) = (0_u64, 0_u64);
    let (mut text, mut digest) = (Vec::new(), Sha256::new());
    for number in 1.. {
        text.clear();
        let bytes = source.by_ref().take(most_line).read_until(b'\n', &mut text).map_err(ScanError::Read)?;
        if !text.ends_with(b"\n") {
            if bytes as u64 >= most_line {
                return Err(ScanError::Line(number));
            }
            break;
        }
        let line = Line::read(&text).map_err(|_| ScanError::Line(number))?;
        // Nothing stands before the first line or behind the last.
        if header.is_none() != matches!(line, Line::Job(_)) || sealed.is_some() {
            return Err(ScanError::Line(number));
        }
        match line {
            Line::Job(found) if found.schema == SCHEMA => header = Some(*found),
            Line::Job(_) => return Err(ScanError::Line(number)),
            Line::End { sha256 } => sealed = Some(hexadecimal(&digest.clone().finalize()) == sha256),
            line => {
                is_body &= !matches!(line, Line::Index(_));
                each(line, Place { first, bytes });
            }
        }
        digest.update(&text);
        first = first.saturating_add(bytes as u64);
        if is_body && sealed.is_none() {
            body = first;
        }
    }
    let header = header.ok_or(ScanError::Line(1))?;
    Ok(Scanned { header, sealed, body })
}
