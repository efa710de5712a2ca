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
    #[command(flatten)]
    waters: WaterArguments,
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
        Ok(Medium::of_file(&file))
    }
}
