//! `manifest.jsonl`: what was made from what, and how; one JSON object a line.
//!
//! While a run goes on, lines come in the order in which pictures get done, and a line without its end was being
//! written when the process was killed. A run that ends writes the file anew: sorted, with the files about all pictures,
//! and a last line that holds the digest of all before it. Two runs that did the same have the same manifest.

use std::collections::BTreeMap;
use std::io::{self, BufRead, BufReader, Write};
use std::iter;
use std::path::Path;

use aquafuse::waterbody::Reason;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize};
use sha2::{Digest, Sha256};

use super::AugmentError;
use super::water::StoredWater;
use crate::digest::{Hashed, hexadecimal};
use crate::picture::{FileError, open_file};

/// It changes when a field changes its meaning or goes.
const SCHEMA: u32 = 1;

/// The first line: everything but the data set itself that decides what is made.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Header {
    pub(super) schema: u32,
    pub(super) version: String,
    /// The data set, as it was named.
    pub(super) dataset: String,
    pub(super) layout: String,
    pub(super) encoding: String,
    pub(super) settings: Settings,
    pub(super) waters: Vec<StoredWater>,
    /// What is taken instead of doubtful waters.
    pub(super) instead: Option<StoredWater>,
}

/// The settings as they stand in a manifest.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Settings {
    pub(super) seed: u64,
    pub(super) per_image: u32,
    pub(super) with_replacement: bool,
    #[serde(deserialize_with = "finite_range")]
    pub(super) theta_range: (f32, f32),
    #[serde(deserialize_with = "finite_range")]
    pub(super) alpha_range: (f32, f32),
    pub(super) model: String,
    #[serde(deserialize_with = "finite")]
    pub(super) most_gain: f32,
    pub(super) smooth: String,
    pub(super) depth: StoredDepth,
    pub(super) on_doubtful: String,
    pub(super) on_bad_annotation: String,
    pub(super) keep_originals: bool,
    pub(super) quality: u8,
    pub(super) lenient: bool,
}

/// A number that is one in 32 bits too.
fn finite<'de, D: Deserializer<'de>>(from: D) -> Result<f32, D::Error> {
    let number = f32::deserialize(from)?;
    if number.is_finite() { Ok(number) } else { Err(D::Error::custom("a number is too large")) }
}

fn finite_range<'de, D: Deserializer<'de>>(from: D) -> Result<(f32, f32), D::Error> {
    let (low, high) = <(f32, f32)>::deserialize(from)?;
    if low.is_finite() && high.is_finite() {
        Ok((low, high))
    } else {
        Err(D::Error::custom("a number is too large"))
    }
}

/// How depth is come by.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum StoredDepth {
    /// From colour, by a model.
    Model(String),
    /// From colour by Eq. 3, with these coefficients.
    Eq3([f64; 5]),
    /// From a folder of maps.
    Maps { folder: String, kind: String },
}

impl Header {
    pub(super) fn new(
        dataset: String,
        layout: &str,
        encoding: &str,
        settings: Settings,
        waters: Vec<StoredWater>,
        instead: Option<StoredWater>,
    ) -> Self {
        let version = env!("CARGO_PKG_VERSION").to_owned();
        let (layout, encoding) = (layout.to_owned(), encoding.to_owned());
        Self { schema: SCHEMA, version, dataset, layout, encoding, settings, waters, instead }
    }

    /// Whether two runs make the same of the same pictures.
    pub(super) fn makes_as(&self, other: &Self) -> bool {
        Self { dataset: String::new(), ..self.clone() } == Self { dataset: String::new(), ..other.clone() }
    }
}

/// A file that was written.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Written {
    /// Its path within the output.
    pub(super) output: String,
    pub(super) bytes: u64,
    pub(super) sha256: String,
}

/// A variant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Variant {
    pub(super) key: String,
    pub(super) number: u32,
    /// Which of the header's waters.
    pub(super) water: usize,
    #[serde(deserialize_with = "finite")]
    pub(super) theta: f32,
    #[serde(deserialize_with = "finite")]
    pub(super) alpha: f32,
    pub(super) source: Source,
    /// What the picture's own estimate is worth.
    pub(super) verdict: String,
    pub(super) reasons: Vec<Reason>,
    /// Share of the values that did not fit into the range.
    pub(super) clipped: f64,
    /// Share of the picture's contrast that is left, of the model `exchange`.
    pub(super) contrast_left: Option<f64>,
    /// Whether the picture's own water was exchanged for the one of the header.
    pub(super) instead: bool,
    #[serde(flatten)]
    pub(super) written: Written,
    pub(super) companions: Vec<Written>,
}

