//! `aquafuse scene export`: a trained scene for other programs.

use std::path::PathBuf;

use aquafuse_data::files::{FileError, display, make_folder_of, refuse_inputs, remove_stale_parts};
use aquafuse_scene::files::{read_splats, write_cloud, write_ply, write_splat, write_spz};
use aquafuse_scene::points::means;
use clap::Args;

use crate::args::common::Common;
use crate::failure::Failure;
use crate::report::output;

/// Write a trained scene for other programs: .splat and .spz for web viewers, .ply as published by Kerbl et al., or points.
#[derive(Args)]
#[command(after_help = "\
Examples:
  aquafuse scene export reef.ply -o reef.splat
  aquafuse scene export reef.ply -o reef.spz                a tenth of the size, with spherical harmonics
  aquafuse scene export reef.compressed.ply -o reef.ply     of SuperSplat, as other programs read it
  aquafuse scene export reef.ply -o cloud.ply --points      for programs that read points, not splats")]
pub(crate) struct Export {
    /// A trained scene: .ply, also compressed as by SuperSplat, or .spz.
    splats: PathBuf,
    /// Where to write; the extension chooses the format, .splat (no spherical harmonics), .spz or .ply.
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
        let write = match (extension.as_deref(), self.points) {
            (Some("splat"), false) => write_splat,
            (Some("spz"), false) => write_spz,
            (Some("ply"), _) => write_ply,
            (_, points) => {
                let expected = if points { ".ply" } else { ".splat, .spz or .ply" };
                return Err(FileError::UnknownExtension { path: self.output.clone(), expected }.into());
            }
        };
        refuse_inputs([self.output.as_path()], [self.splats.as_path()])?;
        let splats = read_splats(&self.splats, &common.reading.options())?;
        remove_stale_parts(make_folder_of(&self.output)?);
        let (count, what) = if self.points {
            let points = means(&splats);
            write_cloud(&self.output, &points, self.overwrite)?;
            (points.len(), "points")
        } else {
            write(&self.output, &splats, self.overwrite)?;
            (splats.len(), "splats")
        };
        let text = format!("{}: {count} {what}\n", display(&self.output));
        if common.quiet { Ok(()) } else { output::print(&text) }
    }
}
