//! `aquafuse evaluate enhancement`: images before and after.

use std::path::PathBuf;

use aquafuse::formation::RestoreOptions;
use aquafuse::levels::LevelsOptions;
use aquafuse_data::evaluate::{Enhancement, GroupBy, Listener, Outputs};
use aquafuse_data::pipeline::{DepthSource, Operation, PixelEncoding};
use clap::Args;
use serde_json::{Map, json};

use crate::args::border::BorderArgument;
use crate::args::common::{Common, encoding};
use crate::args::enhance::EnhanceSettings;
use crate::args::evaluation::{Named, ReportArguments, named, outputs};
use crate::args::water::WaterSource;
use crate::failure::Failure;

const ENHANCE: &str = "AquaFuse enhance";
const RESTORE: &str = "AquaFuse restore";
const CLARIFY: &str = "AquaFuse enhance, with clear water";

const HELP: &str = "\
UCIQE and UIQM need no reference image. Higher counts as better, but oversaturation and noise
raise both. With --reference, PSNR and SSIM tell how near each method comes to images that people
preferred. The second table scores the change of each image: if its interval excludes 0, the
change is significant.

Examples:
  aquafuse evaluate enhancement dives/ -o enhanced.html
  aquafuse evaluate enhancement raw/ --reference reference/ -o pairs.md
  aquafuse evaluate enhancement dives/ --method sea-thru=restored/ -o methods.md
                                                     also scores another tool's restored/STEM.png";

/// Score images before and after `enhance` and `restore`, simple rivals, and other tools.
#[derive(Args)]
#[command(after_help = HELP)]
pub(crate) struct EnhancementArguments {
    /// A folder of images.
    images: PathBuf,
    /// A folder of references with the same stems and sizes: score how near each method comes to them.
    #[arg(long, value_name = "DIR")]
    reference: Option<PathBuf>,
    /// Also score fusion with this clear water: an image, NAME.water.json or preset:NAME, as CLEAR in `enhance`.
    #[arg(long, value_name = "WATER")]
    clear: Option<PathBuf>,
    #[command(flatten)]
    settings: EnhanceSettings,
    #[command(flatten)]
    border: BorderArgument,
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
        let common = &self.border.cutting(common);
        self.report.check()?;
        let images = GroupBy::Nothing.list(&self.images)?;
        let mut methods = vec![
            (ENHANCE.to_owned(), Operation::Enhance { levels: LevelsOptions::default() }),
            (RESTORE.to_owned(), restoration(encoding(self.linear))),
        ];
        let depth_model = self.settings.depth_model()?;
        let mut settings = Map::from_iter([("encoding".to_owned(), json!(encoding(self.linear).name()))]);
        if let Some(clear) = &self.clear {
            let options = self.settings.options()?;
            let water = WaterSource::parse(clear)?;
            let file =
                self.settings.waters.read(&water, &depth_model, encoding(self.linear), &common.reading)?;
            let reference = self.settings.waters.per(depth_model.kind(), &file)?;
            settings.insert("water".into(), json!(water.name()));
            settings.insert("model".into(), json!(options.model.name()));
            settings.insert("theta".into(), json!(options.incidence.degrees()));
            settings.insert("alpha".into(), json!(options.gain.get()));
            methods.push((CLARIFY.to_owned(), Operation::Clarify { reference, options }));
        }
        let list = |folder: &PathBuf| Outputs::list("reference", folder);
        let enhancement = Enhancement {
            images,
            methods,
            references: self.reference.as_ref().map(list).transpose()?,
            source: DepthSource::Estimated(depth_model),
            outputs: outputs(&self.method, &[ENHANCE, RESTORE, CLARIFY])?,
            seed: self.seed,
            run_options: common.run_options(),
            settings,
        };
        self.report.run(common, |listener: Listener<'_>| enhancement.run(listener), |_| {})
    }
}

fn restoration(encoding: PixelEncoding) -> Operation {
    let (options, levels) = (RestoreOptions::default(), LevelsOptions::default());
    Operation::Restore { options, levels, encoding }
}
