//! `--depth-model`, wherever depth is estimated.

use std::path::{Path, PathBuf};

use anyhow::anyhow;
use aquafuse::depth::DepthModel;
use aquafuse_data::depth_network::{DepthNetwork, NetworkKind, NetworkOptions, SIDES};
use aquafuse_data::files::display;
use aquafuse_data::model_file::{self, ModelFile};
use aquafuse_data::pipeline::DepthEstimator;
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};

use crate::failure::Failure;

/// How depth is estimated.
#[derive(Args)]
pub(crate) struct DepthModelArg {
    /// Model that estimates depth from colour: eq3, eq3-median, ratio, ulap, udepth, layout, network, or FILE.toml from `fit`; or a
    /// network of depth, FILE.onnx.
    ///
    /// `eq3` is the model of the paper. The image refines it, as it does all others; `eq3-median` takes the paper's
    /// 7x7 median instead. `ratio` is the logarithm of max(G, B) / R. `ulap` and `udepth` are published
    /// linear models. `layout` assumes that higher pixels are farther and corrects this by colour: use it only
    /// if the camera is level and looks ahead. `network` is a tiny network that is part of this program, trained on synthetic scenes
    /// alone; it looks at the whole image, and expects a camera that is held about level. FILE.toml is `eq3` with fitted coefficients. FILE.onnx is a network of your own, such
    /// as Depth Anything V2; its map is used as one of --depth is, once the image has refined it. Nothing is ever downloaded.
    #[arg(long = "depth-model", value_name = "M", default_value = "eq3", value_parser = model)]
    depth_model: Named,
    #[command(flatten)]
    network: NetworkArgs,
}

/// Several models, beside those that are always there.
#[derive(Args)]
pub(crate) struct DepthModelsArg {
    /// Also score this model, a FILE.toml from `fit`, or a network of depth, FILE.onnx. May be repeated.
    #[arg(long = "depth-model", value_name = "FILE", value_parser = model)]
    depth_model: Vec<Named>,
    #[command(flatten)]
    network: NetworkArgs,
}

/// How a network is used, where its file does not settle it.
#[derive(Args)]
struct NetworkArgs {
    /// What the numbers of FILE.onnx are: inverse (larger is nearer), metric (metres) or relative (larger is farther, 0 at the
    /// camera) [default: by the names of its inputs and outputs].
    #[arg(long, value_name = "KIND", value_parser = kind())]
    depth_model_kind: Option<NetworkKind>,
    /// Scale images to about the area of a square of N pixels a side for FILE.onnx, if it takes any size [default: 518].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(i64::from(*SIDES.start())..=i64::from(*SIDES.end())))]
    depth_model_size: Option<u32>,
    /// Refuse FILE.onnx if reading it, or one image, takes more than N seconds [default: 600].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    depth_model_seconds: Option<u32>,
}

const _: () = assert!(NetworkOptions::SECONDS == 600, "the help says the default");

/// A model as it was named.
#[derive(Clone, Debug)]
enum Named {
    /// By its name, or from a file.
    Colour(PathBuf, DepthModel),
    Network(PathBuf),
}

impl Named {
    fn name(&self) -> String {
        let (Self::Colour(name, _) | Self::Network(name)) = self;
        display(name).to_string()
    }
}

impl DepthModelArg {
    /// The model; a network is read from its file.
    pub(crate) fn get(&self) -> Result<DepthEstimator, Failure> {
        self.network.check([&self.depth_model])?;
        self.network.read(&self.depth_model)
    }
}

impl DepthModelsArg {
    /// The models by their names; networks are read from their files.
    pub(crate) fn get(&self) -> Result<Vec<(String, DepthEstimator)>, Failure> {
        self.network.check(&self.depth_model)?;
        let read = |named: &Named| Ok((named.name(), self.network.read(named)?));
        self.depth_model.iter().map(read).collect()
    }
}

impl NetworkArgs {
    /// Refuses options about networks where none is named.
    fn check<'a>(&self, models: impl IntoIterator<Item = &'a Named>) -> Result<(), Failure> {
        let Self { depth_model_kind: kind, depth_model_size: size, depth_model_seconds: seconds } = self;
        let is_asked = kind.is_some() || size.is_some() || seconds.is_some();
        let is_network = |named: &Named| matches!(named, Named::Network(_));
        match is_asked && !models.into_iter().any(is_network) {
            true => Err(Failure::usage(anyhow!(
                "--depth-model-kind, --depth-model-size and --depth-model-seconds are about a network; add --depth-model FILE.onnx"
            ))),
            false => Ok(()),
        }
    }

    fn read(&self, named: &Named) -> Result<DepthEstimator, Failure> {
        let mut options = NetworkOptions::default();
        (options.kind, options.side) = (self.depth_model_kind, self.depth_model_size);
        options.seconds = self.depth_model_seconds;
        Ok(match named {
            Named::Colour(_, model) => (*model).into(),
            Named::Network(path) => {
                DepthEstimator::Network(DepthNetwork::read(path, &options).map_err(Failure::usage)?)
            }
        })
    }
}

fn kind() -> impl TypedValueParser<Value = NetworkKind> {
    PossibleValuesParser::new(NetworkKind::ALL.iter().map(|kind| kind.name()))
        .try_map(|name| name.parse::<NetworkKind>())
}

fn model(name: &str) -> anyhow::Result<Named> {
    if let Ok(model) = name.parse() {
        return Ok(Named::Colour(name.into(), model));
    }
    let path = Path::new(name);
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("onnx")) {
        return Ok(Named::Network(path.to_owned()));
    }
    if model_file::check_name(path).is_err() {
        let names = DepthModel::ALL.iter().map(DepthModel::name).collect::<Vec<_>>().join(", ");
        return Err(anyhow!(
            "unknown depth model; give one of {names}, a FILE.toml from `aquafuse fit`, or a network FILE.onnx"
        ));
    }
    Ok(Named::Colour(path.to_owned(), DepthModel::Eq3(ModelFile::read(path)?.eq3)))
}
