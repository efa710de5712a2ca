//! `aquafuse restore`: an image, or a folder of them, as if seen through air.

use std::path::PathBuf;

use aquafuse::formation::RestoreOptions;
use aquafuse_data::batch::Recipe;
use aquafuse_data::pipeline::Operation;
use clap::Args;
use serde_json::json;

use crate::args::batch::BatchArguments;
use crate::args::common::Common;
use crate::args::depth_model::DepthModelArg;
use crate::failure::Failure;
use crate::report::batch::{self, Words};

const HELP: &str = "\
Eq. 2 of the paper, I = (U - B) e^(beta_D z): the backscatter is taken off, then what has faded
is strengthened, --max-gain times at most. It is as right as depth and water are. From colour
alone expect a clearer image, not true colours; with a depth map in metres expect more. What
is far and faint has drowned in noise and stays dark. Where colours look burnt, --max-gain 2 is
gentler.

Example:
  aquafuse restore reef.jpg -o clear.png
  aquafuse restore photos/ -o clear/ --depth depths/ --depth-kind metres";

/// Take the water out of an image, or of a folder of them.
#[derive(Args)]
#[command(after_help = HELP)]
pub(crate) struct Restore {
    /// An image (PNG, JPEG, TIFF, WebP, BMP, GIF), or a folder of images (not GIF).
    content: PathBuf,
    #[command(flatten)]
    batch: BatchArguments,
    #[command(flatten)]
    depth_model: DepthModelArg,
    /// How many times the scene's own light is strengthened at most, 1 to 100. Noise grows with it.
    #[arg(long, value_name = "N", default_value_t = RestoreOptions::default().max_gain[0], value_parser = gain)]
    max_gain: f32,
}

impl Restore {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        let encoding = self.batch.encoding();
        let depth_model = self.depth_model.get();
        let plan = self.batch.plan(&self.content, &[], depth_model, false)?;
        let options = RestoreOptions::default().with_max_gain([self.max_gain; 3]);
        let operation = Operation::Restore { options, encoding };
        let recipe =
            Recipe { upright: self.batch.upright, quality: self.batch.quality, ..Recipe::new(operation) };
        let settings = json!({
            "command": "restore",
            "encoding": encoding.name(),
            "max_gain": self.max_gain,
            "depth_model": depth_model.name(),
        });
        batch::run(&plan, &recipe, Words { heading: String::new(), settings }, &self.batch, common)
    }
}

fn gain(text: &str) -> Result<f32, String> {
    let gain: f32 = text.parse().map_err(|_| "not a number")?;
    if (1.0..=100.0).contains(&gain) { Ok(gain) } else { Err("give a number from 1 to 100".into()) }
}
