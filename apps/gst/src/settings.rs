//! The properties of the element, and the effect that they ask for.

use std::path::{Path, PathBuf};

use aquafuse::Fuser;
use aquafuse::depth::{DepthKind, RelativeScale};
use aquafuse::fuser;
use aquafuse::fusion::{Gain, Incidence, Model, OptionError, Options};
use aquafuse::levels::LevelsOptions;
use aquafuse::stream::{EnhanceStream, RestoreStream, Steady, Stream};
use aquafuse::waterbody::Estimate;
use aquafuse::waterbody::presets::{Conditions, Preset};
use aquafuse_data::files::FileError;
use aquafuse_data::image_file::ImageFile;
use aquafuse_data::pipeline::{DepthSource, PixelEncoding, WaterEstimate, analyse_in};
use aquafuse_data::water_file::{WaterFile, WaterFileError, has_suffix};
use gst::glib;

use crate::effect::{Effect, Fusion};

/// What is done to frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, glib::Enum)]
#[enum_type(name = "AquaFuseEffect")]
pub enum EffectKind {
    /// Their water is exchanged for another.
    #[default]
    #[enum_value(name = "Exchange the water for the one of `water`", nick = "fuse")]
    Fuse,
    /// Their water is removed.
    #[enum_value(name = "Remove the water and set levels", nick = "restore")]
    Restore,
    /// Their levels are set.
    #[enum_value(name = "Set levels alone, at less cost", nick = "enhance")]
    Enhance,
    /// Nothing.
    #[enum_value(name = "Leave frames alone, without a copy", nick = "none")]
    None,
}

/// [`Model`], as a property.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, glib::Enum)]
#[enum_type(name = "AquaFuseModel")]
pub enum ModelKind {
    /// [`Model::Physical`].
    #[default]
    #[enum_value(name = "The whole veil: open water gets the other colour", nick = "physical")]
    Physical,
    /// [`Model::Aquafuse`].
    #[enum_value(name = "The equations of the paper to the letter: subtle", nick = "aquafuse")]
    Aquafuse,
    /// [`Model::Relight`].
    #[enum_value(name = "The whole veil, and the light on near things", nick = "relight")]
    Relight,
    /// [`Model::Exchange`].
    #[enum_value(name = "The whole water with its attenuation: strong and fragile", nick = "exchange")]
    Exchange,
}

impl From<ModelKind> for Model {
    fn from(kind: ModelKind) -> Self {
        match kind {
            ModelKind::Physical => Self::Physical,
            ModelKind::Aquafuse => Self::Aquafuse,
            ModelKind::Relight => Self::Relight,
            ModelKind::Exchange => Self::Exchange,
        }
    }
}

/// The properties of the element.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// What is done.
    pub effect: EffectKind,
    /// The reference water: an image, NAME.water.json, preset:NAME or sea:NUMBER.
    pub water: Option<String>,
    /// The water of the frames themselves, NAME.water.json, preset:NAME or sea:NUMBER, instead of estimates.
    pub content_water: Option<String>,
    /// How waters are exchanged.
    pub model: ModelKind,
    /// θ in degrees, 0 to 90; -1 is the model's own.
    pub theta: f32,
    /// α, 0 or more.
    pub alpha: f32,
    /// Whether the waters of the first frames are pooled and kept.
    pub one_water: bool,
    /// How much levels are set, 0 to 1.
    pub strength: f32,
    /// Water and levels are means over about so many frames.
    pub steady_over: u32,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            effect: EffectKind::Fuse,
            water: None,
            content_water: None,
            model: ModelKind::Physical,
            theta: -1.0,
            alpha: 1.0,
            one_water: false,
            strength: 1.0,
            steady_over: 8,
        }
    }
}

const _: () = assert!(Steady::FRAMES == 8, "the same default everywhere");

/// Why there is no effect by these settings. Its message names the cause, the file if there is one, and what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SettingsError {
    /// A fusion needs a reference.
    #[error(
        "no water is set; set the property water to an image, NAME.water.json, preset:NAME or sea:NUMBER, or effect to restore or enhance"
    )]
    NoWater,
    /// No such preset.
    #[error(
        "the property {property} is preset:{name}, but there is no such preset; the presets are {}",
        presets()
    )]
    Preset {
        /// The property.
        property: &'static str,
        /// The name given.
        name: String,
    },
    /// No such number.
    #[error("the property {property} is sea:{number}, which is no water; write sea:NUMBER, as sea:12")]
    Sea {
        /// The property.
        property: &'static str,
        /// What was given.
        number: String,
    },
    /// An image where a known water is needed.
    #[error(
        "the property content-water is {0}, which is no water file; run `aquafuse water extract IMAGE -o NAME.water.json` on a frame and set that file"
    )]
    ContentImage(String),
    /// Two properties that exclude each other.
    #[error("one-water estimates what content-water gives; leave one of them out")]
    TwoContentWaters,
    /// The water file cannot be used.
    #[error(transparent)]
    Water(#[from] WaterFileError),
    /// The image cannot be read.
    #[error(transparent)]
    Image(#[from] FileError),
    /// A coefficient does not fit into another unit of depth.
    #[error(
        "the water {water} cannot be used with depth from colour: {cause}; extract it again from an image"
    )]
    Unit {
        /// The water.
        water: String,
        /// What is wrong.
        cause: String,
    },
    /// A number is out of range.
    #[error("{0}; set theta and alpha within their ranges (`gst-inspect-1.0 aquafuse`)")]
    Option(#[from] OptionError),
}

