//! `aquafuse scene train`: splats from images with cameras.

mod brush;
mod cpu;
mod engine;

use std::path::PathBuf;

use anyhow::anyhow;
use aquafuse::metrics::{psnr, ssim};
use aquafuse_data::files::{FileError, display, make_folder_of, remove_stale_parts};
use aquafuse_scene::camera::Camera;
use aquafuse_scene::capture::{self, Shown};
use aquafuse_scene::compare::image;
use aquafuse_scene::files::{Cameras, Taken, read_cameras};
use aquafuse_scene::medium::Medium;
use aquafuse_scene::render::render;
use aquafuse_scene::train::Options;
use clap::{Args, ValueEnum};

use super::splats_file::{Trained, check_name, water_beside};
use crate::args::common::Common;
use crate::failure::Failure;
use crate::report::output;
use brush::Brush;
use cpu::Cpu;
use engine::{Engine, Task};

/// Train splats on a scene's images.
///
/// One that was stopped goes on where it was: the same command ends in the same file, byte for byte.
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
    /// Where to write, FILE.ply; a learned water goes to FILE.water.json.
    #[arg(short, long, value_name = "FILE.ply")]
    output: PathBuf,
    /// The folder of the images [default: SCENE/images, or SCENE where there is none].
    #[arg(long, value_name = "DIR")]
    images: Option<PathBuf>,
    /// Steps, each of one image.
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
    /// Images are scaled down to this many pixels on their longer side.
    #[arg(long, value_name = "PIXELS", default_value_t = 400, value_parser = clap::value_parser!(u32).range(16..=65535))]
    longest: u32,
    /// What trains.
    #[arg(long, value_name = "WHAT", value_enum, default_value_t)]
    engine: Trainer,
    /// Brush's program [default: brush, or brush_app].
    #[arg(long, value_name = "PROGRAM")]
    brush: Option<PathBuf>,
    /// Hold every Nth image back, and say how near it comes.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..))]
    hold: Option<u32>,
    /// Replace FILE.ply if it exists, and begin again.
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
    /// Ours, on this machine's processors.
    #[default]
    Cpu,
    /// Brush, a program of others for graphics cards, which must be installed; without water and resuming.
    Brush,
}

/// Points to begin with where the model has none.
const SCATTERED: usize = 10_000;
/// An image to train on, as it is and as the loss has it.
const BYTES_A_PIXEL: u64 = 48;
/// A drawing, its gradient and the loss's.
const STEP_BYTES_A_PIXEL: u64 = 240;
/// A splat without its harmonics five times (it, its gradient, two moments, a checkpoint), and its places in tiles.
const BYTES_A_SPLAT: u64 = 5 * 44 + 800;

impl Train {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        self.check()?;
        let engine = self.engine()?;
        self.check_memory(common)?;
        let image_files = self.images.clone().unwrap_or_else(|| capture::images_of(&self.scene));
        let taken =
            capture::read(&self.scene, &image_files, self.longest as usize, &common.reading.options())?;
        let held = |i: usize| self.hold.is_some_and(|every| i.is_multiple_of(every as usize));
        let (held, shown): (Vec<_>, Vec<_>) = taken.shown.iter().enumerate().partition(|(i, _)| held(*i));
        let (held, trained_on): (Vec<&Shown>, Vec<&Shown>) =
            (held.into_iter().map(|(_, one)| one).collect(), shown.into_iter().map(|(_, one)| one).collect());
        if trained_on.is_empty() {
            return Err(Failure::usage(anyhow!("--hold leaves no image to train on; raise it")));
        }
        let task = Task {
            taken: &taken,
            trained_on: &trained_on,
            options: self.options(),
            sh_degree: self.sh_degree,
            learns_water: self.water == WaterInside::Learn,
            output: &self.output,
            overwrite: self.overwrite,
            quiet: common.quiet,
        };
        let trained = engine.train(&task)?;
        trained.write(&self.output, &self.scene, self.overwrite)?;
        engine.clear(&task);
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
        remove_stale_parts(make_folder_of(&self.output)?);
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

    fn engine(&self) -> Result<Box<dyn Engine>, Failure> {
        match (self.engine, self.water) {
            (Trainer::Cpu, _) => Ok(Box::new(Cpu)),
            (Trainer::Brush, WaterInside::Learn) => Err(Failure::usage(anyhow!(
                "--engine brush knows no water; leave --water learn, or --engine brush, out"
            ))),
            (Trainer::Brush, WaterInside::None) => Ok(Box::new(Brush::find(self.brush.as_deref())?)),
        }
    }

    /// Refuses a scene that would take more memory than may be taken, before any image is read.
    fn check_memory(&self, common: &Common) -> Result<(), Failure> {
        let (needed, most) = (self.memory(&read_cameras(&self.scene)?), common.reading.options().max_memory);
        let mebibytes = |bytes: u64| bytes.div_ceil(1 << 20);
        (needed <= most).then_some(()).ok_or_else(|| {
            Failure::usage(anyhow!(
                "{} takes about {} MiB to train on, more than the {} MiB of --max-memory; raise that, or lower --longest \
                 or --splats",
                display(&self.scene),
                mebibytes(needed),
                mebibytes(most)
            ))
        })
    }

    /// Bytes that training takes at most: all images, one step of the largest, and all splats.
    fn memory(&self, cameras: &Cameras) -> u64 {
        let pixels = |one: &Taken| {
            let Camera { width, height, .. } = one.lens.camera;
            let scale = (f64::from(self.longest) / width.max(height) as f64).min(1.0);
            (scale * width as f64 * scale * height as f64).ceil() as u64
        };
        let all: u64 = cameras.taken.iter().map(pixels).sum();
        let largest = cameras.taken.iter().map(pixels).max().unwrap_or(0);
        let harmonics = (u64::from(self.sh_degree) + 1).pow(2);
        let begun_with = cameras.points.len().max(SCATTERED);
        let splats = self.splats.max(begun_with) as u64;
        BYTES_A_PIXEL * all + STEP_BYTES_A_PIXEL * largest + splats * (BYTES_A_SPLAT + 5 * 12 * harmonics)
    }

    /// What came of it.
    fn told(&self, trained: &Trained, held: &[&Shown]) -> String {
        let mut text = format!("{}: {} splats\n", display(&self.output), trained.splats.len());
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
                let drawn = image(&drawn.drawing);
                Some((psnr(&drawn, &one.image).ok()?, ssim(&drawn, &one.image).ok()??))
            });
            let (sum, similar) = scores.fold((0.0, 0.0), |sum, score| (sum.0 + score.0, sum.1 + score.1));
            let count = held.len() as f64;
            text += &format!(
                "  {} images held back: PSNR {:.2} dB, SSIM {:.3}\n",
                held.len(),
                sum / count,
                similar / count
            );
        }
        text
    }
}
