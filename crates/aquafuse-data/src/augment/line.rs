//! The lines of a manifest.

use aquafuse::fusion::{Gain, Incidence};
use aquafuse::waterbody::Reason;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize};

use super::Draw;
use super::header::Header;

/// A file that was written.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Written {
    /// Its path within the output.
    pub(super) output: String,
    pub(super) bytes: u64,
    pub(super) sha256: String,
}

/// A file as a manifest lists it, be it by a line of its own or not.
#[derive(Clone, Copy, Debug)]
pub(super) struct Listed<'a> {
    /// Its path within the output.
    pub(super) output: &'a str,
    pub(super) bytes: u64,
    pub(super) sha256: &'a str,
}

/// Lines that list a file.
macro_rules! lists {
    ($($line:ty),*) => {
        $(impl $line {
            pub(super) fn listed(&self) -> Listed<'_> {
                Listed { output: &self.output, bytes: self.bytes, sha256: &self.sha256 }
            }
        })*
    };
}

lists!(Written, Variant, Original, Container);

/// An angle of incidence, in degrees.
fn angle<'de, D: Deserializer<'de>>(from: D) -> Result<f32, D::Error> {
    let degrees = f32::deserialize(from)?;
    Incidence::from_degrees(degrees).map(Incidence::degrees).map_err(D::Error::custom)
}

fn gain<'de, D: Deserializer<'de>>(from: D) -> Result<f32, D::Error> {
    let number = f32::deserialize(from)?;
    Gain::new(number).map(Gain::get).map_err(D::Error::custom)
}

fn is_zero(times: &u32) -> bool {
    *times == 0
}

/// A variant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Variant {
    pub(super) key: String,
    pub(super) number: u32,
    /// Which of the header's waters; none where it is one of the sea.
    pub(super) water: Option<usize>,
    /// The number of a water of the sea.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) sea: Option<u32>,
    #[serde(deserialize_with = "angle")]
    pub(super) theta: f32,
    #[serde(deserialize_with = "gain")]
    pub(super) alpha: f32,
    /// How often it was drawn again, because the scene was hidden or hardly changed.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub(super) redrawn: u32,
    pub(super) source: Source,
    /// What the image's own estimate is worth.
    pub(super) verdict: String,
    pub(super) reasons: Vec<Reason>,
    /// Share of the values that did not fit into the range.
    pub(super) clipped: f64,
    /// Share of the image's contrast that is left.
    pub(super) contrast_left: Option<f64>,
    /// How much it differs from its image, as ΔE; manifests of earlier versions have none.
    #[serde(default)]
    pub(super) change: Option<f64>,
    /// Whether the image's own water was exchanged for the one of the header.
    pub(super) instead: bool,
    /// Its path within the output.
    pub(super) output: String,
    pub(super) bytes: u64,
    pub(super) sha256: String,
    pub(super) companions: Vec<Written>,
}

impl Variant {
    /// What was drawn for it, where its header names so many waters; `None` where it names no water.
    pub(super) fn draw(&self, named: usize) -> Option<Draw> {
        let Self { theta, alpha, redrawn, .. } = *self;
        match (self.water, self.sea) {
            (Some(water), _) => (water < named).then_some(Draw { water, sea: 0, theta, alpha, redrawn }),
            (None, number) => number.map(|sea| Draw { water: named, sea, theta, alpha, redrawn }),
        }
    }
}

/// What an image was made from.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Source {
    pub(super) bytes: u64,
    pub(super) sha256: String,
    /// The digest of its depth map, where it has one.
    pub(super) depth_sha256: Option<String>,
}

/// An image that was carried over as it is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Original {
    pub(super) key: String,
    /// Its path within the output.
    pub(super) output: String,
    pub(super) bytes: u64,
    pub(super) sha256: String,
    pub(super) companions: Vec<Written>,
}

/// A file that holds several images with their variants.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Container {
    pub(super) key: String,
    pub(super) source: Source,
    /// Its path within the output.
    pub(super) output: String,
    pub(super) bytes: u64,
    pub(super) sha256: String,
    /// Its images that are copied beside their variants.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) originals: Vec<String>,
    /// Its variants; `output` is a path in it.
    pub(super) variants: Vec<Variant>,
    /// Its images that have no variants, and why.
    pub(super) skipped: Vec<(String, String)>,
    /// Those that failed, and why.
    pub(super) failed: Vec<(String, String)>,
}

/// A line.
#[derive(Clone, Debug, PartialEq, Serialize)]
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
    /// A file about all images.
    Index(Written),
    /// The digest of all lines before this one.
    End {
        sha256: String,
    },
}

/// The field that names the kind of a line.
#[derive(Deserialize)]
struct Tag {
    line: Kind,
}

#[derive(Deserialize)]
#[serde(rename_all = "lowercase")]
enum Kind {
    Job,
    Variant,
    Original,
    Container,
    Skipped,
    Failed,
    Index,
    End,
}

impl Line {
    /// Reads a line: its kind, and then what lines of that kind hold. A tag and flattened fields as serde reads them
    /// would keep everything else in the line, in several hundred times its length.
    pub(super) fn read(text: &[u8]) -> serde_json::Result<Self> {
        #[derive(Deserialize)]
        struct Skipped {
            key: String,
            why: String,
        }
        #[derive(Deserialize)]
        struct Failed {
            key: String,
            error: String,
        }
        #[derive(Deserialize)]
        struct End {
            sha256: String,
        }
        let of = serde_json::from_slice::<Tag>(text)?;
        Ok(match of.line {
            Kind::Job => Self::Job(serde_json::from_slice(text)?),
            Kind::Variant => Self::Variant(serde_json::from_slice(text)?),
            Kind::Original => Self::Original(serde_json::from_slice(text)?),
            Kind::Container => Self::Container(serde_json::from_slice(text)?),
            Kind::Index => Self::Index(serde_json::from_slice(text)?),
            Kind::Skipped => {
                let Skipped { key, why } = serde_json::from_slice(text)?;
                Self::Skipped { key, why }
            }
            Kind::Failed => {
                let Failed { key, error } = serde_json::from_slice(text)?;
                Self::Failed { key, error }
            }
            Kind::End => {
                let End { sha256 } = serde_json::from_slice(text)?;
                Self::End { sha256 }
            }
        })
    }

    /// The key of the image that it is about; none where it is about all.
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
