//! `aquafuse evaluate depth`: depth from colour, and maps from elsewhere, against depth that is known.

use std::path::PathBuf;

use anyhow::anyhow;
use aquafuse::depth::{DepthModel, SuppliedKind};
use aquafuse_data::depth_file::DepthFolder;
use aquafuse_data::evaluate::{Depth, Listener, Maps};
use aquafuse_data::files::display;
use aquafuse_data::model_file::ModelFile;
use aquafuse_data::pairs;
use clap::Args;

use crate::args::common::Common;
use crate::args::depth::kind;
use crate::args::evaluation::ReportArguments;
use crate::failure::Failure;
use crate::report::output;

const HELP: &str = "\
Scores are taken where depth is known, after the scale and shift that fit best image by image:
relative depth has neither. Maps from a monocular network are `inverse`, and fitted as 1 / z.

Examples:
  aquafuse evaluate depth pairs/ --depth-kind metres -o depth.html
  aquafuse evaluate depth pairs/ --depth-kind metres --maps midas=inverse:midas/ --depth-model reef.toml
                                                     beside a network's maps, and a model from `fit`";

/// Measure how right depth from colour is, and depth maps from elsewhere, against depth that is known.
///
/// PAIRS holds a folder `rgb` of images and a folder `depth` of depth maps of the same stems and sizes, as for `fit`.
#[derive(Args)]
#[command(after_help = HELP)]
pub(crate) struct DepthEvaluationArguments {
    /// A folder with `rgb` and `depth` in it.
    pairs: PathBuf,
    /// What the values of the maps in `depth` are, which no file says: as for `fuse`.
    #[arg(long, value_name = "KIND", value_parser = kind())]
    depth_kind: SuppliedKind,
    /// Also measure this model, a FILE.toml from `fit`. May be given several times.
    #[arg(long, value_name = "FILE.toml")]
    depth_model: Vec<PathBuf>,
    /// Also measure the maps in DIR, of the same stems, whose values are of KIND (as for --depth-kind). May be given
    /// several times.
    #[arg(long, value_name = "NAME=KIND:DIR", value_parser = maps)]
    maps: Vec<Supplied>,
    /// What resamplings are drawn by.
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
        return Err(anyhow!("give a name, what the values are, and a folder: midas=inverse:maps/"));
    };
    let kind = kind.parse::<SuppliedKind>().ok().ok_or_else(|| {
        anyhow!(
            "there is no kind {kind}; the kinds are {}",
            SuppliedKind::ALL.iter().map(|one| one.name()).collect::<Vec<_>>().join(", ")
        )
    })?;
    Ok(Supplied { name: name.to_owned(), kind, folder: folder.into() })
}

impl DepthEvaluationArguments {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        self.report.check()?;
        let listing = pairs::list(&self.pairs).map_err(Failure::usage)?;
        if listing.pairs.is_empty() {
            return Err(Failure::usage(anyhow!(
                "{} holds no pair: no file of rgb/ has a partner of the same stem in depth/. Name the two files of a pair \
                 alike",
                display(&self.pairs)
            )));
        }
        if !common.quiet && !listing.without_partner.is_empty() {
            let names = listing.without_partner.join(", ");
            output::complain(&format!("passed over for want of a partner: {names}"));
        }
        let depth = Depth {
            pairs: listing.pairs,
            kind: self.depth_kind,
            models: self.models()?,
            maps: self.supplied()?,
            seed: self.seed,
            run_options: common.run_options(),
        };
        self.report.run(common, |listener: Listener<'_>| depth.run(listener), |_| {})
    }

    fn models(&self) -> Result<Vec<(String, DepthModel)>, Failure> {
        let mut models: Vec<_> =
            DepthModel::ALL.iter().copied().map(|model| (format!("`{}`", model.name()), model)).collect();
        for path in &self.depth_model {
            let file = ModelFile::read(path).map_err(Failure::usage)?;
            models.push((display(path).to_string(), DepthModel::Eq3(file.eq3)));
        }
        Ok(models)
    }

    fn supplied(&self) -> Result<Vec<Maps>, Failure> {
        let list = |Supplied { name, kind, folder }: &Supplied| {
            let folder = DepthFolder::list(folder)?;
            Ok(Maps { name: name.clone(), kind: *kind, folder })
        };
        self.maps.iter().map(list).collect()
    }
}
