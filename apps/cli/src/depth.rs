//! `aquafuse depth`: a picture's depth as a file.

use std::path::PathBuf;

use aquafuse_data::depth_file;
use aquafuse_data::picture::{Picture, WriteOptions};
use clap::Args;

use crate::depth_model::DepthModelArg;
use crate::failure::Failure;
use crate::output;

/// Estimate depth from colour and write it as a file.
///
/// The model at each pixel, then a 7x7 median: relative depth, 0 near, larger farther. All models fail
/// where red is dead: everything then looks far.
#[derive(Args)]
pub(crate) struct Depth {
    /// PNG or JPEG, 8 bits a channel, without transparency.
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
    pub(crate) fn run(&self, quiet: bool) -> Result<(), Failure> {
        let picture = Picture::read(&self.image)?;
        let options = WriteOptions { overwrite: self.overwrite, ..WriteOptions::default() };
        output::make_folder_of(&self.output)?;
        let depth = self.model.get().estimate_seen(&picture.image, picture.top_edge());
        depth_file::write(&self.output, &depth, &options)?;
        if quiet { Ok(()) } else { output::print(&format!("{}: written\n", self.output.display())) }
    }
}
