//! `--depth` and `--depth-kind`, `--water-depth` and `--water-depth-kind`: depth that comes with an image.

use std::path::{Path, PathBuf};

use anyhow::{Result, anyhow};
use aquafuse::depth::{DepthKind, SuppliedKind, SuppliedReport};
use aquafuse_data::depth_file::DepthFolder;
use aquafuse_data::files::display;
use aquafuse_data::pipeline::{DepthEstimator, DepthSource, DepthSupply, MapSize};
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};

use crate::args::water::WaterSource;

/// Where depth comes from, if not from colour.
#[derive(Args)]
pub(crate) struct DepthArguments {
    /// Depth map (PNG, TIFF, OpenEXR, NPY, PFM or COLMAP's .geometric.bin) of the image's size; for a folder of images, a folder of maps with
    /// the same stems. Invalid pixels are filled from valid ones beside them, and from colour (model `ratio`) beyond that. The depth of a reference image is
    /// estimated with --depth-model; only `fuse` takes a map for it (--water-depth).
    #[arg(long, value_name = "FILE")]
    depth: Option<PathBuf>,
    /// Kind of the values in --depth, which the file does not state. Larger values are farther in the first three
    /// kinds and nearer in the last two. Monocular networks give `inverse`; `disparity` has a true zero.
    #[arg(long, value_name = "KIND", value_parser = kind())]
    depth_kind: Option<SuppliedKind>,
    /// Accept maps of another size than their images, if the proportions are the same: they are scaled by nearest
    /// neighbour.
    #[arg(long, requires = "depth")]
    depth_resize: bool,
}

/// Where the depth of a reference image comes from, if not from colour.
#[derive(Args)]
pub(crate) struct WaterDepthArguments {
    /// Depth map of WATER, which must be an image: the water is estimated with it. Formats as for --depth. By default
    /// the depth of WATER is estimated with --depth-model.
    #[arg(long, value_name = "FILE")]
    water_depth: Option<PathBuf>,
    /// Kind of the values in --water-depth, as for --depth-kind.
    #[arg(long, value_name = "KIND", value_parser = kind())]
    water_depth_kind: Option<SuppliedKind>,
}

/// Every kind of depth by its name.
pub(crate) fn kind() -> impl TypedValueParser<Value = SuppliedKind> {
    PossibleValuesParser::new(SuppliedKind::ALL.iter().map(|kind| kind.name()))
        .try_map(|name| name.parse::<SuppliedKind>().map_err(|_| anyhow!("unknown kind of depth")))
}

impl DepthArguments {
    /// The unit of the depth that is used.
    pub(crate) fn kind_of_map(&self, model: &DepthEstimator) -> DepthKind {
        match (self.depth_kind, model) {
            (Some(SuppliedKind::Metres | SuppliedKind::Millimetres), _) => DepthKind::Metres,
            (None, model) => model.kind(),
            _ => DepthKind::Relative,
        }
    }

    /// Where depth comes from; `in_folder` for a folder of images. Errors are wrong usage.
    pub(crate) fn supply(&self, in_folder: bool, model: &DepthEstimator) -> Result<DepthSupply> {
        let Some((depth, kind)) = declared("--depth", self.depth.as_deref(), self.depth_kind)? else {
            return Ok(DepthSupply::Estimated(model.clone()));
        };
        let size = if self.depth_resize { MapSize::Scaled } else { MapSize::Exact };
        match (in_folder, depth.is_dir()) {
            (true, true) => Ok(DepthSupply::Folder(DepthFolder::list(depth)?, kind, size)),
            (true, false) => Err(anyhow!(
                "the images are in a folder, so --depth must be a folder too, with a map of the same stem for \
                 each image; {} is not a folder",
                display(depth)
            )),
            (false, _) => Ok(DepthSupply::File(depth.to_owned(), kind, size)),
        }
    }
}

impl WaterDepthArguments {
    /// Where the depth of the reference comes from. Errors are wrong usage.
    pub(crate) fn source(&self, water: &WaterSource, model: &DepthEstimator) -> Result<DepthSource> {
        let Some((path, kind)) =
            declared("--water-depth", self.water_depth.as_deref(), self.water_depth_kind)?
        else {
            return Ok(DepthSource::Estimated(model.clone()));
        };
        let remedy = match water {
            WaterSource::Image(_) => {
                return Ok(DepthSource::Supplied { path: path.to_owned(), kind, size: MapSize::Exact });
            }
            WaterSource::File(_) => "leave it out, or pass the map as --depth to `aquafuse water extract`",
            WaterSource::Preset(_) | WaterSource::Sea(_) => "leave it out",
        };
        Err(anyhow!(
            "--water-depth is the depth map of an image, but WATER is {}, whose water is known already; {remedy}",
            water.name()
        ))
    }
}

/// A depth map and the kind of its values, which need each other.
fn declared<'a>(
    option: &str,
    depth: Option<&'a Path>,
    kind: Option<SuppliedKind>,
) -> Result<Option<(&'a Path, SuppliedKind)>> {
    match (depth, kind) {
        (None, None) => Ok(None),
        (Some(depth), Some(kind)) => Ok(Some((depth, kind))),
        (Some(depth), None) => Err(anyhow!(
            "{} does not state the kind of its values; add {option}-kind metres, millimetres or relative (larger is \
             farther), inverse (larger is nearer, as from monocular networks) or disparity",
            display(depth)
        )),
        (None, Some(_)) => Err(anyhow!("{option}-kind has no effect without a depth map; add {option} FILE")),
    }
}

/// The warning about a map that looks inverted.
pub(crate) fn inverted(report: &SuppliedReport) -> String {
    inverted_by("--depth-kind", report.kind)
}

/// The same about the map of a network.
pub(crate) fn inverted_by_network(kind: SuppliedKind) -> String {
    let other = if kind == SuppliedKind::Inverse { "relative" } else { "inverse" };
    format!(
        "the network's depth looks inverted: pixels that are near by colour and height in the image are far in its map. If it \
         is, use --depth-model-kind {other}"
    )
}

/// The same about a map whose kind is declared by `option`.
pub(crate) fn inverted_by(option: &str, kind: SuppliedKind) -> String {
    let other = match kind {
        SuppliedKind::Inverse | SuppliedKind::Disparity => "relative",
        _ => "inverse",
    };
    format!(
        "looks inverted: pixels that are near by colour and height in the image are far in the map. If it is, use \
         {option} {other}"
    )
}
