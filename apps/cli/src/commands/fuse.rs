//! `aquafuse fuse`: an image, or a folder of them, in another image's water.

mod sweep;

use std::path::PathBuf;

use crate::args::fusion::{self, Settings, SettingsArgs};
use aquafuse_data::batch::Recipe;
use aquafuse_data::pipeline::Operation;
use aquafuse_data::water_file::Numbers;
use clap::Args;
use serde_json::json;
use sweep::Sweep;

use crate::args::batch::BatchArguments;
use crate::args::common::Common;
use crate::args::water::{WaterArguments, WaterSource};
use crate::failure::Failure;
use crate::report::batch::{self, Words};
use crate::report::water::veiling_light;

/// Put an image or a folder of images into the water of another image.
///
/// To continue a run over a folder that was stopped, repeat the command: finished images are skipped.
#[derive(Args)]
#[command(after_help = fusion::HELP)]
pub(crate) struct Fuse {
    /// The scene: an image (PNG, JPEG, TIFF, WebP, BMP, GIF) or a folder of images (not GIF, no subfolders).
    content: PathBuf,
    /// The reference water: an image (best with open water in view), NAME.water.json from `water extract`, or
    /// preset:NAME from `water list`.
    water: PathBuf,
    #[command(flatten)]
    batch: BatchArguments,
    #[command(flatten)]
    settings: SettingsArgs,
    #[command(flatten)]
    waters: WaterArguments,
    /// Write a contact sheet of CONTENT and one fused image per value, for example theta=0,30,60,90 or
    /// alpha=0.5,1,2.
    #[arg(long, value_name = "NAME=V,V", conflicts_with_all = ["json", "maps", "report", "upright"])]
    sweep: Option<Sweep>,
}

impl Fuse {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        let encoding = self.batch.encoding();
        let Settings { depth_model, options, smoothing, .. } = self.settings.get();
        let water = WaterSource::parse(&self.water)?;
        let inputs: Vec<_> = water.path().into_iter().collect();
        let plan = self.batch.plan(&self.content, &inputs, depth_model, false)?;
        let file = self.waters.read(&water, depth_model, encoding, &common.reading)?;
        let reference = self.waters.per(self.batch.depth.kind_of_map(), &file)?;
        if let Some(sweep) = &self.sweep {
            self.settings.refuse_beside(sweep.name()).map_err(Failure::usage)?;
            let settings = self.settings.get();
            return sweep.run(plan.items(), &reference, &settings, &self.batch, common);
        }
        let words = Words {
            heading: format!("{}: {}\n", water.name(), veiling_light(&reference)),
            settings: json!({
                "command": "fuse",
                "encoding": encoding.name(),
                "model": options.model.name(),
                "theta": options.incidence.degrees(),
                "alpha": options.gain.get(),
                "smooth": smoothing.name(),
                "depth_model": depth_model.name(),
                "water": water.name(),
                "waterbody": Numbers::from(&reference),
                "quality": reference.quality(),
            }),
        };
        let recipe = Recipe {
            operation: Operation::Fuse { reference, options },
            smoothing,
            upright: self.batch.upright,
            quality: self.batch.quality,
        };
        batch::run(&plan, &recipe, words, &self.batch, common)
    }
}
