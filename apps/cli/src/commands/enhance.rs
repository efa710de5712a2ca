//! `aquafuse enhance`: global levels, or fusion with clear water; scored before and after.

use std::path::{Path, PathBuf};

use aquafuse_data::batch::Recipe;
use aquafuse_data::pipeline::Operation;
use aquafuse_data::water_file::Numbers;
use clap::{ArgGroup, Args};
use serde_json::json;

use crate::args::batch::BatchArguments;
use crate::args::common::Common;
use crate::args::enhance::EnhanceSettings;
use crate::args::levels::LevelsArguments;
use crate::args::water::WaterSource;
use crate::failure::Failure;
use crate::report::batch::{self, Words};
use crate::report::water::veiling_light;

const HELP: &str = "\
Without CLEAR each channel is stretched from its darkest to its brightest values and made brighter
or darker, within bounds: the haze and the colour of the water go. Nothing is estimated.
With CLEAR the image is fused with clear water, as in the paper, and keeps its lightness.

Scores before and after: UCIQE and its parts colour (deviation of chroma) and contrast (of
lightness), UIQM and its part sharpness. They prove nothing: oversaturation and noise raise all of
them, and they praise what people reject. Look at the image.

Examples:
  aquafuse enhance reef.jpg -o reef_enhanced.jpg
  aquafuse enhance photos/ -o enhanced/ --strength 0.7
  aquafuse enhance photos/ clear_day.jpg -o enhanced/";

/// Make an image or a folder of images clearer.
#[derive(Args)]
#[command(
    after_help = HELP,
    group = ArgGroup::new("levels").args(["white", "exposure", "strength"]).multiple(true).conflicts_with("clear"),
    group = ArgGroup::new("fusion")
        .args(["model", "theta", "alpha", "depth_model", "metres_at_one", "depth", "depth_kind", "maps", "linear"])
        .multiple(true)
        .requires("clear"),
)]
pub(crate) struct Enhance {
    /// An image (PNG, JPEG, TIFF, WebP, BMP, GIF) or a folder of images (not GIF; subfolders with --recursive).
    content: PathBuf,
    /// Clear water to fuse with: an image, NAME.water.json or preset:NAME.
    clear: Option<PathBuf>,
    #[command(flatten)]
    batch: BatchArguments,
    #[command(flatten)]
    levels: LevelsArguments,
    #[command(flatten)]
    settings: EnhanceSettings,
}

impl Enhance {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        let common = &self.batch.border.cutting(common);
        match &self.clear {
            Some(clear) => self.fuse(clear, common),
            None => self.set_levels(common),
        }
    }

    /// Whether scores are computed: not where nobody would see them, for they take longer than the image.
    fn scores(&self, common: &Common) -> bool {
        !common.quiet || self.batch.json || self.batch.report.is_some()
    }

    fn set_levels(&self, common: &Common) -> Result<(), Failure> {
        let levels = self.levels.options();
        let plan = self.batch.plan(
            std::slice::from_ref(&self.content),
            &[],
            &self.settings.depth_model()?,
            self.scores(common),
        )?;
        let words = Words {
            heading: String::new(),
            settings: json!({
                "command": "enhance",
                "levels": levels,
                "border": common.reading.border.to_string(),
                "water_map": common.reading.water_map.name(),
            }),
        };
        batch::run(&plan, &self.recipe(Operation::Enhance { levels }), words, &self.batch, common)
    }

    fn fuse(&self, clear: &Path, common: &Common) -> Result<(), Failure> {
        let encoding = self.batch.encoding();
        let depth_model = self.settings.depth_model()?;
        let water = WaterSource::parse(clear)?;
        let inputs: Vec<_> = water.path().into_iter().collect();
        let plan = self.batch.plan(
            std::slice::from_ref(&self.content),
            &inputs,
            &depth_model,
            self.scores(common),
        )?;
        let file = self.settings.waters.read(&water, &depth_model, encoding, &common.reading)?;
        let reference = self.settings.waters.per(self.batch.depth.kind_of_map(&depth_model), &file)?;
        let options = self.settings.options()?;
        self.settings.waters.refuse_unread(options.model)?;
        let words = Words {
            heading: format!("{}: {}\n", water.name(), veiling_light(&reference)),
            settings: json!({
                "command": "enhance",
                "encoding": encoding.name(),
                "model": options.model.name(),
                "theta": options.incidence.degrees(),
                "alpha": options.gain.get(),
                "depth_model": depth_model.name(),
                "border": common.reading.border.to_string(),
                "water_map": common.reading.water_map.name(),
                "water": water.name(),
                "waterbody": Numbers::from(&reference),
            }),
        };
        batch::run(&plan, &self.recipe(Operation::Clarify { reference, options }), words, &self.batch, common)
    }

    fn recipe(&self, operation: Operation) -> Recipe {
        self.batch.recipe(operation)
    }
}
