//! `WATER`: an image, a `*.water.json` file, `preset:NAME` or `sea:NUMBER`.

use std::path::{Path, PathBuf};

use anyhow::anyhow;
use aquafuse::depth::{DepthKind, RelativeScale};
use aquafuse::fusion::Model;
use aquafuse::waterbody::presets::{Conditions, Preset, White};
use aquafuse_data::augment::Sea;
use aquafuse_data::files::display;
use aquafuse_data::pipeline::{DepthEstimator, DepthSource, PixelEncoding, WaterEstimate, analyse_in};
use aquafuse_data::water_file::{WaterFile, has_suffix};
use clap::{Args, ValueEnum};

use crate::args::reading::Reading;
use crate::failure::Failure;

/// Where a water comes from.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum WaterSource {
    Image(PathBuf),
    File(PathBuf),
    Preset(Preset),
    /// A drawn water by its number.
    Sea(u32),
}

/// Conditions of presets, and the scale of relative depth.
#[derive(Args)]
pub(crate) struct WaterArguments {
    /// Depth of a preset's scene below the surface in metres, 0 to 100.
    #[arg(long, value_name = "METRES", default_value_t = 5.0, help_heading = "Presets and units")]
    below_surface: f64,
    /// White balance and exposure of the camera that a preset simulates.
    #[arg(long, value_name = "HOW", value_enum, default_value_t, help_heading = "Presets and units")]
    camera: Balance,
    /// Distance in metres of relative depth 1. Used if the water is per metre and depth is relative, or vice versa.
    #[arg(long, value_name = "METRES", default_value_t = RelativeScale::default().metres_at_one(), help_heading = "Presets and units")]
    metres_at_one: f32,
    /// How far one sees in WATER, in metres: at this distance 2 % of the contrast of a thing are left. Its colours stay. Only
    /// `exchange`, `simulate` and `scene` read it.
    #[arg(long, value_name = "METRES", value_parser = visibility, help_heading = "Presets and units")]
    visibility: Option<f32>,
}

fn visibility(text: &str) -> Result<f32, String> {
    let metres: f32 = text.parse().map_err(|_| "not a number")?;
    if (0.1..=1000.0).contains(&metres) { Ok(metres) } else { Err("give 0.1 to 1000 metres".into()) }
}

/// [`White`] on the command line.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
enum Balance {
    /// Balanced for daylight, exposed at depth: the water looks blue or green.
    #[default]
    Daylight,
    /// Balanced at depth: a white card looks white there.
    AtDepth,
    /// Balanced for daylight, exposed just below the surface: darker with depth.
    AtSurface,
}

impl WaterSource {
    /// Reads the argument of the command line.
    pub(crate) fn parse(said: &Path) -> Result<Self, Failure> {
        if let Some(number) = said.to_str().and_then(|text| text.strip_prefix("sea:")) {
            return number.parse().map(Self::Sea).map_err(|_| {
                Failure::usage(anyhow!("sea:{number} is no water; write sea:NUMBER, as sea:12"))
            });
        }
        let Some(name) = said.to_str().and_then(|text| text.strip_prefix("preset:")) else {
            let named = said.to_str().and_then(|name| name.parse::<Preset>().ok()).filter(|_| !said.exists());
            if let Some(preset) = named {
                let name = preset.name();
                return Err(Failure::usage(anyhow!("there is no file {name}; did you mean preset:{name}?")));
            }
            let path = said.to_owned();
            return Ok(if has_suffix(said) { Self::File(path) } else { Self::Image(path) });
        };
        name.parse().map(Self::Preset).map_err(|_| {
            let names = Preset::ALL.iter().map(|one| one.name()).collect::<Vec<_>>().join(", ");
            Failure::usage(anyhow!(
                "there is no preset {name:?}; the presets are {names} (`aquafuse water list`)"
            ))
        })
    }

