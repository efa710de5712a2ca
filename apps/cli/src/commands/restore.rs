//! `aquafuse restore`: an image, or a folder of them, as if seen through air.

use std::path::PathBuf;

use aquafuse_data::pipeline::Operation;
use clap::Args;
use serde_json::json;

use crate::args::batch::BatchArguments;
use crate::args::common::Common;
use crate::args::depth_model::DepthModelArg;
use crate::args::levels::LevelsArguments;
use crate::args::max_gain::MaxGain;
use crate::failure::Failure;
use crate::report::batch::{self, Words};

const HELP: &str = "\
Evaluates Eq. 2 of the paper, I = (U - B) e^(beta_D z): subtracts the backscatter, then amplifies
the remaining light, at most --max-gain times. Then white balance and exposure are set.
The result is as accurate as depth and water are. With depth from colour expect a clearer image, not
true colours: red is kept from leading where it did not lead. With a depth map in metres, a larger
--max-gain and --white none --exposure none give Eq. 2 alone, which measures.

Examples:
  aquafuse restore reef.jpg -o clear.png
  aquafuse restore photos/ -o clear/ --depth depths/ --depth-kind metres
  aquafuse restore frames/ -o clear/ --sequence
  aquafuse restore reef.jpg -o eq2.png --white none --exposure none";

/// Remove the water from an image or a folder of images.
#[derive(Args)]
#[command(after_help = HELP)]
pub(crate) struct Restore {
    /// An image (PNG, JPEG, TIFF, WebP, BMP, GIF) or a folder of images (not GIF; subfolders with --recursive). There may
    /// be several, as *.jpg.
    #[arg(required = true, value_name = "CONTENT")]
    contents: Vec<PathBuf>,
    #[command(flatten)]
    batch: BatchArguments,
    #[command(flatten)]
    depth_model: DepthModelArg,
    #[command(flatten)]
    levels: LevelsArguments,
    #[command(flatten)]
    max_gain: MaxGain,
}

impl Restore {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        let common = &self.batch.border.cutting(common);
        let encoding = self.batch.encoding();
        let depth_model = self.depth_model.get()?;
        let plan = self.batch.plan(&self.contents, &[], &depth_model, false)?;
        let options = self.max_gain.options();
        let levels = self.levels.options();
        let operation = Operation::Restore { options, levels, encoding };
        let recipe = self.batch.recipe(operation);
        let settings = json!({
            "command": "restore",
            "encoding": encoding.name(),
            "max_gain": self.max_gain.get(),
            "levels": levels,
            "depth_model": depth_model.name(),
            "border": common.reading.border.to_string(),
            "water_map": common.reading.water_map.name(),
        });
        batch::run(&plan, &recipe, Words { heading: String::new(), settings }, &self.batch, common)
    }
}
