//! `aquafuse enhance`: fusion with clear water, scored before and after.

use std::path::PathBuf;

use aquafuse_data::batch::Recipe;
use aquafuse_data::pipeline::Operation;
use aquafuse_data::water_file::Numbers;
use clap::Args;
use serde_json::json;

use crate::args::batch::BatchArguments;
use crate::args::common::Common;
use crate::args::enhance::EnhanceSettings;
use crate::args::water::WaterSource;
use crate::failure::Failure;
use crate::report::batch::{self, Words};
use crate::report::water::veiling_light;

const HELP: &str = "\
Scores before and after: UCIQE and its parts colour (deviation of chroma) and contrast (of
lightness), UIQM and its part sharpness. Higher counts as better, but oversaturation and noise
raise all of them: look at the image too.

Examples:
  aquafuse enhance reef.jpg -o reef_enhanced.jpg
  aquafuse enhance photos/ clear_day.jpg -o enhanced/";

/// Make an image or a folder of images clearer by fusion with clear water.
#[derive(Args)]
#[command(after_help = HELP)]
pub(crate) struct Enhance {
    /// An image (PNG, JPEG, TIFF, WebP, BMP, GIF) or a folder of images (not GIF, no subfolders).
    content: PathBuf,
    /// The clear water: an image, NAME.water.json or preset:NAME. The default is the clearest ocean water.
    #[arg(default_value = "preset:jerlov-I")]
    clear: PathBuf,
    #[command(flatten)]
    batch: BatchArguments,
    #[command(flatten)]
    settings: EnhanceSettings,
}

impl Enhance {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        let encoding = self.batch.encoding();
        let depth_model = self.settings.depth_model();
        let water = WaterSource::parse(&self.clear)?;
        let inputs: Vec<_> = water.path().into_iter().collect();
        let plan = self.batch.plan(&self.content, &inputs, depth_model, true)?;
        let file = self.settings.waters.read(&water, depth_model, encoding, &common.reading)?;
        let reference = self.settings.waters.per(self.batch.depth.kind_of_map(), &file)?;
        let options = self.settings.options()?;
        let words = Words {
            heading: format!("{}: {}\n", water.name(), veiling_light(&reference)),
            settings: json!({
                "command": "enhance",
                "encoding": encoding.name(),
                "model": options.model.name(),
                "theta": options.incidence.degrees(),
                "alpha": options.gain.get(),
                "depth_model": depth_model.name(),
                "water": water.name(),
                "waterbody": Numbers::from(&reference),
            }),
        };
        let operation = Operation::Fuse { reference, options };
        let recipe =
            Recipe { upright: self.batch.upright, quality: self.batch.quality, ..Recipe::new(operation) };
        batch::run(&plan, &recipe, words, &self.batch, common)
    }
}
