//! Waters as files, `*.water.json`, estimated from one or several images.

use std::io::Read;
use std::path::{Path, PathBuf};

use aquafuse::depth::{DepthKind, DepthModel, RelativeScale};
use aquafuse::image::{Encoded, Encoding, Linear};
use aquafuse::waterbody::{
    Attenuation, AttenuationError, Estimate, Intervals, Quality, Reason, VeilingLight, VeilingLightSource,
    Waterbody,
};
use serde::{Deserialize, Serialize};

use crate::files::{FileError, display, one_line, write_atomically};
use crate::image_file::open_file;
use crate::pipeline::{PixelEncoding, Space, WaterEstimate, with_estimate};
use aquafuse::waterbody::presets::sea;

/// The end of the name of every such file.
pub const SUFFIX: &str = ".water.json";
/// The version of the file; it changes when a field changes its meaning or goes.
const SCHEMA: u32 = 1;
/// Far more than a water takes; what is longer is none.
const MOST_BYTES: u64 = 1 << 20;

/// A waterbody as plain numbers, as in JSON.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Numbers {
    /// B∞ of red, green and blue.
    pub veiling_light: [f32; 3],
    /// β_B, per unit of z.
    pub backscatter_coefficient: [f32; 3],
    /// μ5 to μ8 of β_D, per unit of z.
    pub attenuation: [[f32; 4]; 3],
    /// The distances beyond which β_D is constant.
    pub attenuation_held_beyond: [f32; 3],
}

impl<E: Encoding> From<&Waterbody<E>> for Numbers {
    fn from(water: &Waterbody<E>) -> Self {
        Self {
            veiling_light: water.veiling_light.rgb(),
            backscatter_coefficient: water.backscatter_coefficient,
            attenuation: water.attenuation.map(|curve| curve.mu()),
            attenuation_held_beyond: water.attenuation.map(|curve| curve.held_beyond()),
        }
    }
}

impl From<&WaterEstimate> for Numbers {
    fn from(estimate: &WaterEstimate) -> Self {
        with_estimate!(estimate, estimate => Self::from(&estimate.water))
    }
}

impl Numbers {
    /// The waterbody with these numbers, or a sentence about the invalid number.
    fn water<E: Encoding>(&self) -> Result<Waterbody<E>, String> {
        if !self.veiling_light.iter().all(|value| (0.0..=1.0).contains(value)) {
            return Err(format!("veiling_light is {:?}, but must be from 0 to 1", self.veiling_light));
        }
        let beta = self.backscatter_coefficient;
        if !beta.iter().all(|beta| beta.is_finite() && *beta >= 0.0) {
            return Err(format!("backscatter_coefficient is {beta:?}, but must be 0 or more"));
        }
        let ([r, g, b], [far_r, far_g, far_b]) = (self.attenuation, self.attenuation_held_beyond);
        let curves = || -> Result<[Attenuation; 3], AttenuationError> {
            Ok([Attenuation::new(r, far_r)?, Attenuation::new(g, far_g)?, Attenuation::new(b, far_b)?])
        };
        Ok(Waterbody {
            veiling_light: VeilingLight::new(self.veiling_light),
            backscatter_coefficient: beta,
            attenuation: curves().map_err(|error| format!("attenuation: {error}"))?,
        })
    }
}

/// A water with its sources.
#[derive(Clone, Debug, PartialEq)]
pub struct WaterFile {
    /// Its sources: images by their names, or a preset.
    pub from: Vec<String>,
    /// The unit of z.
    pub depth_kind: DepthKind,
    /// The water, with its intervals and verdict.
    pub estimate: WaterEstimate,
}

/// A water file could not be read. Its message names the file, the cause and what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WaterFileError {
    /// The file cannot be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// It is no water, or a number is missing or impossible.
    #[error(
        "{} is no water: {cause}. To make one, run `aquafuse water extract IMAGE -o {}`",
        display(path),
        display(path)
    )]
    Format {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        cause: String,
    },
    /// It was written for another version of this program.
    #[error(
        "{} has schema {found}, but this version reads schema {SCHEMA}. Extract the water again with this version",
        display(path)
    )]
    Schema {
        /// The file.
        path: PathBuf,
        /// Its schema.
        found: u32,
    },
    /// Its numbers are of another encoding.
    #[error(
        "{} holds a water of {found} values, and {wanted} ones are worked on here: {}, or extract it again for these",
        display(path), if *found == PixelEncoding::Linear { "add --linear" } else { "leave --linear out" }
    )]
    Encoding {
        /// The file.
        path: PathBuf,
        /// Its encoding.
        found: PixelEncoding,
        /// The encoding asked for.
        wanted: PixelEncoding,
    },
}

/// The file as it stands.
#[derive(Serialize, Deserialize)]
struct Stored {
    schema: u32,
    from: Vec<String>,
    encoding: StoredEncoding,
    depth: StoredDepth,
    waterbody: Numbers,
    intervals: Intervals,
    veiling_light_source: VeilingLightSource,
    veiling_light_share: f32,
    /// The colour of near things; files of before have none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    near_colour: Option<[f32; 3]>,
    quality: StoredQuality,
}

