//! `aquafuse simulate`: an image taken in air, with its depth, as it would look under water.

use std::path::PathBuf;

use aquafuse::depth::{DepthKind, DepthModel, SuppliedKind};
use aquafuse::image::Linear;
use aquafuse_data::files::{FileError, display, make_folder_of, refuse_inputs, remove_stale_parts};
use aquafuse_data::image_file::{Format, ImageFile, WRITTEN, WriteOptions};
use aquafuse_data::pipeline::{DepthSource, MapSize, SIMULATED, analyse_in, simulate};
use clap::Args;

use crate::args::common::{Common, encoding};
use crate::args::depth::{inverted, kind};
use crate::args::water::{WaterArguments, WaterSource};
use crate::failure::Failure;
use crate::report::output;

const HELP: &str = "\
Evaluates Eq. 1 of the paper at each pixel: U = I e^(-beta_D z) + B_inf (1 - e^(-beta_B z)). With
a preset, the scene is also lit by the daylight that reaches it (--below-surface), unless
--keep-light is given.

Example:
  aquafuse simulate room.jpg room_depth.png preset:jerlov-3C -o dived.png --depth-kind millimetres";

/// Put an image taken in air, with its depth map, under water.
#[derive(Args)]
#[command(after_help = HELP)]
pub(crate) struct Simulate {
    /// The image, taken in air.
    image: PathBuf,
    /// Its depth map (PNG, TIFF, OpenEXR, NPY, PFM), of the image's size. Invalid pixels are filled from valid ones
    /// beside them, and from colour, which is a guess in air; the command prints their share.
    depth: PathBuf,
    /// The water: preset:NAME from `water list`, sea:NUMBER, NAME.water.json from `water extract`, or an image.
    water: PathBuf,
    /// Output file; the extension selects the format.
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    /// Kind of the values in DEPTH, as in `fuse`.
    #[arg(long, value_name = "KIND", value_parser = kind())]
    depth_kind: SuppliedKind,
    #[command(flatten)]
    waters: WaterArguments,
    /// Compute in linear light: physically more accurate.
    #[arg(long)]
    linear: bool,
    /// Keep the light on the scene; add only the water between camera and scene.
    #[arg(long)]
    keep_light: bool,
    /// JPEG quality, 1 to 100.
    #[arg(long, value_name = "Q", default_value_t = 95, value_parser = clap::value_parser!(u8).range(1..=100))]
    quality: u8,
    /// Replace an existing OUT.
    #[arg(long)]
    overwrite: bool,
}

impl Simulate {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        let encoding = encoding(self.linear);
        let written = Format::written(&self.output);
        let unknown = || FileError::UnknownExtension { path: self.output.clone(), expected: WRITTEN };
        let format = written.ok_or_else(unknown)?;
        if !self.overwrite && self.output.symlink_metadata().is_ok() {
            return Err(FileError::Exists { path: self.output.clone() }.into());
        }
        let water = WaterSource::parse(&self.water)?;
        let inputs = [Some(self.image.as_path()), Some(self.depth.as_path()), water.path()];
        refuse_inputs([self.output.as_path()], inputs.into_iter().flatten())?;
        let opened = ImageFile::open(&self.image, &common.reading.options())?;
        opened.memory_until_written(format, opened.pixels().saturating_mul(SIMULATED))?;
        let mut image_file = opened.decode()?;
        let supplied =
            DepthSource::Supplied { path: self.depth.clone(), kind: self.depth_kind, size: MapSize::Exact };
        let found = analyse_in(encoding, &image_file, &supplied)?;
        let file = self.waters.read(&water, &DepthModel::default().into(), encoding, &common.reading)?;
        let seen_through = self.waters.per(found.depth.kind(), &file)?;
        let light = match &water {
            WaterSource::Preset(preset) if !self.keep_light => {
                preset.derive::<Linear>(&self.waters.conditions()?).white
            }
            _ => [1.0; 3],
        };
        simulate(&mut image_file.pixels, &found.depth, &seen_through, light).map_err(Failure::work)?;
        remove_stale_parts(make_folder_of(&self.output)?);
        image_file.write(&self.output, &WriteOptions { overwrite: self.overwrite, quality: self.quality })?;
        if common.quiet {
            return Ok(());
        }
        let unit = if found.depth.kind() == DepthKind::Metres { "m" } else { "of relative depth" };
        let far = found.depth.percentile(0.95);
        let mut text =
            format!("{}: written; objects are up to {far:.2} {unit} away\n", display(&self.output));
        if let Some(report) = found.supplied {
            if report.invalid > 0 {
                let share = 100.0 * report.invalid_share();
                text += &format!("  {share:.1} % of the pixels have no valid depth\n");
            }
            if report.looks_inverted() {
                text += &format!("  WARNING: {} {}\n", display(&self.depth), inverted(&report));
            }
        }
        output::print(&text)
    }
}
