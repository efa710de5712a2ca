//! The first line of a manifest: what decides what is made.

use aquafuse::fusion::{Gain, Incidence};
use aquafuse::scene_area::Border;
use aquafuse::waterbody::WaterMap;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize};

use super::water::{Sea, StoredWater};
use crate::dataset::Splits;

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
    /// How waters of the sea are drawn, where some are.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) sea: Option<Sea>,
    /// What is taken instead of doubtful waters.
    pub(super) instead: Option<StoredWater>,
}

/// The settings in a manifest.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Settings {
    pub(super) seed: u64,
    pub(super) per_image: u32,
    pub(super) with_replacement: bool,
    #[serde(deserialize_with = "angles")]
    pub(super) theta_range: (f32, f32),
    #[serde(deserialize_with = "gains")]
    pub(super) alpha_range: (f32, f32),
    pub(super) model: String,
    #[serde(deserialize_with = "max_gain")]
    pub(super) most_gain: f32,
    pub(super) smooth: String,
    pub(super) depth: StoredDepth,
    pub(super) on_doubtful: String,
    pub(super) on_bad_annotation: String,
    pub(super) keep_originals: bool,
    /// Manifests of earlier versions have none: all originals were copied or none.
    #[serde(default, deserialize_with = "share")]
    pub(super) keep_share: f64,
    /// Manifests of earlier versions have none: every image was multiplied.
    #[serde(default = "all_splits")]
    pub(super) splits: String,
    #[serde(deserialize_with = "quality")]
    pub(super) quality: u8,
    pub(super) lenient: bool,
    /// Manifests of earlier versions have none: every pixel was taken for scene.
    #[serde(default = "no_border")]
    pub(super) border: String,
    /// Manifests of earlier versions have none: open water was found by rules.
    #[serde(default = "by_rules")]
    pub(super) water_map: String,
}

fn all_splits() -> String {
    Splits::All.to_string()
}

fn no_border() -> String {
    Border::None.to_string()
}

fn by_rules() -> String {
    WaterMap::Rules.to_string()
}

/// A limit of the gain, at least 1.
fn max_gain<'de, D: Deserializer<'de>>(from: D) -> Result<f32, D::Error> {
    let gain = f32::deserialize(from)?;
    let is_gain = gain.is_finite() && gain >= 1.0;
    is_gain.then_some(gain).ok_or_else(|| D::Error::custom("a gain is at least 1"))
}

/// A share of all, 0 to 1.
fn share<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    let share = f64::deserialize(from)?;
    (0.0..=1.0).contains(&share).then_some(share).ok_or_else(|| D::Error::custom("a share is from 0 to 1"))
}

/// A quality of JPEG.
fn quality<'de, D: Deserializer<'de>>(from: D) -> Result<u8, D::Error> {
    let quality = u8::deserialize(from)?;
    let is_quality = (1..=100).contains(&quality);
    is_quality.then_some(quality).ok_or_else(|| D::Error::custom("a quality is from 1 to 100"))
}

/// A range of angles, in degrees.
fn angles<'de, D: Deserializer<'de>>(from: D) -> Result<(f32, f32), D::Error> {
    let (low, high) = <(f32, f32)>::deserialize(from)?;
    let checked = Incidence::from_degrees(low).and(Incidence::from_degrees(high));
    in_order(checked.map_err(D::Error::custom).map(|_| (low, high))?)
}

/// A range of α.
fn gains<'de, D: Deserializer<'de>>(from: D) -> Result<(f32, f32), D::Error> {
    let (low, high) = <(f32, f32)>::deserialize(from)?;
    let checked = Gain::new(low).and(Gain::new(high));
    in_order(checked.map_err(D::Error::custom).map(|_| (low, high))?)
}

fn in_order<E: serde::de::Error>((low, high): (f32, f32)) -> Result<(f32, f32), E> {
    (low <= high).then_some((low, high)).ok_or_else(|| E::custom("a range ends before it begins"))
}

/// How depth is obtained.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum StoredDepth {
    /// From colour, by a model.
    Model(String),
    /// From colour by Eq. 3, with these coefficients.
    Eq3([f64; 5]),
    /// By a network from a file.
    Network { file: String, sha256: String, kind: String, side: Option<u32> },
    /// From a folder of maps.
    Maps {
        folder: String,
        kind: String,
        /// Whether maps are scaled to the size of their images; it is not said where they are not.
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        is_scaled: bool,
    },
}

impl Header {
    pub(super) fn new(
        dataset: String,
        layout: &str,
        encoding: &str,
        settings: Settings,
        waters: Vec<StoredWater>,
        sea: Option<Sea>,
        instead: Option<StoredWater>,
    ) -> Self {
        let version = env!("CARGO_PKG_VERSION").to_owned();
        let (layout, encoding) = (layout.to_owned(), encoding.to_owned());
        Self { schema: SCHEMA, version, dataset, layout, encoding, settings, waters, sea, instead }
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
