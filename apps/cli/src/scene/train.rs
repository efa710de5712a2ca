//! `aquafuse scene train`: splats from pictures with cameras.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use anyhow::anyhow;
use aquafuse::image::Encoded;
use aquafuse::metrics::{psnr, ssim};
use aquafuse_data::analysis::{DepthSource, analyse};
use aquafuse_data::picture::{FileError, Picture, remove_stale_parts, shown, write_bytes};
use aquafuse_scene::camera::Camera;
use aquafuse_scene::capture::{self, Capture, Shown};
use aquafuse_scene::compare::picture;
use aquafuse_scene::lens::Lens;
use aquafuse_scene::medium::{Medium, Water};
use aquafuse_scene::points;
use aquafuse_scene::render::render;
use aquafuse_scene::shared_water::{in_scene, median, to_learn, unit_of, water_of};
use aquafuse_scene::train::loss::Target;
use aquafuse_scene::train::{Options, Shot, Trainer, extent};
use clap::{Args, ValueEnum};

use super::splats_file::{Trained, check_name, water_beside};
use crate::common::Common;
use crate::failure::Failure;
use crate::output;
use crate::progress::Progress;

/// Train splats on a scene's pictures.
///
/// One that was stopped goes on where it was: the same command ends in the same file, byte for byte.
#[derive(Args)]
#[command(after_help = "\
Examples:
  aquafuse scene train reef/ -o reef.ply
  aquafuse scene train reef/ -o reef.ply --water learn --iterations 4000 --longest 640
  aquafuse scene train reef/ -o reef.ply --hold 8        score every eighth picture, train on the rest")]
pub(crate) struct Train {
    /// A folder with cameras and pictures.
    scene: PathBuf,
    /// Where to write, FILE.ply; a learned water goes to FILE.water.json.
    #[arg(short, long, value_name = "FILE.ply")]
    output: PathBuf,
    /// The folder of the pictures [default: SCENE/images, or SCENE where there is none].
    #[arg(long, value_name = "DIR")]
    images: Option<PathBuf>,
    /// Steps, each of one picture.
    #[arg(long, value_name = "N", default_value_t = Options::default().iterations, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    iterations: u32,
    /// Replays a run.
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
    /// How much colours may depend on the direction, 0 (not at all) to 3.
    #[arg(long, value_name = "D", default_value_t = 0, value_parser = clap::value_parser!(u8).range(0..=3))]
    sh_degree: u8,
    /// What is between the camera and things: `none` leaves the water in the colours, `learn` finds it.
    #[arg(long, value_name = "WHAT", value_enum, default_value_t)]
    water: WaterInside,
    /// The most splats: time and memory grow with them.
    #[arg(long, value_name = "N", default_value_t = Options::default().most_splats)]
    splats: usize,
    /// Pictures are scaled down to this many pixels on their longer side.
    #[arg(long, value_name = "PIXELS", default_value_t = 400, value_parser = clap::value_parser!(u32).range(16..=65535))]
    longest: u32,
    /// Hold every Nth picture back, and say how near it comes.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..))]
    hold: Option<u32>,
    /// Replace FILE.ply if it exists, and begin anew.
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

/// Points to begin with where the model has none.
const SCATTERED: usize = 10_000;
/// How often a run notes where it is.
const NOTED_EVERY: Duration = Duration::from_secs(10);

impl Train {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        self.check()?;
        let pictures = self.images.clone().unwrap_or_else(|| capture::pictures_of(&self.scene));
        let taken = capture::read(&self.scene, &pictures, self.longest as usize, &common.reading.options())?;
        let held = |i: usize| self.hold.is_some_and(|every| i.is_multiple_of(every as usize));
        let (held, shown): (Vec<_>, Vec<_>) = taken.shown.iter().enumerate().partition(|(i, _)| held(*i));
        let (held, trained_on): (Vec<&Shown>, Vec<&Shown>) =
            (held.into_iter().map(|(_, one)| one).collect(), shown.into_iter().map(|(_, one)| one).collect());
        if trained_on.is_empty() {
            return Err(Failure::usage(anyhow!("--hold leaves no picture to train on; raise it")));
        }
        let mut trainer = self.trainer(&taken, &trained_on)?;
        self.train(&mut trainer, common.quiet)?;

        let trained = Trained { splats: trainer.splats().clone(), medium: trainer.medium() };
        trained.write(&self.output, &self.scene, self.overwrite)?;
        // It has done its duty; one that stays is only found to be of a finished run.
        let _ = std::fs::remove_file(self.checkpoint());
        if common.quiet { Ok(()) } else { output::print(&self.told(&trained, &held)) }
    }

    /// Refuses what can be refused before work begins.
    fn check(&self) -> Result<(), Failure> {
        check_name(&self.output)?;
        // A water that lies there would be taken for that of the new splats, learned or not.
        let outputs = [self.output.clone(), water_beside(&self.output)];
        if let Some(path) =
            outputs.into_iter().find(|path| !self.overwrite && path.symlink_metadata().is_ok())
        {
            return Err(FileError::Exists { path }.into());
        }
        remove_stale_parts(output::make_folder_of(&self.output)?);
        Ok(())
    }

