//! `aquafuse depth`: an image's depth as a file.

use std::path::PathBuf;

use aquafuse_data::depth_file;
use aquafuse_data::files::{display, make_folder_of, remove_stale_parts};
use aquafuse_data::image_file::WriteOptions;
use clap::Args;

use crate::args::depth_model::DepthModelArg;
use crate::args::reading::Reading;
use crate::failure::Failure;
use crate::report::output;

/// Estimate depth from colour and write it as a file.
///
/// The model at each pixel, then a 7x7 median: relative depth, 0 near, larger farther. All models fail
/// where red is dead: everything then looks far.
///
/// For other programs. Given back as --depth it would be believed as a map that was measured, and water be told
/// from it by stricter rules; our own commands take depth from colour by themselves. Half of its range is often
/// unused: `inspect --plots` shows it stretched.
#[derive(Args)]
pub(crate) struct Depth {
    /// PNG, JPEG, TIFF, WebP, BMP or GIF.
    image: PathBuf,
    /// Where to write: .png (16-bit grey, 65535 = farthest possible), .tiff, .exr, .npy or .pfm (floats, 1 =
    /// farthest possible); a missing folder is made.
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    #[command(flatten)]
    model: DepthModelArg,
    /// Replace OUT if it exists.
    #[arg(long)]
    overwrite: bool,
}

impl Depth {
    pub(crate) fn run(&self, reading: &Reading, quiet: bool) -> Result<(), Failure> {
        let image_file = reading.read(&self.image)?;
        let options = WriteOptions { overwrite: self.overwrite, ..WriteOptions::default() };
        remove_stale_parts(make_folder_of(&self.output)?);
        let depth = image_file.pixels.depth(&self.model.get(), image_file.top_edge());
        depth_file::write(&self.output, &depth, &options)?;
        if quiet { Ok(()) } else { output::print(&format!("{}: written\n", display(&self.output))) }
    }
}
