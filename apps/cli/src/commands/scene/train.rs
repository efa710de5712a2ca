//! `aquafuse scene train`: splats from images with cameras.

mod brush;

use std::path::PathBuf;

use anyhow::anyhow;
use aquafuse_data::files::{Claim, FileError, display};
use aquafuse_data::run::Event;
use aquafuse_scene::medium::Medium;
use aquafuse_scene::model::Model;
use aquafuse_scene::train::Options;
use aquafuse_scene::training::{Plan, Request, Training, TrainingError};
use clap::{Args, ValueEnum};

use crate::args::common::Common;
use crate::failure::Failure;
use crate::report::output;
use crate::report::progress::Progress;
use brush::Brush;

/// Train splats on a scene's images.
///
/// To continue a run that was stopped, repeat the command: it ends in the same file, byte for byte.
#[derive(Args)]
#[command(after_help = "\
Examples:
  aquafuse scene train reef/ -o reef.ply
  aquafuse scene train reef/ -o reef.ply --water learn --iterations 4000 --longest 640
  aquafuse scene train reef/ -o reef.ply --hold 8        score every eighth image, train on the rest
  aquafuse scene train reef/ -o reef.ply --engine brush  on a graphics card, by an installed Brush")]
pub(crate) struct Train {
    /// A folder with cameras and images.
    scene: PathBuf,
    /// Output file, FILE.ply; a learned water goes to FILE.water.json.
    #[arg(short, long, value_name = "FILE.ply")]
    output: PathBuf,
    /// The folder of the images [default: SCENE/images, or SCENE where there is none].
    #[arg(long, value_name = "DIR")]
    images: Option<PathBuf>,
    /// Training steps, each of one image.
    #[arg(long, value_name = "N", default_value_t = Options::default().iterations, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    iterations: u32,
    /// Random seed.
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
    /// Spherical-harmonics degree, 0 to 3 (0: no view dependence).
    #[arg(long, value_name = "D", default_value_t = 0, value_parser = clap::value_parser!(u8).range(0..=3))]
    sh_degree: u8,
    /// Medium: `none` bakes the water into the colours, `learn` estimates it.
    #[arg(long, value_name = "WHAT", value_enum, default_value_t)]
    water: WaterInside,
    /// Train without the images that are not there.
    #[arg(long)]
    skip_missing: bool,
    /// Maximum number of splats. Time and memory grow with it.
    #[arg(long, value_name = "N", default_value_t = 100_000, value_parser = clap::value_parser!(u32).range(1..=100_000_000))]
    splats: u32,
    /// Images are scaled down to this many pixels on their longer side.
    #[arg(long, value_name = "PIXELS", default_value_t = 400, value_parser = clap::value_parser!(u32).range(16..=65535))]
    longest: u32,
    /// Training backend.
    #[arg(long, value_name = "WHAT", value_enum, default_value_t)]
    engine: Trainer,
    /// Path of the Brush program [default: brush, or brush_app].
    #[arg(long, value_name = "PROGRAM")]
    brush: Option<PathBuf>,
    /// Hold every Nth image out of training, and score the result on them.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..))]
    hold: Option<u32>,
    /// Replace FILE.ply if it exists, and start training from the beginning.
    #[arg(long)]
    overwrite: bool,
}

/// `--water`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum WaterInside {
    #[default]
    None,
    Learn,
}

/// `--engine`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum Trainer {
    /// The built-in trainer, on the CPU.
    #[default]
    Cpu,
    /// Brush, an external program for graphics cards, which must be installed; it learns no water and cannot resume.
    Brush,
}

impl Train {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        super::say_model(&self.scene, common);
        let options = common.run_options();
        let plan = Plan::new(self.request(), &options.reading)?;
        let brush = self.brush()?;
        let training = plan.load(&options)?;
        // Now, not at the end: a second run to this output would work for hours and be refused then.
        let _claim = Claim::of(&self.output)?;
        if !self.overwrite && self.output.symlink_metadata().is_ok() {
            return Err(FileError::Exists { path: self.output.clone() }.into());
        }
        let model = match &brush {
            Some(brush) => brush.train(&training, &options.reading)?,
            None => {
                let progress = Progress::new(common.quiet);
                let ended = training.run(&options, &|event| match event {
                    Event::Started { total } => progress.start(total),
                    Event::Done { result, .. } => {
                        progress.done(&format!("{} splats, loss {:.4}", result.splats, result.loss));
                    }
                    Event::Skipped { .. } => progress.done(""),
                    _ => {}
                });
                progress.finish();
                ended?
            }
        };
        training.write(&model)?;
        if brush.is_some() {
            Brush::clear(&training);
        }
        if common.quiet { Ok(()) } else { output::print(&summary(&training, &model)) }
    }

    fn request(&self) -> Request {
        Request {
            scene: self.scene.clone(),
            images: self.images.clone(),
            skip_missing: self.skip_missing,
            output: self.output.clone(),
            options: Options {
                iterations: self.iterations,
                seed: self.seed,
                max_splats: self.splats as usize,
                ..Options::default()
            },
            sh_degree: self.sh_degree,
            learns_water: self.water == WaterInside::Learn,
            longest: self.longest as usize,
            hold_out: self.hold.map(|every| every as usize),
            overwrite: self.overwrite,
        }
    }

    /// The external engine, if it was asked for.
    fn brush(&self) -> Result<Option<Brush>, Failure> {
        match (self.engine, self.water) {
            (Trainer::Cpu, _) => Ok(None),
            (Trainer::Brush, WaterInside::Learn) => Err(Failure::usage(anyhow!(
                "--engine brush cannot learn a water; leave out --water learn or --engine brush"
            ))),
            (Trainer::Brush, WaterInside::None) => Brush::find(self.brush.as_deref()).map(Some),
        }
    }
}

fn summary(training: &Training, model: &Model) -> String {
    let output = display(&training.request().output);
    let mut text = format!("{output}: {} splats{}\n", model.splats.len(), training.unused());
    if let Medium::Learned(water) = &model.medium {
        let three = |values: [f32; 3]| values.map(|value| format!("{value:.3}")).join(" ");
        text += &format!(
            "  water: B∞ {}, beta_B {}, beta_D {} per unit of the scene\n",
            three(water.veil()),
            three(water.backscatter()),
            three(water.attenuation())
        );
    }
    if let Some(scores) = training.held_out_scores(model) {
        text += &format!(
            "  {} images held out: PSNR {:.2} dB, SSIM {:.3}\n",
            scores.views, scores.psnr, scores.ssim
        );
    }
    text
}

impl From<TrainingError> for Failure {
    fn from(error: TrainingError) -> Self {
        match error {
            TrainingError::File(error) => error.into(),
            TrainingError::Cameras(error) => error.into(),
            TrainingError::Images(error) => error.into(),
            TrainingError::Model(error) => error.into(),
            TrainingError::Memory { .. }
            | TrainingError::NothingToTrainOn
            | TrainingError::Checkpoint { .. }
            | TrainingError::Water(_) => Self::usage(error),
            error => Self::work(error),
        }
    }
}
