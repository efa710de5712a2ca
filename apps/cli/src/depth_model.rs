//! `--depth-model`, wherever depth is estimated.

use aquafuse::depth::DepthModel;
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};

/// The way from colour to depth.
#[derive(Args)]
pub(crate) struct DepthModelArg {
    /// How depth is estimated from colour: `eq3` is the paper's, `ratio` the logarithm of max(G, B) / R,
    /// `ulap` and `udepth` are published lines. `layout` puts what is higher in the picture farther away
    /// and corrects that by colour: right for a level camera that looks ahead, wrong for a rolled or
    /// down-looking one.
    #[arg(long = "depth-model", value_name = "M", default_value = "eq3", value_parser = model())]
    depth_model: DepthModel,
}

impl DepthModelArg {
    pub(crate) fn get(&self) -> DepthModel {
        self.depth_model
    }
}

fn model() -> impl TypedValueParser<Value = DepthModel> {
    PossibleValuesParser::new(DepthModel::ALL.map(|model| model.name()))
        .map(|name| DepthModel::from_name(&name).unwrap_or_default())
}
