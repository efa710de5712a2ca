//! `aquafuse simulate`: an image taken in air, with its depth, as it would look under water.

use std::path::PathBuf;

use aquafuse::depth::{DepthKind, DepthModel, SuppliedKind};
use aquafuse::formation::form;
use aquafuse::image::{Encoded, Image, Linear};
use aquafuse_data::files::{FileError, display, make_folder_of, remove_stale_parts};
use aquafuse_data::image_file::{Format, ImageFile, Pixels, WRITTEN, WriteOptions};
use aquafuse_data::pipeline::Space;
use aquafuse_data::pipeline::{DepthSource, analyse};
use clap::Args;

use crate::args::common::Common;
use crate::args::depth::{inverted, kind};
use crate::args::water::{WaterArguments, WaterSource};
use crate::failure::Failure;
use crate::report::output;

/// Bytes of a pixel that is lit, formed and encoded in floats, beside what is read and written.
const BYTES_OF_FLOATS: u64 = 56;

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
    /// Its depth map (PNG, TIFF, OpenEXR, NPY, PFM), of the image's size. Invalid pixels are filled from colour, which
    /// is a guess in air; the command prints their share.
    depth: PathBuf,
    /// The water: preset:NAME from `water list`, NAME.water.json from `water extract`, or an image.
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
        match self.linear {
            true => self.run_in::<Linear>(common),
            false => self.run_in::<Encoded>(common),
        }
    }

    fn run_in<E: Space>(&self, common: &Common) -> Result<(), Failure> {
        let written = Format::written(&self.output);
        let unknown = || FileError::UnknownExtension { path: self.output.clone(), expected: WRITTEN };
        let format = written.ok_or_else(unknown)?;
        if !self.overwrite && self.output.symlink_metadata().is_ok() {
            return Err(FileError::Exists { path: self.output.clone() }.into());
        }
        let water = WaterSource::parse(&self.water)?;
        let opened = ImageFile::open(&self.image, &common.reading.options())?;
        opened.memory_until_written(format, opened.pixels().saturating_mul(BYTES_OF_FLOATS))?;
        let mut image_file = opened.decode()?;
        let supplied = DepthSource::Supplied { path: self.depth.clone(), kind: self.depth_kind };
        let found = analyse::<E>(&image_file, &supplied)?;
        let file = self.waters.read::<E>(&water, DepthModel::default(), &common.reading)?;
        let seen_through = self.waters.per(found.depth.kind(), &file)?.water;

        let light = match &water {
            WaterSource::Preset(preset) if !self.keep_light => {
                preset.derive::<Linear>(&self.waters.conditions()?).white
            }
            _ => [1.0; 3],
        };
        let lit = lit(&image_file.pixels, light);
        let (width, height) = lit.size();
        let clear = lit.pixels().iter().flatten().map(|&value| E::from_encoded(value)).collect();
        let clear = Image::<f32, E>::from_raw(width, height, clear).map_err(Failure::work)?;
        let formed = form(&clear, &found.depth, &seen_through).map_err(Failure::work)?.to_encoded();
        match &mut image_file.pixels {
            Pixels::Bytes(layers) => layers.image = formed.to_samples(),
            Pixels::Words(layers) => layers.image = formed.to_samples(),
            Pixels::Floats(layers) => layers.image = formed.to_samples(),
        }
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
            if report.looks_turned_round() {
                text += &format!("  WARNING: {} {}\n", display(&self.depth), inverted(&report));
            }
        }
        output::print(&text)
    }
}

/// The image as lit by this light, relative to the light it was taken in.
fn lit(pixels: &Pixels, light: [f32; 3]) -> Image<f32> {
    let image = match pixels {
        Pixels::Bytes(layers) => layers.image.to_unit(),
        Pixels::Words(layers) => layers.image.to_unit(),
        Pixels::Floats(layers) => layers.image.to_unit(),
    };
    if light == [1.0; 3] {
        return image;
    }
    let mut linear = image.to_linear();
    for pixel in linear.pixels_mut() {
        for c in 0..3 {
            pixel[c] *= light[c];
        }
    }
    linear.to_encoded()
}
