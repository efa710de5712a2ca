//! `aquafuse scene fuse`: all images of a scene in another water, by the one water that they share.

use std::path::PathBuf;

use aquafuse::depth::DepthKind;
use aquafuse::fusion::Model;
use aquafuse_data::batch::Recipe;
use aquafuse_data::files::display;
use aquafuse_data::pipeline::{Operation, Outcome, PixelEncoding};
use aquafuse_scene::fuse::{FuseError, Fused, Plan, Request};
use clap::Args;

use crate::args::common::Common;
use crate::args::fusion::{Settings, SettingsArgs};
use crate::args::water::{WaterArguments, WaterSource};
use crate::failure::Failure;
use crate::report::output;
use crate::report::progress::Progress;
use crate::report::summary::bounds;
use crate::report::water::veiling_light;

/// Fuse all images of a scene with another water, by the one water that they share.
///
/// Depth is scaled by the sparse points, so the result is consistent across views. Names, sizes and EXIF stay, and the
/// cameras are copied: the new folder is a scene like the old one. To continue a run that was stopped, repeat the command.
#[derive(Args)]
#[command(after_help = "\
Example:
  aquafuse scene fuse reef/ green.jpg -o reef_green/")]
pub(crate) struct Fuse {
    /// A folder with cameras and images.
    scene: PathBuf,
    /// The reference water: an image, NAME.water.json, preset:NAME or sea:NUMBER.
    water: PathBuf,
    /// Output folder; created if missing.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    #[command(flatten)]
    settings: SettingsArgs,
    #[command(flatten)]
    waters: WaterArguments,
    /// Fuse the scene without the images that are not there.
    #[arg(long)]
    skip_missing: bool,
    /// Write into a folder that is not empty, and replace images of the same names.
    #[arg(long)]
    overwrite: bool,
}

impl Fuse {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        let Settings { depth_model, options, smoothing, .. } = self.settings.get()?;
        self.waters.refuse_unread(options.model)?;
        let water = WaterSource::parse(&self.water)?;
        super::say_model(&self.scene, common);
        let (scene, output, depth_model) = (&self.scene, &self.output, &depth_model);
        let inputs = [self.water.as_path()];
        let (inputs, skip_missing, overwrite) = (&inputs[..], self.skip_missing, self.overwrite);
        let reading = &common.reading.options();
        let plan =
            Plan::new(&Request { scene, output, depth_model, inputs, reading, skip_missing, overwrite })?;
        let file = self.waters.read(&water, depth_model, PixelEncoding::Encoded, &common.reading)?;
        let reference = self.waters.per(DepthKind::Metres, &file)?;
        let recipe = Recipe { smoothing, ..Recipe::new(Operation::Fuse { reference, options }) };

        let progress = Progress::new(common.quiet);
        let fused = plan.run(&recipe, &common.run_options(), &|event| {
            progress.show(&event, |path| display(path).to_string());
        });
        progress.finish();
        let fused = fused?;
        if common.quiet {
            return Ok(());
        }
        output::print(&format!(
            "{}: {} images in {}'s water{}\n  {}\n  {}\n{}",
            display(output),
            plan.items().len(),
            water.name(),
            plan.unused(),
            veiling_light(&fused.shared.water.into()),
            match fused.shared.unit {
                Some(unit) => format!("relative depth 1 is {unit:.2} units of the scene"),
                None => "the scene has no points, so that depth has no unit".into(),
            },
            held_back(&fused, options.model)
        ))
    }
}

/// How much the images changed, and if it is little, why and what helps.
fn held_back(fused: &Fused, model: Model) -> String {
    let Some(change) = fused.change else { return String::new() };
    let mut text = format!("  colours changed by {change:.1} ΔE on average\n");
    if fused.limited.any() {
        text += &format!("  limited by safety bounds: {}\n", bounds(fused.limited));
    }
    if !fused.shared.shows_open_water() {
        text += "  no open water is exchanged as such, because most images do not surely show any: images that do help\n";
    }
    if change < Outcome::UNCHANGED {
        let helps = match model {
            Model::Exchange => "a reference in another water",
            _ => "another reference, `--model exchange`, or another `--depth-model`",
        };
        text += &format!("  that is hardly visible; what helps: {helps}\n");
    }
    text
}

impl From<FuseError> for Failure {
    fn from(error: FuseError) -> Self {
        match error {
            FuseError::File(error) => error.into(),
            FuseError::Cameras(error) => error.into(),
            FuseError::Images(error) => error.into(),
            FuseError::Filled { .. } | FuseError::Input { .. } | FuseError::Water(_) => Self::usage(error),
            error => Self::work(error),
        }
    }
}
