//! `--depth-model`, wherever depth is estimated.

use std::path::Path;

use anyhow::anyhow;
use aquafuse::depth::DepthModel;
use aquafuse_data::model_file::{self, ModelFile};
use clap::Args;

/// The way from colour to depth.
#[derive(Args)]
pub(crate) struct DepthModelArg {
    /// How depth is estimated from colour: eq3, ratio, ulap, udepth, layout, or FILE.toml from `fit`.
    ///
    /// `eq3` is the paper's, `ratio` the logarithm of max(G, B) / R, `ulap` and `udepth` are published lines.
    /// `layout` puts what is higher in the image farther away and corrects that by colour: right for a
    /// level camera that looks ahead, wrong for a rolled or down-looking one. FILE.toml is `eq3` with the
    /// coefficients of that file.
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
        return Err(anyhow!(
            "there is no such model; give one of {names}, or a FILE.toml made by `aquafuse fit`"
        ));
    }
    Ok(DepthModel::Eq3(ModelFile::read(Path::new(name))?.eq3))
}