    fn options(&self) -> Options {
        Options {
            iterations: self.iterations,
            seed: self.seed,
            most_splats: self.splats,
            ..Options::default()
        }
    }

    /// Where a run that is under way is noted.
    fn checkpoint(&self) -> PathBuf {
        let mut name = self.output.clone().into_os_string();
        name.push(".checkpoint");
        name.into()
    }

    /// A new run, or the one that was stopped.
    fn trainer(&self, taken: &Capture, trained_on: &[&Shown]) -> Result<Trainer, Failure> {
        let shots: Vec<Shot> = trained_on
            .iter()
            .map(|one| Shot {
                camera: one.camera.clone(),
                target: Target::new(one.camera.width, one.camera.height, one.picture.pixels()),
            })
            .collect();
        let path = self.checkpoint();
        if !self.overwrite && path.is_file() {
            let read = std::fs::read(&path).map_err(|error| FileError::Read { path: path.clone(), error })?;
            return Trainer::resume(self.options(), shots, &read)
                .map_err(|error| Failure::usage(anyhow!("cannot go on from {}: {error}", shown(&path))));
        }
        let cameras: Vec<&Camera> = trained_on.iter().map(|one| &one.camera).collect();
        let begin = match taken.points.is_empty() {
            true => &points::scattered(&cameras, extent(&cameras), SCATTERED, self.seed),
            false => &taken.points,
        };
        let splats = points::splats(begin, self.sh_degree);
        let water = match self.water {
            WaterInside::None => None,
            WaterInside::Learn => Some(first_guess(trained_on, &taken.points, extent(&cameras))?),
        };
        Ok(Trainer::new(self.options(), shots, splats, water))
    }

    fn train(&self, trainer: &mut Trainer, quiet: bool) -> Result<(), Failure> {
        let progress = Progress::new(quiet);
        progress.start(self.iterations as usize);
        let mut noted = Instant::now();
        for _ in 0..trainer.steps() {
            progress.done(String::new());
        }
        while !trainer.is_done() {
            let loss = trainer.step();
            progress.done(format!("{} splats, loss {:.4}", trainer.splats().len(), loss.total));
            if noted.elapsed() > NOTED_EVERY {
                write_bytes(&self.checkpoint(), &trainer.checkpoint(), true)?;
                noted = Instant::now();
            }
        }
        progress.finish();
        Ok(())
    }

    /// What came of it.
    fn told(&self, trained: &Trained, held: &[&Shown]) -> String {
        let mut text = format!("{}: {} splats\n", shown(&self.output), trained.splats.len());
        if let Medium::Learned(water) = &trained.medium {
            let three = |values: [f32; 3]| values.map(|value| format!("{value:.3}")).join(" ");
            text += &format!(
                "  water: B_inf {}, beta_B {}, beta_D {} per unit of the scene\n",
                three(water.veil()),
                three(water.backscatter()),
                three(water.attenuation())
            );
        }
        if !held.is_empty() {
            let scores = held.iter().filter_map(|one| {
                let drawn = render(&trained.splats, self.sh_degree, &one.camera, &trained.medium);
                let drawn = picture(&drawn.drawing);
                Some((psnr(&drawn, &one.picture).ok()?, ssim(&drawn, &one.picture).ok()??))
            });
            let (sum, similar) = scores.fold((0.0, 0.0), |sum, score| (sum.0 + score.0, sum.1 + score.1));
            let count = held.len() as f64;
            text += &format!(
                "  {} pictures held back: PSNR {:.2} dB, SSIM {:.3}\n",
                held.len(),
                sum / count,
                similar / count
            );
        }
        text
    }
}

/// Where a water begins to be learned: what the pictures tell, pooled, in the scene's unit.
fn first_guess(shown: &[&Shown], points: &[points::Point], extent: f64) -> Result<Water<f32>, Failure> {
    let (mut estimates, mut distances) = (Vec::new(), Vec::new());
    for one in shown {
        let whole = Picture::new(one.picture.to_samples::<u8>());
        let found = analyse::<Encoded>(&whole, &DepthSource::default())?;
        let lens = Lens { camera: one.camera.clone(), distortion: [0.0; 4] };
        let known = unit_of(&found.depth, &lens, points);
        // Without points: things stand some extents away.
        let depth = in_scene(&found.depth, known.unwrap_or(5.0 * extent as f32));
        distances.push(depth.percentile(0.5));
        estimates.push(water_of(&whole, &depth).map_err(Failure::work)?);
    }
    let pooled = aquafuse::waterbody::pool(&estimates)
        .ok_or_else(|| Failure::usage(anyhow!("there is no picture")))?;
    Ok(to_learn(&pooled, median(&mut distances).unwrap_or(1.0)))
}
