//! `aquafuse evaluate enhancement`: images before and after.

use std::path::PathBuf;

use aquafuse::depth::DepthKind;
use aquafuse_data::evaluate::{Enhancement, GroupBy, Listener};
use aquafuse_data::pipeline::DepthSource;
use clap::Args;

use crate::args::common::{Common, encoding};
use crate::args::enhance::EnhanceSettings;
use crate::args::evaluation::{Named, ReportArguments, named, outputs};
use crate::args::water::WaterSource;
use crate::failure::Failure;

const HELP: &str = "\
UCIQE and UIQM need no reference image. Higher counts as better, but oversaturation and noise
raise both. The second table scores the change of each image: if its interval excludes 0, the
change is significant.

Examples:
  aquafuse evaluate enhancement dives/ -o enhanced.html
  aquafuse evaluate enhancement dives/ --method sea-thru=restored/ -o methods.md
                                                     also scores another tool's restored/STEM.png";

/// Score images before and after `enhance`, and after other tools.
#[derive(Args)]
#[command(after_help = HELP)]
pub(crate) struct EnhancementArguments {
    /// A folder of images.
    images: PathBuf,
    /// Clear water: an image, NAME.water.json or preset:NAME, as in `enhance`.
    #[arg(long, value_name = "WATER", default_value = "preset:jerlov-I")]
    clear: PathBuf,
    #[command(flatten)]
    settings: EnhanceSettings,
    /// Compute in linear light instead of encoded values.
    #[arg(long)]
    linear: bool,
    /// Also score outputs of another tool: images in DIR with the same stems. May be repeated.
    #[arg(long, value_name = "NAME=DIR", value_parser = named)]
    method: Vec<Named>,
    /// Random seed of the bootstrap.
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
    #[command(flatten)]
    report: ReportArguments,
}

impl EnhancementArguments {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        let encoding = encoding(self.linear);
        self.report.check()?;
        let images = GroupBy::Nothing.list(&self.images)?;
        let outputs = outputs(&self.method, &[])?;
        let depth_model = self.settings.depth_model();
        let water = WaterSource::parse(&self.clear)?;
        let file = self.settings.waters.read(&water, depth_model, encoding, &common.reading)?;
        let enhancement = Enhancement {
            images,
            clear: self.settings.waters.per(DepthKind::Relative, &file)?,
            options: self.settings.options()?,
            source: DepthSource::Estimated(depth_model),
            outputs,
            seed: self.seed,
            run_options: common.run_options(),
            water: water.name(),
        };
        self.report.run(common, |listener: Listener<'_>| enhancement.run(listener), |_| {})
    }
}
