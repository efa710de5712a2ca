//! What `fuse`, `restore` and `enhance` take: where outputs go, and how they are written.

use std::path::{Path, PathBuf};

use aquafuse::depth::DepthModel;
use aquafuse_data::batch::{Plan, Request};
use aquafuse_data::files::FileError;
use aquafuse_data::pipeline::PixelEncoding;
use clap::Args;

use crate::args::common::encoding;
use crate::args::depth::DepthArguments;
use crate::args::failures::FailureArguments;
use crate::failure::Failure;

/// What is read, and where and how the outputs are written.
#[derive(Args)]
pub(crate) struct BatchArguments {
    /// Where to write: a file or a folder for an image, a folder for a folder. Missing folders are made. The name says
    /// the format: .png and .tif keep 16 bits and transparency, .webp is lossless, .jpg is 4:4:4.
    #[arg(short, long, value_name = "OUT")]
    pub(crate) output: PathBuf,
    #[command(flatten)]
    pub(crate) depth: DepthArguments,
    /// JPEG quality, 1 to 100.
    #[arg(long, value_name = "Q", default_value_t = 95, value_parser = clap::value_parser!(u8).range(1..=100))]
    pub(crate) quality: u8,
    /// Turn outputs as their EXIF orientation asks for. By default pixels stay as stored, so that labels do too, and
    /// the orientation is carried over.
    #[arg(long)]
    pub(crate) upright: bool,
    /// Replace images that exist.
    #[arg(long)]
    pub(crate) overwrite: bool,
    #[command(flatten)]
    pub(crate) failures: FailureArguments,
    /// Print one JSON object an image, for programs, instead of the summary.
    #[arg(long)]
    pub(crate) json: bool,
    /// Write what each image is made from into this folder, as images: STEM.depth.png (16 bits: 65535 is the
    /// farthest, or one millimetre a step), .backscatter, .illumination and .change (mid grey: nothing).
    #[arg(long, value_name = "DIR")]
    pub(crate) maps: Option<PathBuf>,
    /// Write settings, waters and a record of each image into this file, as JSON.
    #[arg(long, value_name = "FILE.json")]
    pub(crate) report: Option<PathBuf>,
    /// Work in linear light instead of the encoded values that cameras write, which the paper works on. Depth from
    /// colour is always estimated from encoded values.
    #[arg(long)]
    linear: bool,
}

impl BatchArguments {
    /// The encoding to work in.
    pub(crate) fn encoding(&self) -> PixelEncoding {
        encoding(self.linear)
    }

    /// Plans the run, and refuses what can be refused before an image is read.
    pub(crate) fn plan(
        &self,
        content: &Path,
        inputs: &[&Path],
        model: DepthModel,
        scores: bool,
    ) -> Result<Plan, Failure> {
        let depth = self.depth.supply(content.is_dir(), model).map_err(Failure::usage)?;
        let plan = Plan::new(&Request {
            content,
            output: &self.output,
            inputs,
            depth: &depth,
            maps: self.maps.as_deref(),
            scores,
            overwrite: self.overwrite,
        });
        let plan = plan.map_err(Failure::usage)?;
        match &self.report {
            Some(report) if !self.overwrite && report.symlink_metadata().is_ok() => {
                Err(FileError::Exists { path: report.clone() }.into())
            }
            _ => Ok(plan),
        }
    }
}
