//! `aquafuse bag`: the cameras of a robot's log, fused, restored or enhanced.

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
  aquafuse bag dive.mcap --restore -o clear_dive.mcap --topic /camera/image_raw";

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

#[cfg(feature = "bag")]
mod with_logs {
    use std::fmt::Write;
    use std::path::PathBuf;

    use anyhow::anyhow;
    use aquafuse::depth::DepthKind;
    use aquafuse_data::bag::{self, Request, Summary};
    use aquafuse_data::files::display;
    use aquafuse_data::pipeline::{Operation, PixelEncoding};
    use aquafuse_data::video::Recipe;

    use super::Bag;
    use crate::args::common::Common;
    use crate::args::depth_model::of_colour;
    use crate::args::water::WaterSource;
    use crate::failure::Failure;
    use crate::report::output;
    use crate::report::progress::Progress;

    impl Bag {
        pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
            let common = &self.settings.cutting(&self.border, common);
            let water = self.water.as_deref().map(WaterSource::parse).transpose()?;
            let recipe = self.recipe(water.as_ref(), common)?;
            let mut request = Request::new(&self.input, &self.output);
            request.inputs =
                water.as_ref().and_then(WaterSource::path).map(PathBuf::from).into_iter().collect();
            request.topics.clone_from(&self.topics);
            request.overwrite = self.overwrite;
            let progress = Progress::new(common.quiet);
            let ended = bag::change(&request, &recipe, &common.run_options(), &mut || progress.done(""));
            progress.finish();
            let summary = ended.map_err(Failure::work)?;
            if !common.quiet {
                output::print(&self.text(&summary))?;
            }
            self.outcome(&summary)
        }

        fn recipe(&self, water: Option<&WaterSource>, common: &Common) -> Result<Recipe, Failure> {
            let mut settings = self.settings.get()?;
            let depth_model = of_colour(std::mem::take(&mut settings.depth_model), "bag")?;
            let operation = match water {
                None if self.restore => Operation::Restore {
                    options: self.max_gain.options(),
                    levels: self.levels.options(),
                    encoding: PixelEncoding::Encoded,
                },
                None => Operation::Enhance { levels: self.levels.options() },
                Some(water) => {
                    self.waters.refuse_unread(settings.options.model)?;
                    let file = self.waters.read(
                        water,
                        &depth_model.into(),
                        PixelEncoding::Encoded,
                        &common.reading,
                    )?;
                    let reference = self.waters.per(DepthKind::Relative, &file)?;
                    Operation::Fuse { reference, options: settings.options }
                }
            };
            Ok(Recipe {
                depth_model,
                smoothing: settings.smoothing,
                border: common.reading.border,
                water_map: common.reading.water_map,
                steady_over: self.steady_over.into(),
                ..Recipe::new(operation)
            })
        }

        fn text(&self, summary: &Summary) -> String {
            let mut text = format!("{}: {} messages\n", display(&self.output), summary.messages);
            for topic in &summary.topics {
                let _ = write!(text, "  {}  {} changed", topic.name, topic.changed);
                if let Some(reason) = &topic.kept_for {
                    let _ = write!(text, ", {} kept as they are: {reason}", topic.kept);
                }
                text.push('\n');
            }
            text
        }

        fn outcome(&self, summary: &Summary) -> Result<(), Failure> {
            if let Some(cause) = &summary.cut {
                return Err(Failure::work(anyhow!(
                    "{} is cut short: {cause}. Its {} whole messages are in {}",
                    display(&self.input),
                    summary.messages,
                    display(&self.output)
                )));
            }
            let Some((topic, fault)) =
                summary.topics.iter().find_map(|topic| Some((topic, topic.fault.as_ref()?)))
            else {
                return Ok(());
            };
            Err(Failure::work(anyhow!(
                "{} messages of {} in {} are damaged and were copied as they are; the first: {fault}",
                topic.damaged,
                topic.name,
                display(&self.input)
            )))
        }
    }
}
