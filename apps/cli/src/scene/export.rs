//! `aquafuse scene export`: a trained scene for other programs.

use std::path::PathBuf;

use aquafuse_data::picture::{FileError, remove_stale_parts, shown};
use aquafuse_scene::files::{read_ply, write_ply, write_splat};
use clap::Args;

use crate::common::Common;
use crate::failure::Failure;
use crate::output;

/// Write a trained scene for other programs: .splat for viewers on the web, .ply as it is published.
#[derive(Args)]
#[command(after_help = "Example:\n  aquafuse scene export reef.ply -o reef.splat")]
pub(crate) struct Export {
    /// A trained scene.
    splats: PathBuf,
    /// Where to write; the name says the format, .splat (no harmonics) or .ply.
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    /// Replace OUT if it exists.
    #[arg(long)]
    overwrite: bool,
}

impl Export {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        let extension = self.output.extension().map(|extension| extension.to_string_lossy().to_lowercase());
        let write = match extension.as_deref() {
            Some("splat") => write_splat,
            Some("ply") => write_ply,
            _ => {
                let path = self.output.clone();
                return Err(FileError::UnknownExtension { path, expected: ".splat or .ply" }.into());
            }
        };
        let splats = read_ply(&self.splats)?;
        remove_stale_parts(output::make_folder_of(&self.output)?);
        write(&self.output, &splats, self.overwrite)?;
        let text = format!("{}: {} splats\n", shown(&self.output), splats.len());
        if common.quiet { Ok(()) } else { output::print(&text) }
    }
}