fn presets() -> String {
    Preset::ALL.iter().map(|preset| preset.name()).collect::<Vec<_>>().join(", ")
}

/// Waters that were read, so that another property changes without reading them again.
#[derive(Debug, Default)]
pub struct Waters {
    reference: Option<(String, Estimate)>,
    content: Option<(String, Estimate)>,
}

impl Waters {
    /// Forgets the waters, whose files may have changed.
    pub fn forget(&mut self) {
        *self = Self::default();
    }
}

impl Settings {
    /// The effect by these settings.
    ///
    /// # Errors
    ///
    /// [`SettingsError`] where a water is missing, cannot be read or does not fit.
    pub fn effect(&self, waters: &mut Waters) -> Result<Effect, SettingsError> {
        let (levels, frames) = (LevelsOptions::default().with_strength(self.strength), self.frames());
        Ok(match self.effect {
            EffectKind::None => Effect::None,
            EffectKind::Restore => {
                Effect::Restore(Box::new(RestoreStream::default().levels(levels).steady_over(frames)))
            }
            EffectKind::Enhance => {
                Effect::Enhance(Box::new(EnhanceStream::default().levels(levels).steady_over(frames)))
            }
            EffectKind::Fuse => Effect::Fuse(Box::new(self.fusion(waters)?)),
        })
    }

    fn frames(&self) -> usize {
        usize::try_from(self.steady_over).unwrap_or(usize::MAX)
    }

    fn fusion(&self, waters: &mut Waters) -> Result<Fusion, SettingsError> {
        let said = self.water.as_deref().ok_or(SettingsError::NoWater)?;
        if self.one_water && self.content_water.is_some() {
            return Err(SettingsError::TwoContentWaters);
        }
        let defaults = Options::for_model(self.model.into());
        let theta = match self.theta {
            theta if theta < 0.0 => defaults.incidence,
            theta => Incidence::from_degrees(theta)?,
        };
        let options = defaults.with_incidence(theta).with_gain(Gain::new(self.alpha)?);
        let reference = kept(&mut waters.reference, said, || reference(said))?;
        let fuser = Fuser::from_estimate(reference, fuser::Options::default().with_fusion(options));
        let mut stream = Stream::new(fuser).steady_over(self.frames());
        if let Some(said) = &self.content_water {
            let content = kept(&mut waters.content, said, || {
                known("content-water", said)?
                    .ok_or_else(|| SettingsError::ContentImage(said.clone()))
                    .and_then(|file| relative(said, &file))
            })?;
            stream = stream.content_water(content);
        }
        Ok(Fusion::new(stream, self.one_water))
    }
}

/// The water of this name, read unless it was before.
fn kept(
    place: &mut Option<(String, Estimate)>,
    said: &str,
    read: impl FnOnce() -> Result<Estimate, SettingsError>,
) -> Result<Estimate, SettingsError> {
    match place {
        Some((name, water)) if name == said => Ok(*water),
        _ => {
            let water = read()?;
            *place = Some((said.to_owned(), water));
            Ok(water)
        }
    }
}

fn reference(said: &str) -> Result<Estimate, SettingsError> {
    if let Some(file) = known("water", said)? {
        return relative(said, &file);
    }
    let image = ImageFile::read(Path::new(said))?;
    let found = analyse_in(PixelEncoding::Encoded, &image, &DepthSource::default())?;
    let file =
        WaterFile { from: vec![said.to_owned()], depth_kind: found.depth.kind(), estimate: found.estimate };
    relative(said, &file)
}

/// A water that is not an image's.
fn known(property: &'static str, said: &str) -> Result<Option<WaterFile>, SettingsError> {
    if let Some(number) = said.strip_prefix("sea:") {
        let number =
            number.parse().map_err(|_| SettingsError::Sea { property, number: number.to_owned() })?;
        return Ok(Some(WaterFile::sea(number, PixelEncoding::Encoded)));
    }
    if let Some(name) = said.strip_prefix("preset:") {
        let preset: Preset =
            name.parse().map_err(|_| SettingsError::Preset { property, name: name.to_owned() })?;
        return Ok(Some(WaterFile {
            from: vec![said.to_owned()],
            depth_kind: DepthKind::Metres,
            estimate: WaterEstimate::preset(preset, &Conditions::default(), PixelEncoding::Encoded),
        }));
    }
    let path = PathBuf::from(said);
    if has_suffix(&path) { Ok(Some(WaterFile::read(&path, PixelEncoding::Encoded)?)) } else { Ok(None) }
}

/// The water per unit of depth from colour.
fn relative(said: &str, file: &WaterFile) -> Result<Estimate, SettingsError> {
    let unit = |cause: String| SettingsError::Unit { water: said.to_owned(), cause };
    match file.per(DepthKind::Relative, RelativeScale::default()) {
        Ok(WaterEstimate::Encoded(water)) => Ok(water),
        Ok(WaterEstimate::Linear(_)) => Err(unit("its numbers are of linear light".into())),
        Err(error) => Err(unit(error.to_string())),
    }
}
