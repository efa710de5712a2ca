//! `manifest.jsonl`: what was made from what, and how; one JSON object a line.
//!
//! While a run goes on, lines come in the order in which images get done, and a line without its end was being
//! written when the process was killed. A run that ends writes the file again: sorted, with the files about all images,
//! and a last line that holds the digest of all before it. Two runs that did the same have the same manifest.

use std::collections::BTreeMap;
use std::fs::File;
use std::hash::{BuildHasher as _, BuildHasherDefault, DefaultHasher};
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write};
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

/// A manifest in its file. Its lines are read where they are asked for, so that it is never whole in memory.
#[derive(Debug)]
pub(super) struct Manifest<S> {
    source: S,
    most_line: u64,
    pub(super) header: Header,
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

    /// Whether the image was carried over unchanged, without variants.
    pub(super) fn is_carried(&self) -> bool {
        self.original.is_some() && self.variants.is_empty()
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

impl Manifest<File> {
    /// The manifest in a file; a last line without its end is left out.
    pub(super) fn open(path: &Path, reading: &ReadOptions) -> Result<Self, AugmentError> {
        let (file, _) = open_file(path)?;
        Self::of(file, most_line(reading)).map_err(|error| error.of(path))
    }
}

impl<S: Read + Seek> Manifest<S> {
    /// The manifest in anything that can be read twice.
    pub(super) fn of(mut source: S, most_line: u64) -> Result<Self, ScanError> {
        source.rewind()?;
        let Scanned { header, sealed, .. } = scan(BufReader::new(&mut source), most_line, |_, _| {})?;
        Ok(Self { source, most_line, header, sealed })
    }

    /// Shows its parts one after the other: those of images first.
    pub(super) fn show(&mut self, mut each: impl FnMut(Part<'_>)) -> Result<(), ScanError> {
        // The lines about one image stand together only when a run has ended.
        if self.sealed.is_none() {
            return self.show_gathered(each);
        }
        let mut open: Option<(String, Entry)> = None;
        self.lines(|line, _| {
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
        Ok(())
    }

    /// The same where lines about one image stand anywhere: their places are gathered first.
    fn show_gathered(&mut self, mut each: impl FnMut(Part<'_>)) -> Result<(), ScanError> {
        let (keys, mut places, mut indices) =
            (BuildHasherDefault::<DefaultHasher>::default(), Vec::new(), Vec::new());
        self.lines(|line, place| match (line.key(), &line) {
            (Some(key), _) => places.push((keys.hash_one(key), place)),
            (None, Line::Index(written)) => indices.push(written.clone()),
            (None, _) => {}
        })?;
        places.sort_by_key(|(key, _)| *key);
        let mut text = Vec::new();
        for group in places.chunk_by(|(one, _), (other, _)| one == other) {
            // Two keys may share a digest.
            let mut entries: BTreeMap<String, Entry> = BTreeMap::new();
            for (_, Place { first, bytes }) in group {
                text.resize(*bytes, 0);
                self.source.seek(SeekFrom::Start(*first))?;
                self.source.read_exact(&mut text)?;
                let line = Line::read(&text).map_err(io::Error::from)?;
                if let Some(key) = line.key() {
                    entries.entry(key.to_owned()).or_default().learn(line);
                }
            }
            entries.iter().for_each(|(key, entry)| each(Part::Entry(key, entry)));
        }
        indices.iter().for_each(|written| each(Part::Index(written)));
        Ok(())
    }

    fn lines(&mut self, each: impl FnMut(Line, Place)) -> Result<(), ScanError> {
        self.source.rewind()?;
        scan(BufReader::new(&mut self.source), self.most_line, each).map(|_| ())
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

impl From<io::Error> for ScanError {
    fn from(error: io::Error) -> Self {
        Self::Read(error)
    }
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
