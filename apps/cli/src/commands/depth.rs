//! `aquafuse depth`: an image's depth as a file.

use std::path::PathBuf;

use aquafuse::depth::SuppliedKind;
use aquafuse_data::depth_file;
use aquafuse_data::files::{make_folder_of, refuse_inputs, remove_stale_parts};
use aquafuse_data::image_file::WriteOptions;
use clap::Args;

use crate::args::depth::inverted_by_network;
use crate::args::depth_model::DepthModelArg;
use crate::args::reading::Reading;
use crate::failure::Failure;
use crate::report::output;

/// Estimate depth and write it to a file.
///
/// Evaluates the model at each pixel. The image then refines the result: it is smooth where the image is smooth and
/// has edges where the image has edges. The result is relative depth: 0 is near, larger is farther. All models fail without red light: everything then looks far.
///
/// The file is for other programs. Do not pass it back as --depth: it would be treated as measured depth. The other
/// commands estimate depth from colour themselves. Values often use only half of the range; `inspect --plots` shows
/// them stretched.
#[derive(Args)]
pub(crate) struct Depth {
    /// An image (PNG, JPEG, TIFF, WebP, BMP, GIF).
    image: PathBuf,
    /// Output file: .png (16-bit grey, 65535 is the farthest possible), .tiff, .exr, .npy or .pfm (floats, 1 is the
    /// farthest possible). A missing folder is created.
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    #[command(flatten)]
    model: DepthModelArg,
    /// Replace an existing OUT.
    #[arg(long)]
    overwrite: bool,
}

impl Depth {
    pub(crate) fn run(&self, reading: &Reading, quiet: bool) -> Result<(), Failure> {
        refuse_inputs([self.output.as_path()], [self.image.as_path()])?;
        let image_file = reading.read(&self.image)?;
        let options = WriteOptions { overwrite: self.overwrite, ..WriteOptions::default() };
        remove_stale_parts(make_folder_of(&self.output)?);
        let (depth, report) = self.model.get()?.depth(&image_file, &image_file.bytes())?;
        depth_file::write(&self.output, &depth, &options)?;
        if report.is_some_and(|report| report.looks_inverted()) {
            let kind = report.map_or(SuppliedKind::Inverse, |report| report.kind);
            output::print(&format!("  WARNING: {}\n", inverted_by_network(kind)))?;
        }
        output::written(&self.output, quiet)
    }
}
