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
    /// Take depth from this file (PNG, TIFF, OpenEXR, NPY, PFM), of the image's size; for a folder of images, a
    /// folder of such files with the same stems. Where it holds no valid value, colour tells (by
    /// `ratio`). The depth of a reference always comes from colour, by --depth-model.
    #[arg(long, value_name = "FILE")]
    depth: Option<PathBuf>,
    /// What the values of --depth are, which no file says. Larger is farther in the first three, nearer in the last
    /// two; `inverse` is what monocular networks give, `disparity` has a true zero.
    #[arg(long, value_name = "KIND", value_parser = kind())]
    depth_kind: Option<SuppliedKind>,
}

/// Every kind of depth by its name.
pub(crate) fn kind() -> impl TypedValueParser<Value = SuppliedKind> {
    PossibleValuesParser::new(SuppliedKind::ALL.iter().map(|one| one.name()))
        .try_map(|name| name.parse::<SuppliedKind>().map_err(|_| anyhow!("there is no kind of that name")))
}

impl DepthArguments {
    /// What the unit of depth will be.
    pub(crate) fn kind_of_map(&self) -> DepthKind {
        match self.depth_kind {
            Some(SuppliedKind::Metres | SuppliedKind::Millimetres) => DepthKind::Metres,
            _ => DepthKind::Relative,
        }
    }

    /// Where depth comes from; `in_folder` where it is that of a folder's images. Errors are wrong usage.
    pub(crate) fn supply(&self, in_folder: bool, model: DepthModel) -> Result<DepthSupply> {
        let (depth, kind) = match (&self.depth, self.depth_kind) {
            (None, None) => return Ok(DepthSupply::Estimated(model)),
            (Some(depth), Some(kind)) => (depth, kind),
            (Some(depth), None) => {
                return Err(anyhow!(
                    "{} does not say what its values are; add --depth-kind metres, millimetres or relative (larger \
                     is farther), inverse (larger is nearer, as monocular networks give it) or disparity",
                    display(depth)
                ));
            }
            (None, Some(_)) => return Err(anyhow!("--depth-kind says what --depth is; add --depth FILE")),
        };
        match (in_folder, depth.is_dir()) {
            (true, true) => Ok(DepthSupply::Folder(DepthFolder::list(depth)?, kind)),
            (true, false) => Err(anyhow!(
                "the images stand in a folder, so --depth must be a folder too, with a map of the same stem for \
                 each; {} is none",
                display(depth)
            )),
            (false, _) => Ok(DepthSupply::File(depth.clone(), kind)),
        }
    }
}

/// What to say of a map that looks inverted.
pub(crate) fn inverted(report: &SuppliedReport) -> String {
    let other = match report.kind {
        SuppliedKind::Inverse | SuppliedKind::Disparity => "relative",
        _ => "inverse",
    };
    format!(
        "looks inverted: what colour and height in the image call near is far in it; is it rather `{other}`?"
    )
}
