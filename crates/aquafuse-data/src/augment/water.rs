//! The waters that images are put into.

use std::path::Path;

use aquafuse::depth::{DepthKind, RelativeScale};
use aquafuse::waterbody::AttenuationError;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use serde_json::value::{RawValue, to_raw_value};

use crate::pipeline::PixelEncoding;
use crate::water_file::{SUFFIX, WaterFile, WaterFileError};

/// A water to sample.
#[derive(Clone, Debug)]
pub struct Water {
    /// Its name: the path of an image or of a water file as it was given, or `preset:NAME`.
    pub name: String,
    /// The digest of its file; none for presets.
    pub sha256: Option<String>,
    /// The water, per unit of the images' depth.
    pub file: WaterFile,
}

/// The sea: waters drawn by number, each for one variant ([`sea`](aquafuse::waterbody::presets::sea)).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sea {
    /// The kind of the images' depth.
    pub depth_kind: DepthKind,
    /// What relative depth is in metres.
    pub scale: RelativeScale,
    /// How far one sees in each, in metres; `None`: as its type says.
    pub visibility: Option<f32>,
}

impl Sea {
    /// What names of files call its waters.
    pub(super) const SLUG: &'static str = "sea";

    /// The water of a number, per unit of the images' depth.
    ///
    /// # Errors
    ///
    /// [`AttenuationError`] when a coefficient does not fit into a number.
    pub fn water(&self, number: u32, encoding: PixelEncoding) -> Result<Water, AttenuationError> {
        let file = WaterFile::sea(number, encoding);
        let estimate = file.seen(self.depth_kind, self.scale, self.visibility)?;
        let file = WaterFile { depth_kind: self.depth_kind, estimate, ..file };
        Ok(Water { name: Self::name(number), sha256: None, file })
    }

    /// What the water of a number is called.
    pub(super) fn name(number: u32) -> String {
        format!("sea:{number}")
    }
}

/// What is done if the estimate of an image's own water, or of a water to sample, is doubtful or failed.
#[derive(Clone, Debug)]
pub enum OnDoubtful {
    /// It is used; the manifest says so.
    Flag,
    /// The image has no variants, the water is not drawn.
    Skip,
    /// This water is taken instead of the doubtful one.
    Instead(Box<Water>),
}

impl Water {
    /// The name as part of a file's name: the last part without extension, letters that file systems dislike exchanged.
    pub fn slug(&self) -> String {
        let name = self.name.strip_prefix("preset:").unwrap_or(&self.name);
        let last = name.rsplit(['/', '\\']).next().unwrap_or(name);
        let stem = match last.strip_suffix(SUFFIX) {
            Some(stem) => stem,
            None if name.len() < self.name.len() => last,
            None => last.rsplit_once('.').map_or(last, |(stem, _)| stem),
        };
        let plain =
            |letter: char| if letter.is_alphanumeric() || "-_.".contains(letter) { letter } else { '-' };
        stem.chars().map(plain).collect()
    }

    pub(super) fn stored(&self) -> StoredWater {
        let text = self.file.to_text();
        StoredWater {
            name: self.name.clone(),
            sha256: self.sha256.clone(),
            water: raw(&serde_json::from_str::<Value>(&text).expect("a water is written as JSON")),
        }
    }
}

/// A water in a manifest.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct StoredWater {
    pub(super) name: String,
    pub(super) sha256: Option<String>,
    /// As it stands: as a value it would take several hundred times its length, whatever it says.
    water: Box<RawValue>,
}

impl PartialEq for StoredWater {
    fn eq(&self, other: &Self) -> bool {
        (&self.name, &self.sha256, self.water.get()) == (&other.name, &other.sha256, other.water.get())
    }
}

/// Far more bytes than the numbers of a water have.
const MAX_BYTES: usize = 1 << 14;

/// A value as it is written.
fn raw(value: &Value) -> Box<RawValue> {
    to_raw_value(value).expect("a value is JSON")
}

impl StoredWater {
    /// The same, its numbers as a text if they are more than those of any water.
    pub(super) fn bounded(&self) -> Self {
        match self.water.get() {
            text if text.len() > MAX_BYTES => Self { water: raw(&text.into()), ..self.clone() },
            _ => self.clone(),
        }
    }

    /// The water; errors call it by the manifest.
    pub(super) fn restored(&self, manifest: &Path, encoding: PixelEncoding) -> Result<Water, WaterFileError> {
        let file = WaterFile::from_text(manifest, self.water.get(), encoding)?;
        Ok(Water { name: self.name.clone(), sha256: self.sha256.clone(), file })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use aquafuse::depth::DepthKind;
    use aquafuse::truth::waters;
    use aquafuse::waterbody::Estimate;

    #[test]
    fn names_become_parts_of_names_of_files() {
        let estimate = Estimate::given(waters()[0].water).into();
        let file = WaterFile { from: Vec::new(), depth_kind: DepthKind::Relative, estimate };
        let water = |name: &str| Water { name: name.into(), sha256: None, file: file.clone() };
        for (name, slug) in [
            ("preset:jerlov-3C", "jerlov-3C"),
            ("waters/deep green.jpg", "deep-green"),
            ("a/b.c.water.json", "b.c"),
            ("x.tar.png", "x.tar"),
        ] {
            assert_eq!(water(name).slug(), slug);
        }
    }

    #[test]
    fn a_manifest_gives_back_the_water_to_the_bit() {
        for known in waters() {
            let file = WaterFile {
                from: vec!["a".into()],
                depth_kind: DepthKind::Relative,
                estimate: Estimate::given(known.water).into(),
            };
            let water = Water { name: "a.png".into(), sha256: None, file };
            let text = serde_json::to_string(&water.stored()).unwrap();
            let stored: StoredWater = serde_json::from_str(&text).unwrap();
            let again = stored.restored("m.jsonl".as_ref(), PixelEncoding::Encoded).unwrap();
            assert_eq!(again.file, water.file);
        }
    }
}