/// What a picture was made from.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Source {
    pub(super) bytes: u64,
    pub(super) sha256: String,
    /// The digest of its depth map, where it has one.
    pub(super) depth_sha256: Option<String>,
}

/// A picture that was carried over as it is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Original {
    pub(super) key: String,
    #[serde(flatten)]
    pub(super) written: Written,
    pub(super) companions: Vec<Written>,
}

/// A file that holds several pictures with their variants.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Container {
    pub(super) key: String,
    pub(super) source: Source,
    #[serde(flatten)]
    pub(super) written: Written,
    /// Its variants; `output` is a path in it.
    pub(super) variants: Vec<Variant>,
    /// Its pictures that have no variants, and why.
    pub(super) skipped: Vec<(String, String)>,
    /// Those that failed, and why.
    pub(super) failed: Vec<(String, String)>,
}

/// Every line but the first.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "line", rename_all = "lowercase")]
pub(super) enum Line {
    Job(Box<Header>),
    Variant(Variant),
    Original(Original),
    Container(Box<Container>),
    /// No variants: its estimate is doubtful, or its annotations are bad.
    Skipped {
        key: String,
        why: String,
    },
    Failed {
        key: String,
        error: String,
    },
    /// A file about all pictures.
    Index(Written),
    /// The digest of all lines before this one.
    End {
        sha256: String,
    },
}

impl Line {
    /// The key of the picture that it is about; none where it is about all.
    pub(super) fn key(&self) -> Option<&str> {
        match self {
            Self::Job(_) | Self::Index(_) | Self::End { .. } => None,
            Self::Variant(variant) => Some(&variant.key),
            Self::Original(original) => Some(&original.key),
            Self::Container(container) => Some(&container.key),
            Self::Skipped { key, .. } | Self::Failed { key, .. } => Some(key),
        }
    }

    pub(super) fn text(&self) -> String {
        serde_json::to_string(self).expect("names and numbers are JSON") + "\n"
    }
}

/// What a manifest says of one picture.
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
    fn written(&self) -> impl Iterator<Item = &Written> {
        let original =
            self.original.iter().flat_map(|made| iter::once(&made.written).chain(&made.companions));
        let variants =
            self.variants.values().flat_map(|made| iter::once(&made.written).chain(&made.companions));
        let container = self.container.iter().map(|made| &made.written);
        original.chain(variants).chain(container)
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

    /// Ends it with the files about all pictures and the digest of all before.
    pub(super) fn end(mut self, indices: Vec<Written>) -> io::Result<W> {
        for written in indices {
            self.add(Line::Index(written).text().as_bytes())?;
        }
        let (_, sha256) = self.0.told();
        self.add(Line::End { sha256 }.text().as_bytes())?;
        Ok(self.0.into_inner())
    }
}

impl Manifest {
    /// Reads a manifest; a last line without its end is left out.
    pub(super) fn read(path: &Path) -> Result<Self, AugmentError> {
        let (file, _) = open_file(path)?;
        Self::from(BufReader::new(file)).map_err(|error| error.of(path))
    }

    /// Reads one from anywhere.
    pub(super) fn from(source: impl BufRead) -> Result<Self, ScanError> {
        let (mut entries, mut indices) = (BTreeMap::new(), Vec::new());
        let scanned = scan(source, |line, _| {
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

    /// Every file that it lists.
    pub(super) fn written(&self) -> impl Iterator<Item = &Written> {
        self.entries.values().flat_map(Entry::written).chain(&self.indices)
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
    /// The bytes before the files about all pictures.
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
    mut each: impl FnMut(Line, Place),
) -> Result<Scanned, ScanError> {
    let (mut header, mut sealed, mut is_body) = (None, None, true);
    let (mut first, mut body) = (0_u64, 0_u64);
    let (mut text, mut digest) = (Vec::new(), Sha256::new());
    for number in 1.. {
        text.clear();
        let bytes = source.read_until(b'\n', &mut text).map_err(ScanError::Read)?;
        if !text.ends_with(b"\n") {
            break;
        }
        let none = |_| ScanError::Line(number);
        let line: Line = serde_json::from_slice(&text).map_err(none)?;
        // Nothing stands before the first line or behind the last.
        if header.is_none() != matches!(line, Line::Job(_)) || sealed.is_some() {
            return Err(ScanError::Line(number));
        }
        match line {
            Line::Job(found) if found.schema == SCHEMA => header = Some(*found),
            Line::Job(_) => return Err(ScanError::Line(number)),
            Line::End { sha256: told } => sealed = Some(hexadecimal(&digest.clone().finalize()) == told),
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
