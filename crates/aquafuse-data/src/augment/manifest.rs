//! `manifest.jsonl`: what was made from what, and how; one JSON object a line.
//!
//! While a run goes on, lines come in the order in which pictures get done, and a line without its end was being
//! written when the process was killed. A run that ends writes the file anew: sorted, with the files about all pictures,
//! and a last line that holds the digest of all before it. Two runs that did the same have the same manifest.

use std::collections::BTreeMap;
use std::iter;
use std::path::Path;

use aquafuse::waterbody::Reason;
use serde::{Deserialize, Serialize};

use super::AugmentError;
use super::water::StoredWater;
use crate::digest::sha256;
use crate::picture::FileError;

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
    pub(super) theta_range: (f32, f32),
    pub(super) alpha_range: (f32, f32),
    pub(super) model: String,
    pub(super) most_gain: f32,
    pub(super) smooth: String,
    pub(super) depth: StoredDepth,
    pub(super) on_doubtful: String,
    pub(super) on_bad_annotation: String,
    pub(super) keep_originals: bool,
    pub(super) quality: u8,
    pub(super) lenient: bool,
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
    pub(super) theta: f32,
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
    /// The bytes before the files about all pictures.
    pub(super) body: usize,
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

    /// What it says, as lines in their order.
    pub(super) fn lines(self, key: &str) -> Vec<Line> {
        let Self { original, container, variants, skipped, failed } = self;
        let mut lines: Vec<Line> = original.map(Line::Original).into_iter().collect();
        lines.extend(container.map(Line::Container));
        lines.extend(variants.into_values().map(Line::Variant));
        lines.extend(skipped.map(|why| Line::Skipped { key: key.to_owned(), why }));
        lines.extend(failed.map(|error| Line::Failed { key: key.to_owned(), error }));
        lines
    }
}

/// The text of a whole manifest.
pub(super) fn sealed_text(
    header: &Header,
    entries: BTreeMap<String, Entry>,
    indices: Vec<Written>,
) -> String {
    let mut text = Line::Job(Box::new(header.clone())).text();
    for (key, entry) in entries {
        text.extend(entry.lines(&key).iter().map(Line::text));
    }
    text.extend(indices.into_iter().map(|written| Line::Index(written).text()));
    let end = Line::End { sha256: sha256(text.as_bytes()) };
    text + &end.text()
}

impl Manifest {
    /// Reads a manifest; a last line without its end is left out.
    pub(super) fn read(path: &Path) -> Result<Self, AugmentError> {
        let bytes = std::fs::read(path).map_err(|error| FileError::Read { path: path.to_owned(), error })?;
        parse(&bytes).map_err(|line| AugmentError::Manifest { path: path.to_owned(), line })
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

/// Reads a manifest; the number of the line that is none otherwise.
pub(super) fn parse(bytes: &[u8]) -> Result<Manifest, usize> {
    let (mut header, mut entries, mut indices, mut sealed) = (None, BTreeMap::new(), Vec::new(), None);
    let (mut before, mut body) = (0_usize, 0);
    for (text, number) in bytes.split_inclusive(|&byte| byte == b'\n').zip(1..) {
        if !text.ends_with(b"\n") {
            break;
        }
        let line: Line = serde_json::from_slice(text).map_err(|_| number)?;
        // Nothing stands before the first line or behind the last.
        if header.is_none() != matches!(line, Line::Job(_)) || sealed.is_some() {
            return Err(number);
        }
        match line {
            Line::Job(found) if found.schema == SCHEMA => header = Some(*found),
            Line::Job(_) => return Err(number),
            Line::Original(original) => {
                let entry: &mut Entry = entries.entry(original.key.clone()).or_default();
                entry.original = Some(original);
            }
            Line::Container(container) => {
                let entry = entries.entry(container.key.clone()).or_default();
                entry.container = Some(container);
            }
            Line::Variant(variant) => {
                let entry = entries.entry(variant.key.clone()).or_default();
                entry.variants.insert(variant.number, variant);
            }
            Line::Skipped { key, why } => entries.entry(key).or_default().skipped = Some(why),
            Line::Failed { key, error } => entries.entry(key).or_default().failed = Some(error),
            Line::Index(written) => indices.push(written),
            Line::End { sha256: told } => {
                sealed = Some(bytes.get(..before).is_some_and(|all| sha256(all) == told));
            }
        }
        before = before.saturating_add(text.len());
        if indices.is_empty() && sealed.is_none() {
            body = before;
        }
    }
    let header = header.ok_or(1_usize)?;
    Ok(Manifest { header, entries, indices, sealed, body })
}
