//! The first line of a manifest: what decides what is made.

use aquafuse::scene_area::Border;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize};

use super::water::StoredWater;

/// It changes when a field changes its meaning or goes.
pub(super) const SCHEMA: u32 = 1;

/// The first line: everything but the dataset itself that decides what is made.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Header {
    pub(super) schema: u32,
    pub(super) version: String,
    /// The dataset, as it was named.
    pub(super) dataset: String,
    pub(super) layout: String,
    pub(super) encoding: String,
    pub(super) settings: Settings,
    pub(super) waters: Vec<StoredWater>,
    /// What is taken instead of doubtful waters.
    pub(super) instead: Option<StoredWater>,
}

/// The settings in a manifest.
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
    /// Manifests of earlier versions have none: every pixel was taken for scene.
    #[serde(default = "no_border")]
    pub(super) border: String,
}

fn no_border() -> String {
    Border::None.to_string()
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

/// How depth is obtained.
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

    /// A copy with shortened waters, for messages about differences.
    pub(super) fn bounded(&self) -> Self {
        let waters = self.waters.iter().map(StoredWater::bounded).collect();
        Self { waters, instead: self.instead.as_ref().map(StoredWater::bounded), ..self.clone() }
    }

    /// Whether two runs make the same of the same images.
    pub(super) fn makes_as(&self, other: &Self) -> bool {
        Self { dataset: String::new(), ..self.clone() } == Self { dataset: String::new(), ..other.clone() }
    }
}
