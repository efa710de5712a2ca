//! `aquafuse water`: waterbodies as files and as presets.

mod show;

use std::fmt::Write;
use std::path::PathBuf;

use anyhow::anyhow;
use aquafuse::image::Encoded;
use aquafuse::waterbody::presets::Preset;
use aquafuse_data::files::{display, make_folder_of, remove_stale_parts};
use aquafuse_data::pipeline::{DepthSupply, WaterEstimate, analyse_in};
use aquafuse_data::water_file::WaterFile;
use clap::{Args, Subcommand};
use show::Show;

use crate::args::border::BorderArgument;
use crate::args::common::{Common, encoding};
use crate::args::depth::DepthArguments;
use crate::args::depth_model::DepthModelArg;
use crate::args::water::WaterArguments;
use crate::failure::Failure;
use crate::report::output;
use crate::report::water::{hex, veiling_light};

/// Save the water of an image to a file, list presets, and show waters.
#[derive(Args)]
pub(crate) struct Water {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Extract(Extract),
    List(List),
    Show(Show),
}

/// Write the water of one image, or of several images of the same water, to a file.
#[derive(Args)]
#[command(after_help = "\
With several images, each number is the median, weighted by the certainty of each image.

Examples:
  aquafuse water extract harbour.jpg -o harbour.water.json
  aquafuse fuse reef.jpg harbour.water.json -o fused.jpg")]
struct Extract {
    /// Images of the same water.
    #[arg(required = true)]
    images: Vec<PathBuf>,
    /// Output file, NAME.water.json; a missing folder is created.
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    #[command(flatten)]
    border: BorderArgument,
    #[command(flatten)]
    depth: DepthArguments,
    #[command(flatten)]
    model: DepthModelArg,
    /// Estimate in linear light instead of encoded values, for `fuse --linear` and other commands with --linear.
    #[arg(long)]
    linear: bool,
    /// Replace an existing OUT.
    #[arg(long)]
    overwrite: bool,
}

/// List the presets, which other commands take as preset:NAME. Drawn waters, sea:NUMBER, are not listed.
#[derive(Args)]
struct List {
    #[command(flatten)]
    waters: WaterArguments,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

impl Water {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        match &self.command {
            Command::Extract(extract) => extract.run(common),
            Command::List(list) => list.run(),
            Command::Show(show) => show.run(common),
        }
    }
}

impl Extract {
    fn run(&self, common: &Common) -> Result<(), Failure> {
        let common = &self.border.cutting(common);
        let mut estimates = Vec::new();
        let mut kind = None;
        let supply = self.supply()?;
        for path in &self.images {
            let source = supply.of(path).map_err(Failure::usage)?;
            let found = analyse_in(encoding(self.linear), &common.reading.read(path)?, &source)?;
            kind = Some(found.depth.kind());
            if !common.quiet {
                output::print(&format!("{}: {}\n", display(path), veiling_light(&found.estimate)))?;
            }
            estimates.push(found.estimate);
        }
        let nothing = || Failure::usage(anyhow!("name an image"));
        let file = WaterFile {
            from: self.images.iter().map(|path| display(path).to_string()).collect(),
            depth_kind: kind.ok_or_else(nothing)?,
            estimate: WaterEstimate::pool(&estimates).ok_or_else(nothing)?,
        };
        remove_stale_parts(make_folder_of(&self.output)?);
        file.write(&self.output, self.overwrite)?;
        output::written(&self.output, common.quiet)
    }

    /// Where the depth of each image comes from: with several, --depth is a folder.
    fn supply(&self) -> Result<DepthSupply, Failure> {
        self.depth.supply(self.images.len() > 1, &self.model.get()?).map_err(Failure::usage)
    }
}

impl List {
    fn run(&self) -> Result<(), Failure> {
        let conditions = self.waters.conditions()?;
        if self.json {
            let all =
                Preset::ALL.iter().map(|preset| show::preset_json(*preset, &conditions)).collect::<Vec<_>>();
            return output::print(&format!("{:#}\n", serde_json::json!({ "schema": 1, "presets": all })));
        }
        let mut text =
            format!("{:<20}{:<10}{:<20}{:<20}\n", "name", "colour", "veiling light B∞", "beta_B per metre");
        for &preset in Preset::ALL {
            let water = preset.water::<Encoded>(&conditions);
            let ([r, g, b], [x, y, z]) = (water.veiling_light.rgb(), water.backscatter_coefficient);
            let name = format!("preset:{}", preset.name());
            let _ = writeln!(
                text,
                "{name:<20}{:<10}{:<20}{:<20}",
                hex([r, g, b]),
                format!("{r:.2} {g:.2} {b:.2}"),
                format!("{x:.2} {y:.2} {z:.2}")
            );
        }
        text += "\nValues of red, green and blue, for the water types of Jerlov: oceans from clear to turbid, then coasts. The camera\n";
        let _ = writeln!(
            text,
            "is {}; the scene is {} m below the surface. `aquafuse water show preset:NAME` lists the sources.",
            self.waters.white(),
            self.waters.below_surface()
        );
        output::print(&text)
    }
}
