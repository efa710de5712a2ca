//! `--depth-model`, wherever depth is estimated.

use std::path::Path;

use anyhow::anyhow;
use aquafuse::depth::DepthModel;
use aquafuse_data::model_file::{self, ModelFile};
use clap::Args;

/// How depth is estimated from colour.
#[derive(Args)]
pub(crate) struct DepthModelArg {
    /// Model that estimates depth from colour: eq3, eq3-median, ratio, ulap, udepth, layout, or FILE.toml from `fit`.
    ///
    /// `eq3` is the model of the paper. The image refines it, as it does all others; `eq3-median` takes the paper's
    /// 7x7 median instead. `ratio` is the logarithm of max(G, B) / R. `ulap` and `udepth` are published
    /// linear models. `layout` assumes that higher pixels are farther and corrects this by colour: use it only
    /// if the camera is level and looks ahead. FILE.toml is `eq3` with fitted coefficients.
    #[arg(long = "depth-model", value_name = "M", default_value = "eq3", value_parser = model)]
    depth_model: DepthModel,
}

impl DepthModelArg {
    pub(crate) fn get(&self) -> DepthModel {
        self.depth_model
    }
}

fn model(name: &str) -> anyhow::Result<DepthModel> {
    if let Ok(model) = name.parse() {
        return Ok(model);
    }
    if model_file::check_name(Path::new(name)).is_err() {
        let names = DepthModel::ALL.iter().map(DepthModel::name).collect::<Vec<_>>().join(", ");
        return Err(anyhow!("unknown depth model; give one of {names}, or a FILE.toml from `aquafuse fit`"));
    }
    Ok(DepthModel::Eq3(ModelFile::read(Path::new(name))?.eq3))
}
