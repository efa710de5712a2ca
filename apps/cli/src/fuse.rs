//! `aquafuse fuse`: a picture, or a folder of them, in another picture's water.

mod plan;
mod summary;

use std::path::PathBuf;
use std::sync::Mutex;

use anyhow::anyhow;
use aquafuse::fusion::{Gain, Incidence, Model, Options};
use aquafuse_data::analysis::{DepthSource, analyse};
use aquafuse_data::job::{self, Message};
use aquafuse_data::picture::{Picture, WriteOptions};
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};

use crate::depth_arguments::DepthArguments;
use crate::depth_model::DepthModelArg;
use crate::failure::Failure;
use crate::inspect::veiling_light;
use crate::output;
use crate::progress::Progress;

/// Put a picture, or a folder of them, into another picture's water.
#[derive(Args)]
#[command(after_help = MODELS)]
pub(crate) struct Fuse {
    /// The objects: a picture (PNG or JPEG, 8 bits a channel), or a folder of pictures.
    /// Folders inside it are not entered.
    content: PathBuf,
    /// The reference: the picture whose water is taken. Best one with open water in view.
    water: PathBuf,
    /// Where to write: a file or a folder for a picture, a folder for a folder. Missing folders are made.
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    /// What is exchanged: `aquafuse` is subtle, `physical` is what people expect to see.
    #[arg(long, default_value = Model::default().name(), value_parser = model())]
    model: Model,
    /// Strength, as an angle of light from 0 (most) to 90 (none) degrees [default: 45; physical: 0].
    #[arg(long, value_name = "DEG", value_parser = incidence, allow_negative_numbers = true)]
    theta: Option<Incidence>,
    /// Gain on the reference's water, 0 or more; above 1 it is brighter than it was [default: 1].
    #[arg(long, value_name = "A", value_parser = gain, allow_negative_numbers = true)]
    alpha: Option<Gain>,
    #[command(flatten)]
    depth: DepthArguments,
    #[command(flatten)]
    depth_model: DepthModelArg,
    /// JPEG quality, 1 to 100.
    #[arg(long, value_name = "Q", default_value_t = 95, value_parser = clap::value_parser!(u8).range(1..=100))]
    quality: u8,
    /// Replace pictures that exist.
    #[arg(long)]
    overwrite: bool,
}

const MODELS: &str = "\
Models. D is the difference of the two waters' colours (alpha times WATER's less CONTENT's),
F falls with distance from 1 at the camera to 0 in open water:
  aquafuse   adds cos(theta) F (1 - F) D: a veil over the middle distance, the paper's method
  physical   adds cos(theta) (1 - F) D: the whole veil; open water takes the other water's colour

Example:
  aquafuse fuse reef.jpg green.jpg -o fused.jpg --model physical --theta 30";

fn model() -> impl TypedValueParser<Value = Model> {
    PossibleValuesParser::new(Model::ALL.map(Model::name))
        .map(|name| Model::from_name(&name).unwrap_or_default())
}

fn incidence(text: &str) -> anyhow::Result<Incidence> {
    Ok(Incidence::from_degrees(text.parse().map_err(|_| anyhow!("not a number"))?)?)
}

fn gain(text: &str) -> anyhow::Result<Gain> {
    Ok(Gain::new(text.parse().map_err(|_| anyhow!("not a number"))?)?)
}

impl Fuse {
    pub(crate) fn run(&self, quiet: bool) -> Result<(), Failure> {
        let model = self.depth_model.get();
        let supply = self.depth.supply(self.content.is_dir(), model).map_err(Failure::usage)?;
        let items = plan::items(&self.content, &self.water, &self.output, &supply).map_err(Failure::usage)?;
        if !self.overwrite {
            plan::refuse_existing(&items).map_err(Failure::usage)?;
        }
        let reference = analyse(&Picture::read(&self.water)?, &DepthSource::Estimated(model))?.estimate;
        // All outputs of a run stand in one folder.
        if let Some(first) = items.first() {
            output::make_folder_of(&first.output)?;
        }
        let job = job::Fuse {
            items,
            water: reference.water,
            options: self.options(),
            writing: WriteOptions { overwrite: self.overwrite, quality: self.quality },
        };
        let progress = Progress::new(quiet || job.items.len() == 1);
        let reports = Mutex::new(Vec::new());
        let summary = job.run(&|message| {
            progress.show(&message);
            if let (Message::Done { item, report }, Ok(mut reports)) = (&message, reports.lock()) {
                reports.push(((*item).clone(), *report));
            }
        });
        progress.finish();
        let mut reports = reports.into_inner().unwrap_or_default();
        reports.sort_by(|(a, _), (b, _)| a.output.cmp(&b.output));
        if !quiet {
            let water = format!("{}: {}\n", self.water.display(), veiling_light(&reference));
            output::print(&(water + &summary::of(&reports)))?;
        }
        match (summary.failed, job.items.len()) {
            (0, _) => Ok(()),
            (failed, all) => {
                Err(Failure::work(anyhow!("{failed} of {all} failed; the messages above say why")))
            }
        }
    }

    fn options(&self) -> Options {
        let defaults = Options::for_model(self.model);
        Options {
            incidence: self.theta.unwrap_or(defaults.incidence),
            gain: self.alpha.unwrap_or(defaults.gain),
            ..defaults
        }
    }
}