#[derive(Clone, Copy, Serialize, Deserialize, PartialEq)]
#[serde(rename_all = "lowercase")]
enum StoredEncoding {
    Encoded,
    Linear,
}

impl From<PixelEncoding> for StoredEncoding {
    fn from(encoding: PixelEncoding) -> Self {
        match encoding {
            PixelEncoding::Encoded => Self::Encoded,
            PixelEncoding::Linear => Self::Linear,
        }
    }
}

#[derive(Serialize, Deserialize)]
struct StoredDepth {
    kind: StoredKind,
    /// The depth model, by name; `None` for supplied depth.
    model: Option<String>,
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum StoredKind {
    Relative,
    Metres,
}

#[derive(Serialize, Deserialize)]
struct StoredQuality {
    verdict: String,
    reasons: Vec<Reason>,
}

/// Read before the rest: a later schema may have other fields.
#[derive(Deserialize)]
struct Version {
    schema: u32,
}

impl WaterFile {
    /// Reads a water.
    ///
    /// # Errors
    ///
    /// [`WaterFileError`] when the file cannot be read, is of another format, schema or encoding, or holds numbers
    /// that no water has.
    pub fn read(path: &Path, encoding: PixelEncoding) -> Result<Self, WaterFileError> {
        let failed = |error| FileError::Read { path: path.to_owned(), error };
        let (file, _) = open_file(path)?;
        let mut text = String::new();
        file.take(MOST_BYTES).read_to_string(&mut text).map_err(failed)?;
        Self::from_text(path, &text, encoding)
    }

    /// Reads a water that is in memory already; errors call it `path`.
    ///
    /// # Errors
    ///
    /// [`WaterFileError`] when it is of another format, schema or encoding, or holds numbers that no water has.
    pub fn from_text(path: &Path, text: &str, encoding: PixelEncoding) -> Result<Self, WaterFileError> {
        match encoding {
            PixelEncoding::Encoded => Self::parse::<Encoded>(path, text, encoding),
            PixelEncoding::Linear => Self::parse::<Linear>(path, text, encoding),
        }
    }

    fn parse<E: Space>(path: &Path, text: &str, wanted: PixelEncoding) -> Result<Self, WaterFileError> {
        let wrong = |cause: String| WaterFileError::Format { path: path.to_owned(), cause };
        let json = |error: serde_json::Error| wrong(one_line(&error.to_string()));
        let Version { schema } = serde_json::from_str(text).map_err(json)?;
        if schema != SCHEMA {
            return Err(WaterFileError::Schema { path: path.to_owned(), found: schema });
        }
        let stored: Stored = serde_json::from_str(text).map_err(json)?;
        let found = match stored.encoding {
            StoredEncoding::Encoded => PixelEncoding::Encoded,
            StoredEncoding::Linear => PixelEncoding::Linear,
        };
        if found != wanted {
            return Err(WaterFileError::Encoding { path: path.to_owned(), found, wanted });
        }
        let water = stored.waterbody.water().map_err(wrong)?;
        if !(0.0..=1.0).contains(&stored.veiling_light_share) {
            return Err(wrong("veiling_light_share must be from 0 to 1".into()));
        }
        if !stored.near_colour.iter().flatten().all(|value| *value > 0.0 && *value <= 1.0) {
            return Err(wrong("near_colour must be above 0, and at most 1".into()));
        }
        let model = |name: String| {
            name.parse::<DepthModel>()
                .ok()
                .ok_or_else(|| wrong(format!("there is no depth model {}", one_line(&name))))
        };
        let reasons = stored.quality.reasons.into_iter();
        let mut estimate: Estimate<E> = Estimate::given(water);
        estimate.veiling_light_source = stored.veiling_light_source;
        estimate.veiling_light_share = stored.veiling_light_share;
        estimate.depth_model = stored.depth.model.map(model).transpose()?;
        estimate.near_colour = stored.near_colour;
        estimate.intervals = stored.intervals;
        // The verdict follows from the reasons.
        estimate.quality = reasons.fold(Quality::default(), Quality::with);
        let depth_kind = match stored.depth.kind {
            StoredKind::Relative => DepthKind::Relative,
            StoredKind::Metres => DepthKind::Metres,
        };
        Ok(Self { from: stored.from, depth_kind, estimate: E::wrap(estimate) })
    }

    /// The file as text.
    pub fn to_text(&self) -> String {
        // Depth factors belong to the depth of one image; of a reference nothing asks for them.
        let (veiling_light_source, veiling_light_share) = self.estimate.veiling_light_source();
        let quality = self.estimate.quality();
        let stored = Stored {
            schema: SCHEMA,
            from: self.from.clone(),
            encoding: self.estimate.encoding().into(),
            depth: StoredDepth {
                kind: match self.depth_kind {
                    DepthKind::Metres => StoredKind::Metres,
                    _ => StoredKind::Relative,
                },
                model: self.estimate.depth_model().map(|model| model.name().to_owned()),
            },
            waterbody: Numbers::from(&self.estimate),
            intervals: self.estimate.intervals(),
            veiling_light_source,
            veiling_light_share,
            near_colour: self.estimate.near_colour(),
            quality: StoredQuality {
                verdict: quality.verdict.name().to_owned(),
                reasons: quality.reasons.iter().collect(),
            },
        };
        let text = serde_json::to_string_pretty(&stored).expect("numbers and names are JSON");
        text + "\n"
    }

