//! `aquafuse restore`: an image, or a folder of them, as if seen through air.

use std::path::PathBuf;

use aquafuse::formation::RestoreOptions;
use aquafuse::image::{Encoded, Linear};
use aquafuse::smooth::Smoothing;
use aquafuse_data::treatment::{Space, Treatment};
use clap::Args;
use serde_json::json;

use crate::common::Common;
use crate::depth_model::DepthModelArg;
use crate::failure::Failure;
use crate::work::{Work, WorkArguments};

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
    work: WorkArguments,
    #[command(flatten)]
    depth_model: DepthModelArg,
    /// How many times the scene's own light is strengthened at most, 1 to 100. Noise grows with it.
    #[arg(long, value_name = "N", default_value_t = RestoreOptions::default().max_gain[0], value_parser = gain)]
    max_gain: f32,
}

impl Restore {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        match self.work.linear {
            true => self.run_in::<Linear>(common),
            false => self.run_in::<Encoded>(common),
        }
    }

    fn run_in<E: Space>(&self, common: &Common) -> Result<(), Failure> {
        let depth_model = self.depth_model.get();
        let work = Work::<E> {
            content: &self.content,
            beside: &[],
            depth_model,
            treatment: Treatment::Restore(RestoreOptions::default().with_max_gain([self.max_gain; 3])),
            smoothing: Smoothing::None,
            scores: false,
            heading: String::new(),
            settings: json!({
                "command": "restore",
                "encoding": E::NAME,
                "max_gain": self.max_gain,
                "depth_model": depth_model.name(),
            }),
        };
        self.work.run(work, common)
    }
}

fn gain(text: &str) -> Result<f32, String> {
    let gain: f32 = text.parse().map_err(|_| "not a number")?;
    if (1.0..=100.0).contains(&gain) { Ok(gain) } else { Err("give a number from 1 to 100".into()) }
}
