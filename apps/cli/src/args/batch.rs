//! Options of `fuse`, `restore` and `enhance`: where outputs go, and how they are written.

use std::path::{Path, PathBuf};

use aquafuse::stream::Steady;
use aquafuse_data::batch::{Plan, Recipe, Request};
use aquafuse_data::files::FileError;
use aquafuse_data::pipeline::{DepthEstimator, Operation, PixelEncoding};
use clap::Args;

use crate::args::border::BorderArgument;
use crate::args::common::encoding;
use crate::args::depth::DepthArguments;
use crate::args::failures::FailureArguments;
use crate::failure::Failure;

/// What is read, and where and how the outputs are written.
#[derive(Args)]
pub(crate) struct BatchArguments {
    /// Output file, or output folder (required for a folder of images, or for several). Missing folders are created. The extension
    /// selects the format: .png and .tif keep 16 bits and transparency, .webp is lossless, .jpg is 4:4:4.
    #[arg(short, long, value_name = "OUT")]
    pub(crate) output: PathBuf,
    /// Also enter the folders in CONTENT, except hidden ones and links. Outputs are in folders of the same names, and so
    /// must be the maps of --depth.
    #[arg(long)]
    pub(crate) recursive: bool,
    #[command(flatten)]
    pub(crate) depth: DepthArguments,
    #[command(flatten)]
    pub(crate) border: BorderArgument,
    /// JPEG quality, 1 to 100.
    #[arg(long, value_name = "Q", default_value_t = 95, value_parser = clap::value_parser!(u8).range(1..=100))]
    pub(crate) quality: u8,
    /// Rotate each output by its EXIF orientation. By default pixels keep their stored order, so that labels stay
    /// valid, and the orientation tag is copied.
    #[arg(long)]
    pub(crate) upright: bool,
    /// Replace existing outputs.
    #[arg(long)]
    pub(crate) overwrite: bool,
    #[command(flatten)]
    pub(crate) failures: FailureArguments,
    /// Print one JSON object per image instead of the summary.
    #[arg(long)]
    pub(crate) json: bool,
    /// Write maps of each image to this folder: STEM.depth.png (16 bits; relative depth: 65535 is 1, metric depth: one
    /// step is 1 mm), STEM.backscatter.png, STEM.illumination.png and STEM.change.png (mid grey: no change). `fuse` and
    /// `enhance` (which needs CLEAR for maps) also write STEM.factor.npy: the depth factor F that the fusion used at each pixel, as an array of
    /// 32-bit floats of shape (height, width, 3), after all safety bounds.
    #[arg(long, value_name = "DIR")]
    pub(crate) maps: Option<PathBuf>,
    /// Take the images of a folder for frames of one sequence, in the order of their names: water and levels are means over about so
    /// many frames (8 without a number), so that the outputs do not flicker. A scene cut begins again.
    #[arg(
        long,
        value_name = "FRAMES",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = STEADY_OVER,
        value_parser = clap::value_parser!(u16).range(1..),
        conflicts_with = "maps",
    )]
    sequence: Option<u16>,
    /// Write the settings, the waters and a record of each image to this JSON file.
    #[arg(long, value_name = "FILE.json")]
    pub(crate) report: Option<PathBuf>,
    /// Compute in linear light. By default, as in the paper, values are used as the camera encoded them. Depth from
    /// colour is always estimated from encoded values.
    #[arg(long)]
    linear: bool,
}

/// [`Steady::FRAMES`], in words.
const STEADY_OVER: &str = "8";
const _: () = assert!(Steady::FRAMES == 8, "the help says 8");

impl BatchArguments {
    /// An operation, written as these arguments say.
    pub(crate) fn recipe(&self, operation: Operation) -> Recipe {
        Recipe {
            upright: self.upright,
            quality: self.quality,
            steady_over: self.sequence.map(usize::from),
            ..Recipe::new(operation)
        }
    }

    /// The encoding to work in.
    pub(crate) fn encoding(&self) -> PixelEncoding {
        encoding(self.linear)
    }

    /// Plans the run, and refuses what can be refused before an image is read.
    pub(crate) fn plan(
        &self,
        contents: &[PathBuf],
        inputs: &[&Path],
        model: &DepthEstimator,
        scores: bool,
    ) -> Result<Plan, Failure> {
        let depth = self.depth.supply(is_many(contents), model).map_err(Failure::usage)?;
        let plan = Plan::new(&Request {
            contents,
            recursive: self.recursive,
            output: &self.output,
            inputs,
            depth: &depth,
            maps: self.maps.as_deref(),
            scores,
            overwrite: self.overwrite,
        });
        let plan = plan.map_err(Failure::usage)?;
        plan.refuse_taken(self.report.as_deref())?;
        match &self.report {
            Some(report) if !self.overwrite && report.symlink_metadata().is_ok() => {
                Err(FileError::Exists { path: report.clone() }.into())
            }
            _ => Ok(plan),
        }
    }
}

/// Whether outputs go to a folder.
fn is_many(contents: &[PathBuf]) -> bool {
    !matches!(contents, [content] if !content.is_dir())
}
