//! `aquafuse inspect`: the estimated depth and water of an image.

mod report;
mod text;

use std::path::{Path, PathBuf};

use aquafuse_data::drawing::{self, Captions};
use aquafuse_data::files::{FileError, display, make_folder_of, remove_stale_parts};
use aquafuse_data::image_file::{ImageFile, WriteOptions};
use aquafuse_data::pipeline::{analyse, analyse_with_evidence};
use clap::Args;

use crate::args::border::BorderArgument;
use crate::args::common::Common;
use crate::args::depth::DepthArguments;
use crate::args::depth_model::DepthModelArg;
use crate::failure::Failure;
use crate::report::output;
use crate::report::water::veiling_light_in_short;
use report::Report;

/// Show the estimated depth and water of an image.
///
/// `fuse` uses the same estimates: depth z, the veiling light B∞ (the colour of open water), the backscatter
/// coefficient β_B and the attenuation coefficient β_D. The product β z at the far end is the optical thickness of
/// the water: 0.1 is thin, 1 is thick, 3 hides nearly everything.
#[derive(Args)]
// With depth given no model is needed here; `fuse` still needs it, for its reference.
#[command(mut_arg("depth_model", |model| model.conflicts_with("depth")), after_help = crate::report::doubts::explained())]
pub(crate) struct Inspect {
    /// An image (PNG, JPEG, TIFF, WebP, BMP, GIF).
    image: PathBuf,
    #[command(flatten)]
    depth: DepthArguments,
    #[command(flatten)]
    model: DepthModelArg,
    #[command(flatten)]
    border: BorderArgument,
    /// Print JSON.
    #[arg(long)]
    json: bool,
    /// Also draw DIR/STEM.inspect.png: depth, the pixels that give the veiling light, the samples and curves of β_B
    /// and β_D, the transmittance, and the image without its water. A missing DIR is created.
    #[arg(long, value_name = "DIR")]
    plots: Option<PathBuf>,
    /// Replace an existing file of --plots.
    #[arg(long, requires = "plots")]
    overwrite: bool,
}

impl Inspect {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        let reading = &self.border.cutting(common).reading;
        let plot = self.plots.as_deref().map(|folder| self.plot_in(folder)).transpose()?;
        let image_file = reading.read(&self.image)?;
        let supply = self.depth.supply(false, self.model.get()).map_err(Failure::usage)?;
        let source = supply.of(&self.image).map_err(Failure::usage)?;
        let (found, evidence) = match &plot {
            Some(_) => {
                analyse_with_evidence(&image_file, &source).map(|(found, seen)| (found, Some(seen)))?
            }
            None => (analyse(&image_file, &source)?, None),
        };
        if let (Some(path), Some(evidence)) = (&plot, &evidence) {
            let name = self.image.file_name().unwrap_or_default();
            let captions = Captions {
                name: &display(name.as_ref()).to_string(),
                veiling_light: &veiling_light_in_short(&found.estimate),
            };
            let figure =
                drawing::estimates(captions, &image_file, &found, evidence).map_err(Failure::work)?;
            let options = WriteOptions { overwrite: self.overwrite, ..WriteOptions::default() };
            remove_stale_parts(make_folder_of(path)?);
            ImageFile::new(figure).write(path, &options)?;
        }
        if self.json {
            let report = Report::new(&image_file, &found);
            let json = serde_json::to_string_pretty(&report).map_err(Failure::work)?;
            output::print(&format!("{json}\n"))
        } else {
            output::print(&text::text(&image_file, &found, plot.as_deref()))
        }
    }

    /// The file of the plot; refused before any work if it exists and must not be replaced.
    fn plot_in(&self, folder: &Path) -> Result<PathBuf, Failure> {
        let mut name = self.image.file_stem().unwrap_or_default().to_owned();
        name.push(".inspect.png");
        let path = folder.join(name);
        if !self.overwrite && path.symlink_metadata().is_ok() {
            return Err(FileError::Exists { path }.into());
        }
        Ok(path)
    }
}
