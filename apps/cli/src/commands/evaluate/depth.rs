//! `aquafuse evaluate depth`: depth from colour, depth by networks, and other depth maps, against known depth.

use std::path::PathBuf;

use anyhow::anyhow;
use aquafuse::depth::{DepthModel, SuppliedKind};
use aquafuse_data::depth_file::DepthFolder;
use aquafuse_data::evaluate::{Depth, Listener, Maps};
use aquafuse_data::pipeline::DepthEstimator;
use clap::Args;

use crate::args::common::Common;
use crate::args::depth::kind;
use crate::args::depth_model::DepthModelsArg;
use crate::args::evaluation::ReportArguments;
use crate::args::pairs::list_pairs;
use crate::failure::Failure;

const HELP: &str = "\
Scores use the pixels with known depth, after fitting scale and shift to each image, because
relative depth has neither. Maps of kind `inverse` (monocular networks) are fitted as 1 / z.

Examples:
  aquafuse evaluate depth pairs/ --depth-kind metres -o depth.html
  aquafuse evaluate depth pairs/ --depth-kind metres --maps net=inverse:net/ --depth-model my.toml
                                                     also scores network maps and a model of `fit`
  aquafuse evaluate depth pairs/ --depth-kind metres --depth-model depth_anything_v2_vits.onnx
                                                     also scores a network of your own";

/// Score depth from colour, and other depth maps, against known depth.
///
/// PAIRS holds a folder `rgb` of images and a folder `depth` of depth maps with the same stems and sizes, as for
/// `fit`.
#[derive(Args)]
#[command(after_help = HELP)]
pub(crate) struct DepthEvaluationArguments {
    /// A folder that contains `rgb` and `depth`.
    pairs: PathBuf,
    /// Kind of the values of the maps in `depth`, as in `fuse`.
    #[arg(long, value_name = "KIND", value_parser = kind())]
    depth_kind: SuppliedKind,
    #[command(flatten)]
    depth_models: DepthModelsArg,
    /// Also score the maps in DIR with the same stems, whose values are of KIND (as in --depth-kind). May be repeated.
    #[arg(long, value_name = "NAME=KIND:DIR", value_parser = maps)]
    maps: Vec<Supplied>,
    /// Random seed of the bootstrap.
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
    #[command(flatten)]
    report: ReportArguments,
}

/// `NAME=KIND:DIR`.
#[derive(Clone, Debug)]
struct Supplied {
    name: String,
    kind: SuppliedKind,
    folder: PathBuf,
}

fn maps(text: &str) -> anyhow::Result<Supplied> {
    let parts = text.split_once('=').and_then(|(name, rest)| Some((name, rest.split_once(':')?)));
    let Some((name, (kind, folder))) = parts.filter(|(name, _)| !name.is_empty()) else {
        return Err(anyhow!("give a name, a kind of values and a folder, as net=inverse:maps/"));
    };
    let kind = kind.parse::<SuppliedKind>().map_err(|_| {
        anyhow!(
            "unknown kind {kind}; the kinds are {}",
            SuppliedKind::ALL.iter().map(|kind| kind.name()).collect::<Vec<_>>().join(", ")
        )
    })?;
    Ok(Supplied { name: name.to_owned(), kind, folder: folder.into() })
}

impl DepthEvaluationArguments {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        self.report.check()?;
        let depth = Depth {
            pairs: list_pairs(&self.pairs, common.quiet)?,
            kind: self.depth_kind,
            models: self.models()?,
            maps: self.supplied()?,
            seed: self.seed,
            run_options: common.run_options(),
        };
        self.report.run(common, |listener: Listener<'_>| depth.run(listener), |_| {})
    }

    fn models(&self) -> Result<Vec<(String, DepthEstimator)>, Failure> {
        let ours = DepthModel::ALL.iter().map(|model| (format!("`{}`", model.name()), (*model).into()));
        Ok(ours.chain(self.depth_models.get()?).collect())
    }

    fn supplied(&self) -> Result<Vec<Maps>, Failure> {
        let list = |Supplied { name, kind, folder }: &Supplied| {
            let folder = DepthFolder::list(folder)?;
            Ok(Maps { name: name.clone(), kind: *kind, folder })
        };
        self.maps.iter().map(list).collect()
    }
}
