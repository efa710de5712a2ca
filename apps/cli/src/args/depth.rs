//! `--depth` and `--depth-kind`: depth that comes with an image.

use std::path::PathBuf;

use anyhow::{Result, anyhow};
use aquafuse::depth::{DepthKind, DepthModel, SuppliedKind, SuppliedReport};
use aquafuse_data::depth_file::DepthFolder;
use aquafuse_data::files::display;
use aquafuse_data::pipeline::DepthSupply;
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};

/// Where depth comes from, if not from colour.
#[derive(Args)]
pub(crate) struct DepthArguments {
    /// Depth map (PNG, TIFF, OpenEXR, NPY or PFM) of the image's size; for a folder of images, a folder of maps with
    /// the same stems. Invalid pixels are filled from colour (model `ratio`). The depth of a reference image is
    /// always estimated with --depth-model.
    #[arg(long, value_name = "FILE")]
    depth: Option<PathBuf>,
    /// Kind of the values in --depth, which the file does not state. Larger values are farther in the first three
    /// kinds and nearer in the last two. Monocular networks give `inverse`; `disparity` has a true zero.
    #[arg(long, value_name = "KIND", value_parser = kind())]
    depth_kind: Option<SuppliedKind>,
}

/// Every kind of depth by its name.
pub(crate) fn kind() -> impl TypedValueParser<Value = SuppliedKind> {
    PossibleValuesParser::new(SuppliedKind::ALL.iter().map(|kind| kind.name()))
        .try_map(|name| name.parse::<SuppliedKind>().map_err(|_| anyhow!("unknown kind of depth")))
}

impl DepthArguments {
    /// The unit of the depth that is used.
    pub(crate) fn kind_of_map(&self) -> DepthKind {
        match self.depth_kind {
            Some(SuppliedKind::Metres | SuppliedKind::Millimetres) => DepthKind::Metres,
            _ => DepthKind::Relative,
        }
    }

    /// Where depth comes from; `in_folder` for a folder of images. Errors are wrong usage.
    pub(crate) fn supply(&self, in_folder: bool, model: DepthModel) -> Result<DepthSupply> {
        let (depth, kind) = match (&self.depth, self.depth_kind) {
            (None, None) => return Ok(DepthSupply::Estimated(model)),
            (Some(depth), Some(kind)) => (depth, kind),
            (Some(depth), None) => {
                return Err(anyhow!(
                    "{} does not state the kind of its values; add --depth-kind metres, millimetres or relative (larger \
                     is farther), inverse (larger is nearer, as from monocular networks) or disparity",
                    display(depth)
                ));
            }
            (None, Some(_)) => {
                return Err(anyhow!("--depth-kind has no effect without a depth map; add --depth FILE"));
            }
        };
        match (in_folder, depth.is_dir()) {
            (true, true) => Ok(DepthSupply::Folder(DepthFolder::list(depth)?, kind)),
            (true, false) => Err(anyhow!(
                "the images are in a folder, so --depth must be a folder too, with a map of the same stem for \
                 each image; {} is not a folder",
                display(depth)
            )),
            (false, _) => Ok(DepthSupply::File(depth.clone(), kind)),
        }
    }
}

/// The warning about a map that looks inverted.
pub(crate) fn inverted(report: &SuppliedReport) -> String {
    let other = match report.kind {
        SuppliedKind::Inverse | SuppliedKind::Disparity => "relative",
        _ => "inverse",
    };
    format!(
        "looks inverted: pixels that are near by colour and height in the image are far in the map. If it is, use \
         --depth-kind {other}"
    )
}