    /// The file it is read from.
    pub(crate) fn path(&self) -> Option<&Path> {
        match self {
            Self::Image(path) | Self::File(path) => Some(path),
            Self::Preset(_) | Self::Sea(_) => None,
        }
    }

    /// Its name in messages.
    pub(crate) fn name(&self) -> String {
        match self {
            Self::Image(path) | Self::File(path) => display(path).to_string(),
            Self::Preset(preset) => format!("preset:{}", preset.name()),
            Self::Sea(number) => format!("sea:{number}"),
        }
    }
}

impl WaterArguments {
    /// Depth of a preset's scene below the surface, in metres.
    pub(crate) fn below_surface(&self) -> f64 {
        self.below_surface
    }

    /// How the camera is balanced, in words.
    pub(crate) fn white(&self) -> &'static str {
        match self.camera {
            Balance::Daylight => "balanced for daylight and exposed at depth",
            Balance::AtDepth => "balanced at depth",
            Balance::AtSurface => "balanced for daylight and exposed just below the surface",
        }
    }

    /// The conditions that a preset is derived for.
    pub(crate) fn conditions(&self) -> Result<Conditions, Failure> {
        let white = match self.camera {
            Balance::Daylight => White::Daylight,
            Balance::AtDepth => White::AtDepth,
            Balance::AtSurface => White::AtSurface,
        };
        let conditions = Conditions::default().with_white(white);
        conditions.with_depth_below_surface(self.below_surface).map_err(Failure::usage)
    }

    /// The water as it is, and what one unit of its z is.
    pub(crate) fn read(
        &self,
        source: &WaterSource,
        model: &DepthEstimator,
        encoding: PixelEncoding,
        reading: &Reading,
    ) -> Result<WaterFile, Failure> {
        self.read_by(source, &DepthSource::Estimated(model.clone()), encoding, reading)
    }

    /// [`read`](Self::read), with the depth of an image from `depth`.
    pub(crate) fn read_by(
        &self,
        source: &WaterSource,
        depth: &DepthSource,
        encoding: PixelEncoding,
        reading: &Reading,
    ) -> Result<WaterFile, Failure> {
        match source {
            WaterSource::File(path) => Ok(WaterFile::read(path, encoding)?),
            WaterSource::Preset(preset) => Ok(WaterFile {
                from: vec![source.name()],
                depth_kind: DepthKind::Metres,
                estimate: WaterEstimate::preset(*preset, &self.conditions()?, encoding),
            }),
            WaterSource::Sea(number) => Ok(WaterFile::sea(*number, encoding)),
            WaterSource::Image(path) => {
                let found = analyse_in(encoding, &reading.of_reference().read(path)?, depth)?;
                Ok(WaterFile {
                    from: vec![display(path).to_string()],
                    depth_kind: found.depth.kind(),
                    estimate: found.estimate,
                })
            }
        }
    }

    /// What relative depth is in metres.
    pub(crate) fn scale(&self) -> Result<RelativeScale, Failure> {
        RelativeScale::new(self.metres_at_one).map_err(Failure::usage)
    }

    /// The water per unit of depth of `kind`.
    pub(crate) fn per(&self, kind: DepthKind, file: &WaterFile) -> Result<WaterEstimate, Failure> {
        file.seen(kind, self.scale()?, self.visibility).map_err(Failure::work)
    }

    /// The sea, per unit of depth of `kind`.
    pub(crate) fn sea(&self, kind: DepthKind) -> Result<Sea, Failure> {
        Ok(Sea { depth_kind: kind, scale: self.scale()?, visibility: self.visibility })
    }

    /// Refuses what `model` does not read of WATER.
    pub(crate) fn refuse_unread(&self, model: Model) -> Result<(), Failure> {
        if self.visibility.is_some() && model != Model::Exchange {
            return Err(Failure::usage(anyhow!(
                "--visibility needs --model exchange: {model} takes only the colour of WATER"
            )));
        }
        Ok(())
    }
}
