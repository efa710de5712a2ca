//! `aquafuse bag`: the cameras of a robot's log, fused, restored or enhanced.

#[cfg(feature = "bag")]
mod with_logs;

use std::path::PathBuf;

use clap::{ArgGroup, Args};

use crate::args::border::BorderArgument;
#[cfg(not(feature = "bag"))]
use crate::args::common::Common;
use crate::args::fusion::SettingsArgs;
use crate::args::levels::LevelsArguments;
use crate::args::max_gain::MaxGain;
use crate::args::water::WaterArguments;
#[cfg(not(feature = "bag"))]
use crate::failure::Failure;

const HELP: &str = "\
A log is a file of MCAP, as ROS 2 and Foxglove write it. Images of sensor_msgs (Image, CompressedImage; cdr and
ros1) and foxglove.CompressedImage are changed, each topic as a sequence. Grey images, depth and Bayer patterns
stay. Everything else is copied byte for byte: other topics, schemas, times, attachments, metadata.

A log that is cut short is written as far as its messages are whole, and the exit code is 1.

This command is part of programs built with `--features bag`, which needs a compiler of C.

Examples:
  aquafuse bag dive.mcap green.jpg -o green_dive.mcap
  aquafuse bag dive.mcap --restore -o clear_dive.mcap --topic /camera/image_raw
  aquafuse bag dive.mcap preset:jerlov-3C -o green_dive.mcap --model exchange --depth-topic /camera/depth";

/// Put the images in a robot's log into another water, restore or enhance them.
#[derive(Args)]
#[command(
    after_help = HELP,
    group = ArgGroup::new("clear").args(["restore", "enhance"]),
    group = ArgGroup::new("fusion")
        .args(["water", "model", "theta", "alpha", "smooth", "as_published"])
        .multiple(true)
        .conflicts_with("clear"),
    group = ArgGroup::new("levels").args(["white", "exposure", "strength"]).multiple(true).requires("clear"),
    group = ArgGroup::new("area").args(["border", "water_map"]).multiple(true).conflicts_with("as_published"),
)]
pub(crate) struct Bag {
    /// The log, NAME.mcap.
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// The reference water: an image (best with open water in view), NAME.water.json from `water extract`,
    /// preset:NAME from `water list`, or sea:NUMBER, a drawn water.
    #[arg(required_unless_present_any = ["restore", "enhance"])]
    water: Option<PathBuf>,
    /// The log to write.
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    /// Remove the water, as `restore` does, instead of exchanging it.
    #[arg(long)]
    restore: bool,
    /// Set the levels, as `enhance` does, instead of exchanging the water.
    #[arg(long)]
    enhance: bool,
    /// Change the images of this topic alone; repeat it for several [default: every topic with images].
    #[arg(long = "topic", value_name = "TOPIC")]
    topics: Vec<String>,
    #[command(flatten)]
    settings: SettingsArgs,
    #[command(flatten)]
    levels: LevelsArguments,
    #[command(flatten)]
    max_gain: MaxGain,
    #[command(flatten)]
    waters: WaterArguments,
    #[command(flatten)]
    border: BorderArgument,
    /// Water and levels are means over about so many images of a topic. 1: each by itself.
    #[arg(long, value_name = "IMAGES", default_value_t = 8, value_parser = clap::value_parser!(u16).range(1..))]
    steady_over: u16,
    /// Take the depth of images from this topic: 16UC1 in millimetres, 32FC1 in metres, or PNG of 16 bits, of the size of the images.
    /// Without it depth is estimated from colour.
    #[arg(long, value_name = "TOPIC", conflicts_with_all = ["enhance", "depth_model", "as_published"])]
    depth_topic: Option<String>,
    /// How far the times of an image and its depth may be apart. Images without depth stay as they are.
    #[arg(long, value_name = "MILLISECONDS", default_value_t = 50, requires = "depth_topic", value_parser = clap::value_parser!(u32).range(0..=60_000))]
    depth_within: u32,
    /// Replace an existing output.
    #[arg(long)]
    overwrite: bool,
}

#[cfg(not(feature = "bag"))]
impl Bag {
    #[allow(clippy::unused_self, reason = "as where there are logs")]
    pub(crate) fn run(&self, _: &Common) -> Result<(), Failure> {
        Err(Failure::usage(anyhow::anyhow!(
            "this program was built without logs of robots; build it with `cargo install --path apps/cli --features bag`"
        )))
    }
}