    /// The water per unit of another kind of depth.
    ///
    /// # Errors
    ///
    /// [`AttenuationError`] when a coefficient does not fit into a number.
    pub fn per(&self, kind: DepthKind, scale: RelativeScale) -> Result<WaterEstimate, AttenuationError> {
        self.estimate.per(self.depth_kind, kind, scale)
    }

    /// [`per`](Self::per), with another visibility in metres if one is given: at that distance 2 % of a contrast are left.
    ///
    /// # Errors
    ///
    /// [`AttenuationError`] when it has no visibility, or a coefficient does not fit into a number.
    pub fn seen(
        &self,
        kind: DepthKind,
        scale: RelativeScale,
        visibility: Option<f32>,
    ) -> Result<WaterEstimate, AttenuationError> {
        let Some(metres) = visibility else { return self.per(kind, scale) };
        let metric = self.per(DepthKind::Metres, scale)?.with_visibility(metres)?;
        metric.per(DepthKind::Metres, kind, scale)
    }

    /// The water that the sea shows by this number, per metre ([`sea`]).
    pub fn sea(number: u32, encoding: PixelEncoding) -> Self {
        let (preset, conditions) = sea(number);
        Self {
            from: vec![format!("sea:{number}")],
            depth_kind: DepthKind::Metres,
            estimate: WaterEstimate::preset(preset, &conditions, encoding),
        }
    }

    /// Writes the water, whole or not at all.
    ///
    /// # Errors
    ///
    /// [`FileError`] when the name does not end in [`SUFFIX`], the file exists and may not be replaced, or the
    /// system refuses.
    pub fn write(&self, path: &Path, overwrite: bool) -> Result<(), FileError> {
        if !has_suffix(path) {
            return Err(FileError::UnknownExtension { path: path.to_owned(), expected: SUFFIX });
        }
        let text = self.to_text();
        write_atomically(path, overwrite, |out| out.write_all(text.as_bytes()))
    }
}

/// Whether a name is that of a water file.
pub fn has_suffix(path: &Path) -> bool {
    path.as_os_str().as_encoded_bytes().ends_with(SUFFIX.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;
    use aquafuse::truth::waters;

    fn good() -> WaterFile {
        let mut estimate: Estimate = Estimate::given(waters()[0].water);
        estimate.quality = Quality::default().with(Reason::FewDarkPixels);
        estimate.depth_model = Some(DepthModel::Ratio);
        estimate.near_colour = Some([0.25, 0.5, 0.75]);
        WaterFile {
            from: vec!["reef.jpg".into()],
            depth_kind: DepthKind::Relative,
            estimate: estimate.into(),
        }
    }

    #[test]
    fn what_is_written_is_read_again() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("reef.water.json");
        good().write(&path, false).unwrap();
        assert_eq!(WaterFile::read(&path, PixelEncoding::Encoded).unwrap(), good());
        assert!(matches!(good().write(&path, false), Err(FileError::Exists { .. })));
        let named_otherwise = folder.path().join("reef.json");
        assert!(matches!(good().write(&named_otherwise, false), Err(FileError::UnknownExtension { .. })));
    }

    #[test]
    fn a_file_that_is_no_water_is_refused_by_cause() {
        let text = good().to_text();
        let held_beyond = "\"attenuation_held_beyond\": [\n      ";
        assert!(text.contains(held_beyond));
        let cases = [
            ("not json".to_owned(), "is no water"),
            ("{}".to_owned(), "missing field `schema`"),
            (text.replace("\"schema\": 1", "\"schema\": 7"), "has schema 7"),
            (text.replace("\"encoded\"", "\"linear\""), "add --linear"),
            (text.replace("\"few_dark_pixels\"", "\"bad_mood\""), "unknown variant `bad_mood`"),
            (text.replace("0.75", "1.75"), "near_colour must be above 0"),
            (text.replace("\"ratio\"", "\"rat\""), "no depth model rat"),
            (text.replace(held_beyond, "\"attenuation_held_beyond\": [\n      -5"), "attenuation: "),
            (
                text.replace("\"veiling_light\": [\n      0", "\"veiling_light\": [\n      7"),
                "must be from 0 to 1",
            ),
        ];
        for (text, expected) in cases {
            let said = WaterFile::from_text("w.water.json".as_ref(), &text, PixelEncoding::Encoded)
                .unwrap_err()
                .to_string();
            assert!(said.contains(expected) && said.contains("w.water.json"), "{said}");
        }
        let said = WaterFile::from_text("w.water.json".as_ref(), &text, PixelEncoding::Linear)
            .unwrap_err()
            .to_string();
        assert!(said.contains("leave --linear out"), "{said}");
    }
}
