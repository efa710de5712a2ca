//! `aquafuse scene export`: a trained scene for other programs.

use std::path::PathBuf;

use aquafuse_data::files::{FileError, display, make_folder_of, refuse_inputs, remove_stale_parts};
use aquafuse_scene::files::{read_ply, write_cloud, write_ply, write_splat};
use aquafuse_scene::points::means;
use clap::Args;

use crate::args::common::Common;
use crate::failure::Failure;
use crate::report::output;

/// Write a trained scene for other programs: .splat for web viewers, .ply as published by Kerbl et al., or points.
#[derive(Args)]
#[command(after_help = "\
Examples:
  aquafuse scene export reef.ply -o reef.splat
  aquafuse scene export reef.ply -o cloud.ply --points      for programs that read points, not splats")]
pub(crate) struct Export {
    /// A trained scene.
    splats: PathBuf,
    /// Where to write; the extension chooses the format, .splat (no spherical harmonics) or .ply.
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    /// Write points instead of splats, as .ply: the means of splats with an opacity of at least 0.5.
    #[arg(long)]
    points: bool,
    /// Replace an existing OUT.
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
        refuse_inputs([self.output.as_path()], [self.splats.as_path()])?;
        let splats = read_ply(&self.splats, &common.reading.options())?;
        remove_stale_parts(make_folder_of(&self.output)?);
        let (count, what) = if self.points {
            let points = means(&splats);
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
