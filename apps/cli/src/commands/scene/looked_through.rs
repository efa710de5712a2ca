//! `--water` of a rendering: the medium that a trained scene is seen through.

use std::path::{Path, PathBuf};

use aquafuse::depth::{DepthKind, DepthModel};
use aquafuse_data::pipeline::PixelEncoding;
use aquafuse_scene::medium::Medium;
use clap::Args;

use crate::args::common::Common;
use crate::args::water::{WaterArguments, WaterSource};
use crate::failure::Failure;

#[derive(Args)]
pub(crate) struct LookedThrough {
    /// Medium to render through: `none` for air, or an image, NAME.water.json or preset:NAME [default: the learned water].
    #[arg(long, value_name = "WATER")]
    water: Option<PathBuf>,
    /// Metres in one unit of the scene, which a water per metre needs (preset:NAME, --visibility): a scene of COLMAP has a unit
    /// of its own.
    #[arg(long, value_name = "METRES", default_value_t = 1.0, value_parser = metres, help_heading = "Presets and units")]
    metres_per_unit: f32,
    #[command(flatten)]
    waters: WaterArguments,
}

fn metres(text: &str) -> Result<f32, String> {
    let metres: f32 = text.parse().map_err(|_| "not a number")?;
    if (1e-4..=1e4).contains(&metres) { Ok(metres) } else { Err("give 0.0001 to 10000 metres".into()) }
}

impl LookedThrough {
    /// The medium of `--water`, or the one that the scene was trained with.
    pub(crate) fn medium(&self, trained: Medium<f32>, common: &Common) -> Result<Medium<f32>, Failure> {
        let Some(said) = &self.water else { return Ok(trained) };
        if said == Path::new("none") {
            return Ok(Medium::Air);
        }
        let source = WaterSource::parse(said)?;
        let mut file = self.waters.read(
            &source,
            &DepthModel::default().into(),
            PixelEncoding::Encoded,
            &common.reading,
        )?;
        file.estimate = self.waters.per(DepthKind::Metres, &file)?;
        Ok(Medium::of_file(&file).with_metres_per_unit(self.metres_per_unit))
    }
}
