//! Training a scene from its folder: planned once, then run, with resume and scores of views that were held out.
//!
//! [`Plan::new`] parses the cameras, [`Plan::load`] reads the images if memory allows, [`Training::run`] trains by
//! [`train`](crate::train), and [`Training::write`] writes the result. A front that trains by another engine takes
//! [`Training::views`] instead of calling `run`.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use aquafuse::depth::DepthModel;
use aquafuse::metrics::{psnr, ssim};
use aquafuse_data::files::{FileError, display, make_folder_of, remove_stale_parts, write_bytes};
use aquafuse_data::image_file::{ImageFile, ReadOptions};
use aquafuse_data::run::{self, Budget, Event, RunOptions, Stopped};

use crate::camera::Camera;
use crate::capture::{self, CaptureError, Split, View, images_of};
use crate::compare::image;
use crate::files::{Cameras, PosedImage, SceneFileError, read_cameras};
use crate::lens::Lens;
use crate::medium::{Medium, Water};
use crate::model::{Model, ModelError, check_name, water_beside};
use crate::points::{self, Point};
use crate::render::render;
use crate::shared_water::{self, MissingUnit, SharedWaterError, to_learn};
use crate::train::loss::Target;
use crate::train::{CheckpointError, Options, TrainView, Trainer, extent, is_checkpoint, is_ended};

/// Added to the output's name: the checkpoint of a run that is not finished.
const CHECKPOINT: &str = ".checkpoint";
/// Writing checkpoints may take one part in so many of the run's time.
const CHECKPOINTS: u32 = 50;
/// Points to begin with where the model has none.
const SCATTERED: usize = 10_000;
/// How far away things are where no points say so, in extents of the scene.
const FAR: f64 = 5.0;

/// Bytes a pixel of a view to train on: as it is, and as the loss needs it.
const BYTES_A_PIXEL: u64 = 48;
/// Bytes a pixel of one step: a rendering, its gradient and the loss's gradient.
const STEP_BYTES_A_PIXEL: u64 = 240;
/// Bytes a splat without its harmonics: five rows (itself, its gradient, two moments, a checkpoint), and its entries in tiles.
const BYTES_A_SPLAT: u64 = 5 * 44 + 800;
/// Bytes a pixel of estimating the water of a view: the image as bytes, its depth in both units, and the estimator's steps.
const WATER_BYTES_A_PIXEL: u64 = 32;

/// What is to be trained.
#[derive(Clone, Debug)]
pub struct Request {
    /// A folder with cameras and images.
    pub scene: PathBuf,
    /// The folder of the images; `None`: `images` in the scene's folder, or that folder itself.
    pub images: Option<PathBuf>,
    /// Train without the images that are not there.
    pub skip_missing: bool,
    /// Where the result goes, FILE.ply; a learned water goes beside it.
    pub output: PathBuf,
    /// How to train.
    pub options: Options,
    /// The spherical-harmonics degree, 0 to 3.
    pub sh_degree: u8,
    /// Whether a water is learned; otherwise the colours of the splats contain it.
    pub learns_water: bool,
    /// Images are scaled down to this many pixels on their longer side.
    pub longest: usize,
    /// Every Nth image is held out of training, from the first on; `None`: no image.
    pub hold_out: Option<usize>,
    /// Replace the output if it exists, and ignore a checkpoint.
    pub overwrite: bool,
}

/// A request whose names are checked and whose cameras are parsed.
#[derive(Clone, Debug)]
pub struct Plan {
    request: Request,
    cameras: Cameras,
}

/// A scene in memory, ready to be trained.
#[derive(Clone, Debug)]
pub struct Training {
    request: Request,
    points: Vec<Point>,
    views: Split,
    unused: capture::Unused,
}

/// How far a run is after a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepReport {
    /// Splats there are.
    pub splats: usize,
    /// The loss before the step.
    pub loss: f64,
}

/// Whoever listens to a run: its items are steps, from 1 on.
pub type Listener<'a> = run::Listener<'a, u32, StepReport>;

