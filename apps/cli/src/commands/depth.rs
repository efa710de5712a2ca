//! `aquafuse depth`: an image's depth as a file.

use std::path::PathBuf;

use aquafuse_data::depth_file;
use aquafuse_data::files::{make_folder_of, refuse_inputs, remove_stale_parts};
use aquafuse_data::image_file::WriteOptions;
use clap::Args;

use crate::args::depth_model::DepthModelArg;
use crate::args::reading::Reading;
use crate::failure::Failure;
use crate::report::output;

/// Estimate depth from colour and write it to a file.
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
        let depth = image_file.pixels.depth(&self.model.get(), image_file.top_edge());
        depth_file::write(&self.output, &depth, &options)?;
        output::written(&self.output, quiet)
    }
}
