//! `aquafuse scene export`: a trained scene for other programs.

use std::path::PathBuf;

use aquafuse_data::files::{FileError, display, make_folder_of, remove_stale_parts};
use aquafuse_scene::files::{read_ply, write_cloud, write_ply, write_splat};
use aquafuse_scene::points::middles;
use clap::Args;

use crate::args::common::Common;
use crate::failure::Failure;
use crate::report::output;

/// Write a trained scene for other programs: .splat for viewers on the web, .ply as it is published, or points.
#[derive(Args)]
#[command(after_help = "\
Examples:
  aquafuse scene export reef.ply -o reef.splat
  aquafuse scene export reef.ply -o cloud.ply --points      for programs that know points and no splats")]
pub(crate) struct Export {
    /// A trained scene.
    splats: PathBuf,
    /// Where to write; the name says the format, .splat (no harmonics) or .ply.
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    /// Points instead of splats, to a .ply: the middles of those that hide at least half of what is behind them.
    #[arg(long)]
    points: bool,
    /// Replace OUT if it exists.
    #[arg(long)]
    overwrite: bool,
}

impl Export {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        let extension = self.output.extension().map(|extension| extension.to_string_lossy().to_lowercase());
        let is_splat = match (extension.as_deref(), self.points) {
            (Some("splat"), false) => true,
            (Some("ply"), _) => false,
            (_, points) => {
                let expected = if points { ".ply" } else { ".splat or .ply" };
                return Err(FileError::UnknownExtension { path: self.output.clone(), expected }.into());
            }
        };
        let splats = read_ply(&self.splats)?;
        remove_stale_parts(make_folder_of(&self.output)?);
        let (count, what) = if self.points {
            let points = middles(&splats);
            write_cloud(&self.output, &points, self.overwrite)?;
            (points.len(), "points")
        } else {
            let write = if is_splat { write_splat } else { write_ply };
            write(&self.output, &splats, self.overwrite)?;
            (splats.len(), "splats")
        };
        let text = format!("{}: {count} {what}\n", display(&self.output));
        if common.quiet { Ok(()) } else { output::print(&text) }
    }
}
