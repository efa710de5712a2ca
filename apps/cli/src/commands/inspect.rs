//! `aquafuse inspect`: the estimated depth and water of an image.

mod report;
mod text;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::anyhow;
use aquafuse_data::drawing::{self, Captions};
use aquafuse_data::files::{FileError, display, make_folder_of, refuse_inputs, remove_stale_parts};
use aquafuse_data::image_file::{ImageFile, WriteOptions};
use aquafuse_data::pipeline::{analyse, analyse_with_evidence};
use clap::Args;
use serde_json::json;

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
    /// Images (PNG, JPEG, TIFF, WebP, BMP, GIF).
    #[arg(required = true, value_name = "IMAGE")]
    images: Vec<PathBuf>,
    #[command(flatten)]
    depth: DepthArguments,
    #[command(flatten)]
    model: DepthModelArg,
    #[command(flatten)]
    border: BorderArgument,
    /// Print JSON; of several images a line for each, with its name.
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
        if let [image] = &self.images[..] {
            return self.inspect(image, self.plot_of(image)?.as_deref(), common);
        }
        let plots = self.images.iter().map(|image| self.plot_of(image)).collect::<Result<Vec<_>, _>>()?;
        let mut named = BTreeMap::new();
        for (image, plot) in self.images.iter().zip(&plots) {
            if let Some(other) = plot.as_ref().and_then(|plot| named.insert(plot, image)) {
                return Err(Failure::usage(anyhow!(
                    "{} and {} would have plots of the same name; rename one of them",
                    display(other),
                    display(image)
                )));
            }
        }
        let mut failed = 0;
        for (image, plot) in self.images.iter().zip(&plots) {
            if let Err(failure) = self.inspect(image, plot.as_deref(), common) {
                output::complain(&failure);
                failed += 1;
            }
        }
        match failed {
            0 => Ok(()),
            failed => Err(Failure::work(anyhow!("{failed} of {} images failed", self.images.len()))),
        }
    }

    /// Inspects one image.
    fn inspect(&self, image: &Path, plot: Option<&Path>, common: &Common) -> Result<(), Failure> {
        let reading = &self.border.cutting(common).reading;
        let image_file = reading.read(image)?;
        let supply = self.depth.supply(self.images.len() > 1, &self.model.get()?).map_err(Failure::usage)?;
        let source = supply.of(image).map_err(Failure::usage)?;
        let (found, evidence) = match &plot {
            Some(_) => {
                analyse_with_evidence(&image_file, &source).map(|(found, seen)| (found, Some(seen)))?
            }
            None => (analyse(&image_file, &source)?, None),
        };
        if let (Some(path), Some(evidence)) = (plot, &evidence) {
            let name = image.file_name().unwrap_or_default();
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
            let json = match self.images.len() {
                1 => serde_json::to_string_pretty(&report).map_err(Failure::work)?,
                // A line for each, with its name.
                _ => {
                    let named = json!({ "image": display(image).to_string(), "report": report });
                    named.to_string()
                }
            };
            return output::print_json(&format!("{json}\n"));
        }
        let name = match self.images.len() {
            1 => String::new(),
            _ => format!("{}:\n", display(image)),
        };
        output::print(&(name + &text::text(&image_file, &found, plot)))
    }

    fn plot_of(&self, image: &Path) -> Result<Option<PathBuf>, Failure> {
        self.plots.as_deref().map(|folder| self.plot_in(folder, image)).transpose()
    }

    /// The file of the plot; refused before any work if it exists and must not be replaced.
    fn plot_in(&self, folder: &Path, image: &Path) -> Result<PathBuf, Failure> {
        let mut name = image.file_stem().unwrap_or_default().to_owned();
        name.push(".inspect.png");
        let path = folder.join(name);
        refuse_inputs([path.as_path()], self.images.iter().map(PathBuf::as_path))?;
        if !self.overwrite && path.symlink_metadata().is_ok() {
            return Err(FileError::Exists { path }.into());
        }
        Ok(path)
    }
}
