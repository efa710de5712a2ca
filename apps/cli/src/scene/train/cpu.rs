//! Our own training, on this machine's processors. It notes where it is, and goes on from there.

use std::time::{Duration, Instant};

use anyhow::anyhow;
use aquafuse::image::Encoded;
use aquafuse_data::analysis::{DepthSource, analyse};
use aquafuse_data::image_file::{FileError, ImageFile, shown, write_bytes};
use aquafuse_scene::camera::Camera;
use aquafuse_scene::capture::Shown;
use aquafuse_scene::lens::Lens;
use aquafuse_scene::medium::{Medium, Water};
use aquafuse_scene::points;
use aquafuse_scene::shared_water::{in_scene, median, to_learn, unit_of, water_of};
use aquafuse_scene::train::loss::Target;
use aquafuse_scene::train::{CheckpointError, Shot, Trainer, extent};

use super::SCATTERED;
use super::engine::{Engine, Task};
use crate::failure::Failure;
use crate::progress::Progress;
use crate::scene::splats_file::Trained;

/// Behind the output's name: where the run is.
const CHECKPOINT: &str = ".checkpoint";
/// Noting where a run is may take one part in so many of its time.
const NOTING: u32 = 50;

pub(super) struct Cpu;

impl Engine for Cpu {
    fn train(&self, task: &Task<'_>) -> Result<Trained, Failure> {
        let mut trainer = trainer(task)?;
        steps(&mut trainer, task)?;
        Ok(Trained { splats: trainer.splats().clone(), medium: trainer.medium() })
    }

    fn clear(&self, task: &Task<'_>) {
        // One that stays is only found to be of a finished run.
        let _ = std::fs::remove_file(task.beside(CHECKPOINT));
    }
}

/// A new run, or the one that was stopped.
fn trainer(task: &Task<'_>) -> Result<Trainer, Failure> {
    let shots: Vec<Shot> = task
        .trained_on
        .iter()
        .map(|one| Shot {
            camera: one.camera.clone(),
            target: Target::new(one.camera.width, one.camera.height, one.image.pixels()),
        })
        .collect();
    let path = task.beside(CHECKPOINT);
    if !task.overwrite && path.is_file() {
        let read = std::fs::read(&path).map_err(|error| FileError::Read { path: path.clone(), error })?;
        let no = |cause: &dyn std::fmt::Display| {
            Failure::usage(anyhow!("cannot go on from {}: {cause}", shown(&path)))
        };
        let trainer = Trainer::resume(task.options.clone(), shots, &read).map_err(|error| no(&error))?;
        let learns_water = trainer.medium() != Medium::Air;
        if (learns_water, trainer.splats().degree()) != (task.learns_water, task.sh_degree) {
            return Err(no(&CheckpointError::OtherOptions));
        }
        return Ok(trainer);
    }
    let cameras: Vec<&Camera> = task.trained_on.iter().map(|one| &one.camera).collect();
    let known = &task.taken.points;
    let begin = match known.is_empty() {
        true => &points::scattered(&cameras, extent(&cameras), SCATTERED, task.options.seed),
        false => known,
    };
    let splats = points::splats(begin, task.sh_degree);
    let water = match task.learns_water {
        true => Some(first_guess(task.trained_on, known, extent(&cameras))?),
        false => None,
    };
    Ok(Trainer::new(task.options.clone(), shots, splats, water))
}

fn steps(trainer: &mut Trainer, task: &Task<'_>) -> Result<(), Failure> {
    let progress = Progress::new(task.quiet);
    progress.start(task.options.iterations as usize);
    let (mut noted, mut took) = (Instant::now(), Duration::ZERO);
    for _ in 0..trainer.steps() {
        progress.done(String::new());
    }
    while !trainer.is_done() {
        let loss = trainer.step();
        progress.done(format!("{} splats, loss {:.4}", trainer.splats().len(), loss.total));
        if noted.elapsed() > NOTING * took && !trainer.is_done() {
            let began = Instant::now();
            write_bytes(&task.beside(CHECKPOINT), &trainer.checkpoint(), true)?;
            (took, noted) = (began.elapsed(), Instant::now());
        }
    }
    progress.finish();
    Ok(())
}

/// Where a water begins to be learned: what the images tell, pooled, in the scene's unit.
fn first_guess(shown: &[&Shown], points: &[points::Point], extent: f64) -> Result<Water<f32>, Failure> {
    let (mut estimates, mut distances) = (Vec::new(), Vec::new());
    for one in shown {
        let whole = ImageFile::new(one.image.convert::<u8>());
        let found = analyse::<Encoded>(&whole, &DepthSource::default())?;
        let lens = Lens { camera: one.camera.clone(), distortion: [0.0; 4] };
        let known = unit_of(&found.depth, &lens, points);
        // Without points: things stand some extents away.
        let depth = in_scene(&found.depth, known.unwrap_or(5.0 * extent as f32));
        distances.push(depth.percentile(0.5));
        estimates.push(water_of(&whole, &depth).map_err(Failure::work)?);
    }
    let pooled =
        aquafuse::waterbody::pool(&estimates).ok_or_else(|| Failure::usage(anyhow!("there is no image")))?;
    Ok(to_learn(&pooled, median(&mut distances).unwrap_or(1.0)))
}