/// How near renderings come to the views that were held out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeldOutScores {
    /// Views that were held out.
    pub views: usize,
    /// Mean PSNR, dB.
    pub psnr: f64,
    /// Mean SSIM.
    pub ssim: f64,
}

/// A scene cannot be trained.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TrainingError {
    /// A file cannot be read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// The cameras cannot be read.
    #[error(transparent)]
    Cameras(#[from] SceneFileError),
    /// The images cannot be read.
    #[error(transparent)]
    Images(#[from] CaptureError),
    /// Training would take too much memory.
    #[error(
        "{} takes about {} MiB to train on, more than the {} MiB of --max-memory; raise that, or lower --longest or \
         --splats",
        display(scene),
        needed.div_ceil(1 << 20),
        most.div_ceil(1 << 20)
    )]
    Memory {
        /// The scene.
        scene: PathBuf,
        /// Bytes that it takes.
        needed: u64,
        /// Bytes that are allowed.
        most: u64,
    },
    /// All images are held out.
    #[error("--hold leaves no image to train on; raise it")]
    NothingToTrainOn,
    /// A checkpoint belongs to another run, or is damaged.
    #[error("cannot continue from {}: {cause}", display(path))]
    Checkpoint {
        /// The checkpoint.
        path: PathBuf,
        /// What is wrong with it.
        cause: CheckpointError,
    },
    /// The images give no first guess of the water.
    #[error(transparent)]
    Water(#[from] SharedWaterError),
    /// The result cannot be written.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The run was stopped; a checkpoint says where.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

impl Plan {
    /// Checks the names and parses the cameras. Nothing is written.
    ///
    /// # Errors
    ///
    /// [`TrainingError`] when the output is no PLY file or exists, or the cameras cannot be read.
    pub fn new(request: Request, reading: &ReadOptions) -> Result<Self, TrainingError> {
        check_name(&request.output)?;
        // A water that is there would be taken for the water of the new splats, learned or not.
        let outputs = [request.output.clone(), water_beside(&request.output)];
        // A run that was stopped while it wrote may have written one of them: `write` looks at what they hold.
        let is_ended = is_ended(&beside(&request.output, CHECKPOINT), &request.options);
        let exists = |path: &PathBuf| path.symlink_metadata().is_ok();
        if !request.overwrite
            && !is_ended
            && let Some(path) = outputs.into_iter().find(exists)
        {
            return Err(FileError::Exists { path }.into());
        }
        let cameras = read_cameras(&request.scene, reading)?;
        Ok(Self { request, cameras })
    }

    /// Bytes that training takes at most: all images, one step of the largest, and all splats.
    pub fn memory(&self) -> u64 {
        let Request { options, sh_degree, longest, .. } = &self.request;
        let pixels = |one: &PosedImage| {
            let Camera { width, height, .. } = one.lens.camera;
            let scale = (*longest as f64 / width.max(height) as f64).min(1.0);
            (scale * width as f64 * scale * height as f64).ceil() as u64
        };
        let all: u64 = self.cameras.images.iter().map(pixels).sum();
        let largest = self.cameras.images.iter().map(pixels).max().unwrap_or(0);
        let harmonics = (u64::from(*sh_degree) + 1).pow(2);
        let begun_with = self.cameras.points.len().max(SCATTERED);
        let splats = options.max_splats.max(begun_with) as u64;
        let of_splats = splats.saturating_mul(BYTES_A_SPLAT.saturating_add(harmonics.saturating_mul(5 * 12)));
        let of_pixels =
            BYTES_A_PIXEL.saturating_mul(all).saturating_add(STEP_BYTES_A_PIXEL.saturating_mul(largest));
        of_pixels.saturating_add(of_splats)
    }

    /// Reads the images, and makes the folder of the output.
    ///
    /// # Errors
    ///
    /// [`TrainingError`] when training would take more memory than `options` allow, which is checked before any image is
    /// read; when an image cannot be read, or none is left to train on.
    pub fn load(self, options: &RunOptions) -> Result<Training, TrainingError> {
        let (needed, most) = (self.memory(), options.reading.max_memory);
        let Self { request, mut cameras } = self;
        if needed > most {
            return Err(TrainingError::Memory { scene: request.scene, needed, most });
        }
        let folder = request.images.clone().unwrap_or_else(|| images_of(&request.scene, &cameras));
        let unused = capture::without_unused(&mut cameras, &folder, request.skip_missing)?;
        remove_stale_parts(make_folder_of(&request.output)?);
        let views = capture::read(&cameras, &folder, request.longest, &options.reading)?;
        let views = Split::new(views, request.hold_out.unwrap_or(0));
        if views.training.is_empty() {
            return Err(TrainingError::NothingToTrainOn);
        }
        Ok(Training { request, points: cameras.points, views, unused })
    }
}

impl Training {
    /// What was asked for.
    pub fn request(&self) -> &Request {
        &self.request
    }

    /// The views to train on, and those held out.
    pub fn views(&self) -> &Split {
        &self.views
    }

    /// The images that it trains without.
    pub fn unused(&self) -> &capture::Unused {
        &self.unused
    }

    /// The points of the scene; empty where its model has none.
    pub fn points(&self) -> &[Point] {
        &self.points
    }

    /// The output's name with `more` added: for what an engine keeps while it works.
    pub fn beside(&self, more: &str) -> PathBuf {
        beside(&self.request.output, more)
    }

    /// Trains to the end, from the beginning or from the checkpoint of a run that was stopped.
    ///
    /// The result does not depend on threads, nor on how often the run was stopped. Steps use the thread pool of the caller.
    ///
    /// # Errors
    ///
    /// [`TrainingError`] when a checkpoint cannot be used or written, or the run was stopped.
    pub fn run(&self, options: &RunOptions, listener: Listener<'_>) -> Result<Model, TrainingError> {
        let mut trainer = self.trainer(options)?;
        let checkpoint = self.beside(CHECKPOINT);
        listener(Event::Started { total: self.request.options.iterations as usize });
        for step in 1..=trainer.steps() {
            listener(Event::Skipped { item: &step });
        }
        let (mut written, mut took) = (Instant::now(), Duration::ZERO);
        while !trainer.is_done() {
            if options.stop.is_stopped() {
                write_bytes(&checkpoint, &trainer.checkpoint(), true)?;
                return Err(Stopped.into());
            }
            let loss = trainer.step();
            let result = StepReport { splats: trainer.splats().len(), loss: loss.total };
            listener(Event::Done { item: &trainer.steps(), result });
            // The last one says that training has ended, whatever becomes of the files that `write` writes.
            if written.elapsed() > CHECKPOINTS * took || trainer.is_done() {
                let began = Instant::now();
                write_bytes(&checkpoint, &trainer.checkpoint(), true)?;
                (took, written) = (began.elapsed(), Instant::now());
            }
        }
        Ok(Model { splats: trainer.splats().clone(), medium: trainer.medium() })
    }

    /// Writes the result, and removes the checkpoint. A file that already holds the result is left as it is.
    ///
    /// # Errors
    ///
    /// [`TrainingError::Model`] when a file holds something else and may not be replaced, or cannot be written.
    pub fn write(&self, model: &Model) -> Result<(), TrainingError> {
        let Request { output, scene, overwrite, .. } = &self.request;
        model.write(output, scene, *overwrite)?;
        // One that stays is refused by the next run, or found to be of a finished one.
        let _ = std::fs::remove_file(self.beside(CHECKPOINT));
        Ok(())
    }

    /// Renders the views that were held out and scores them; `None` where no view was.
    pub fn held_out_scores(&self, model: &Model) -> Option<HeldOutScores> {
        let views = &self.views.held_out;
        let scores = views.iter().filter_map(|view| {
            let rendered = render(&model.splats, self.request.sh_degree, &view.camera, &model.medium);
            let rendered = image(&rendered.rendering);
            Some((psnr(&rendered, &view.image).ok()?, ssim(&rendered, &view.image).ok()??))
        });
        let (psnr, ssim) = scores.fold((0.0, 0.0), |sum, score| (sum.0 + score.0, sum.1 + score.1));
        let count = views.len() as f64;
        (!views.is_empty()).then(|| HeldOutScores {
            views: views.len(),
            psnr: psnr / count,
            ssim: ssim / count,
        })
    }

    /// A new run, or the one that was stopped.
    fn trainer(&self, options: &RunOptions) -> Result<Trainer, TrainingError> {
        let Request { options: how, sh_degree, learns_water, overwrite, .. } = &self.request;
        let training = &self.views.training;
        let views = training.iter().map(|view| TrainView {
            target: Target::new(view.camera.width, view.camera.height, view.image.pixels()),
            camera: view.camera.clone(),
        });
        let views: Vec<TrainView> = views.collect();
        let path = self.beside(CHECKPOINT);
        let refused = |cause| TrainingError::Checkpoint { path: path.clone(), cause };
        let is_there = path.symlink_metadata().is_ok();
        if is_there && !is_checkpoint(&path) {
            return Err(refused(CheckpointError::Unknown));
        }
        if !overwrite && is_there {
            let cannot_read = |error| FileError::Read { path: path.clone(), error };
            let (bytes, most) = (path.metadata().map_err(cannot_read)?.len(), options.reading.max_memory);
            if bytes > most {
                let cause = format!("it has {bytes} bytes, but --max-memory is {most}");
                return Err(FileError::TooLarge { path, cause }.into());
            }
            let bytes = std::fs::read(&path).map_err(cannot_read)?;
            let trainer = Trainer::resume(how.clone(), views, &bytes).map_err(refused)?;
            let learned = trainer.medium() != Medium::Air;
            if (learned, trainer.splats().sh_degree()) != (*learns_water, *sh_degree) {
                return Err(refused(CheckpointError::OtherOptions));
            }
            return Ok(trainer);
        }
        let cameras: Vec<&Camera> = training.iter().map(|view| &view.camera).collect();
        let extent = extent(&cameras);
        let begin = match self.points.is_empty() {
            true => &points::scattered(&cameras, extent, SCATTERED, how.seed),
            false => &self.points,
        };
        let splats = points::splats(begin, *sh_degree);
        let water = if *learns_water { Some(self.first_guess(extent, options)?) } else { None };
        Ok(Trainer::new(how.clone(), views, splats, water))
    }

    /// The water that training begins with: estimated from the views, and pooled, in the scene's unit.
    fn first_guess(&self, extent: f64, options: &RunOptions) -> Result<Water<f32>, TrainingError> {
        let views: &[View] = &self.views.training;
        let lenses = views.iter().map(|view| Lens { camera: view.camera.clone(), distortion: [0.0; 4] });
        let lenses: Vec<Lens> = lenses.collect();
        let pixels = |view: &View| (view.camera.width * view.camera.height) as u64;
        // No step is taken yet: what the largest step takes is free.
        let largest = views.iter().map(pixels).max().unwrap_or(0);
        let budget = Budget::new(STEP_BYTES_A_PIXEL * largest);
        let shared = shared_water::estimate(
            &lenses.iter().collect::<Vec<_>>(),
            &self.points,
            MissingUnit::Fixed((FAR * extent) as f32),
            options,
            &|index, look| {
                let view = &views[index];
                let _room = budget.reserve(WATER_BYTES_A_PIXEL * pixels(view));
                let image = ImageFile::new(view.image.convert::<u8>());
                let image = image.with_water_map(options.reading.water_map);
                look(&image, &image.pixels.depth(&DepthModel::default(), image.top_edge()));
                Ok::<(), TrainingError>(())
            },
        )?;
        Ok(to_learn(&shared.water, shared.distance))
    }
}

/// A path with `more` added to its name.
fn beside(path: &Path, more: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(more);
    name.into()
}

#[cfg(test)]
mod tests;
