//! `aquafuse enhance`: fusion with clear water, scored before and after.

use std::path::PathBuf;

use aquafuse::depth::DepthModel;
use aquafuse::fusion::{Gain, Incidence, Model, Options};
use aquafuse::image::{Encoded, Linear};
use aquafuse::smooth::Smoothing;
use aquafuse_data::treatment::{Space, Treatment};
use aquafuse_data::water_file::Numbers;
use clap::Args;
use serde_json::json;

use crate::common::Common;
use crate::depth_model::DepthModelArg;
use crate::failure::Failure;
use crate::fuse::settings::{gain, incidence, model};
use crate::inspect::veiling_light;
use crate::water_argument::{WaterArguments, WaterSource};
use crate::work::{Work, WorkArguments};

const HELP: &str = "\
The scores: UCIQE and UIQM, the colour (deviation of chroma) and contrast (of lightness) that
are parts of the first, the sharpness that is part of the second. Higher is held to be better;
all are fooled by oversaturation and noise, so look at the image.

Example:
  aquafuse enhance reef.jpg -o reef_enhanced.jpg
  aquafuse enhance photos/ clear_day.jpg -o enhanced/";

/// Make an image, or a folder of them, clearer by fusion with clear water.
#[derive(Args)]
#[command(after_help = HELP)]
pub(crate) struct Enhance {
    /// An image (PNG, JPEG, TIFF, WebP, BMP, GIF), or a folder of images (not GIF).
    content: PathBuf,
    /// Clear water: an image, NAME.water.json or preset:NAME. By default that of the clearest ocean.
    #[arg(default_value = "preset:jerlov-I")]
    clear: PathBuf,
    #[command(flatten)]
    work: WorkArguments,
    #[command(flatten)]
    settings: EnhanceSettings,
}

/// How images are made clearer.
#[derive(Args)]
pub(crate) struct EnhanceSettings {
    /// What is exchanged, as in `fuse`.
    #[arg(long, default_value = Model::Physical.name(), value_parser = model())]
    model: Model,
    /// Strength, from 0 (most) to 90 (none) degrees [default: 0].
    #[arg(long, value_name = "DEG", value_parser = incidence, allow_negative_numbers = true)]
    theta: Option<Incidence>,
    /// Gain on the clear water's colour, 0 or more: at 0 its veil is taken off and none put in.
    #[arg(long, value_name = "A", value_parser = gain, default_value = "0.5", allow_negative_numbers = true)]
    alpha: Gain,
    #[command(flatten)]
    depth_model: DepthModelArg,
    #[command(flatten)]
    pub(crate) waters: WaterArguments,
}

impl EnhanceSettings {
    pub(crate) fn depth_model(&self) -> DepthModel {
        self.depth_model.get()
    }

    pub(crate) fn options(&self) -> Result<Options, Failure> {
        let incidence = self.theta.unwrap_or(Incidence::from_degrees(0.0).map_err(Failure::usage)?);
        Ok(Options::for_model(self.model).with_incidence(incidence).with_gain(self.alpha))
    }
}

impl Enhance {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        match self.work.linear {
            true => self.run_in::<Linear>(common),
            false => self.run_in::<Encoded>(common),
        }
    }

    fn run_in<E: Space>(&self, common: &Common) -> Result<(), Failure> {
        let depth_model = self.settings.depth_model();
        let water = WaterSource::parse(&self.clear)?;
        let beside: Vec<_> = water.path().into_iter().collect();
        self.work.plan(&self.content, &beside, depth_model)?;
        let file = self.settings.waters.read::<E>(&water, depth_model, &common.reading)?;
        let reference = self.settings.waters.per(self.work.depth.kind_of_map(), &file)?;
        let options = self.settings.options()?;
        let work = Work {
            content: &self.content,
            beside: &beside,
            depth_model,
            heading: format!("{}: {}\n", water.name(), veiling_light(&reference)),
            settings: json!({
                "command": "enhance",
                "encoding": E::NAME,
                "model": options.model.name(),
                "theta": options.incidence.degrees(),
                "alpha": options.gain.get(),
                "depth_model": depth_model.name(),
                "water": water.name(),
                "waterbody": Numbers::from(&reference.water),
            }),
            treatment: Treatment::Fuse { reference, options },
            smoothing: Smoothing::None,
            scores: true,
        };
        self.work.run(work, common)
    }
}
