//! `aquafuse fuse`: an image, or a folder of them, in another image's water.

mod sweep;

use std::path::{Path, PathBuf};

use crate::args::fusion::{self, Settings, SettingsArgs};
use aquafuse::depth::SuppliedKind;
use aquafuse::waterbody::Reason;
use aquafuse_data::batch::Recipe;
use aquafuse_data::files::display;
use aquafuse_data::pipeline::{DepthSource, Operation, WaterEstimate};
use aquafuse_data::water_file::Numbers;
use clap::{ArgGroup, Args};
use serde_json::json;
use sweep::Sweep;

use crate::args::batch::BatchArguments;
use crate::args::common::Common;
use crate::args::depth::{WaterDepthArguments, inverted_by};
use crate::args::water::{WaterArguments, WaterSource};
use crate::failure::Failure;
use crate::report::batch::{self, Words};
use crate::report::water::veiling_light;

/// Put an image or a folder of images into the water of another image.
///
/// To continue a run over a folder that was stopped, repeat the command: finished images are skipped.
#[derive(Args)]
#[command(after_help = fusion::HELP, group = ArgGroup::new("area").args(["border", "water_map"]).multiple(true).conflicts_with("as_published"))]
pub(crate) struct Fuse {
    /// The scene: an image (PNG, JPEG, TIFF, WebP, BMP, GIF) or a folder of images (not GIF; subfolders with
    /// --recursive). There may be several, as *.jpg.
    #[arg(required = true, value_name = "CONTENT")]
    contents: Vec<PathBuf>,
    /// The reference water: an image (best with open water in view), NAME.water.json from `water extract`,
    /// preset:NAME from `water list`, or sea:NUMBER, a drawn water.
    water: PathBuf,
    #[command(flatten)]
    batch: BatchArguments,
    #[command(flatten)]
    settings: SettingsArgs,
    #[command(flatten)]
    waters: WaterArguments,
    #[command(flatten)]
    water_depth: WaterDepthArguments,
    /// Write a contact sheet of CONTENT and one fused image per value, for example theta=0,30,60,90 or
    /// alpha=0.5,1,2.
    #[arg(long, value_name = "NAME=V,V", conflicts_with_all = ["json", "maps", "report", "sequence", "upright"])]
    sweep: Option<Sweep>,
}

impl Fuse {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        let common = &self.settings.cutting(&self.batch.border, common);
        let encoding = self.batch.encoding();
        let Settings { depth_model, options, smoothing, .. } = self.settings.get()?;
        self.waters.refuse_unread(options.model)?;
        let water = WaterSource::parse(&self.water)?;
        let water_depth = self.water_depth.source(&water, &depth_model).map_err(Failure::usage)?;
        let map = match &water_depth {
            DepthSource::Supplied { path, kind, .. } => Some((path.as_path(), *kind)),
            DepthSource::Estimated(_) => None,
        };
        let inputs: Vec<_> = water.path().into_iter().chain(map.map(|(path, _)| path)).collect();
        let plan = self.batch.plan(&self.contents, &inputs, &depth_model, false)?;
        let file = self.waters.read_by(&water, &water_depth, encoding, &common.reading)?;
        let reference = self.waters.per(self.batch.depth.kind_of_map(&depth_model), &file)?;
        if let Some(sweep) = &self.sweep {
            self.settings.refuse_beside(sweep.name()).map_err(Failure::usage)?;
            let settings = self.settings.get()?;
            return sweep.run(plan.items(), &reference, &settings, &self.batch, common);
        }
        let words = Words {
            heading: format!("{}: {}\n{}", water.name(), veiling_light(&reference), warning(&reference, map)),
            settings: json!({
                "command": "fuse",
                "encoding": encoding.name(),
                "model": options.model.name(),
                "theta": options.incidence.degrees(),
                "alpha": options.gain.get(),
                "smooth": smoothing.name(),
                "depth_model": depth_model.name(),
                "border": common.reading.border.to_string(),
                "water_map": common.reading.water_map.name(),
                "water": water.name(),
                "water_depth": map.map(|(path, kind)| json!({
                    "file": display(path).to_string(),
                    "kind": kind.name(),
                })),
                "waterbody": Numbers::from(&reference),
                "quality": reference.quality(),
            }),
        };
        let recipe = Recipe { smoothing, ..self.batch.recipe(Operation::Fuse { reference, options }) };
        batch::run(&plan, &recipe, words, &self.batch, common)
    }
}

/// A line about a depth map of the reference that looks inverted; empty if it does not.
fn warning(reference: &WaterEstimate, map: Option<(&Path, SuppliedKind)>) -> String {
    match map {
        Some((path, kind)) if reference.quality().reasons.contains(Reason::InvertedDepth) => {
            format!("  WARNING: {} {}\n", display(path), inverted_by("--water-depth-kind", kind))
        }
        _ => String::new(),
    }
}
