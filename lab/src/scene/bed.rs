//! A scene to train on, in memory: what the measures of training are tried on.

use std::path::Path;

use anyhow::Result;
use aquafuse::image::Image;
use aquafuse::metrics::{psnr, ssim};
use aquafuse::truth::Size;
use aquafuse_data::image_file::ReadOptions;
use aquafuse_scene::camera::Camera;
use aquafuse_scene::capture;
use aquafuse_scene::compare::image;
use aquafuse_scene::files::read_cameras;
use aquafuse_scene::points::{self, Point};
use aquafuse_scene::render::render;
use aquafuse_scene::train::loss::Target;
use aquafuse_scene::train::{Options, TrainView, Trainer};
use aquafuse_scene::truth::{self, TruthView};
use xtask::clock;

/// Every so many views one is held out, as is usual.
const HELD: usize = 8;
/// A point in so many pixels of the synthetic scene.
const EVERY: usize = 48;
/// How much finer the synthetic scene is known than it is trained on.
const FINER: usize = 2;

/// A camera and what it took.
struct Shot {
    camera: Camera,
    image: Image<f32>,
}

/// A scene, its views split.
pub(super) struct Bed {
    training: Vec<Shot>,
    held_out: Vec<Shot>,
    /// The views held out at twice the size, where the truth is known there.
    finer: Vec<Shot>,
    points: Vec<Point>,
}

/// What a run came to.
pub(super) struct Outcome {
    pub(super) begun_with: usize,
    pub(super) splats: usize,
    /// Seconds of a processor.
    pub(super) seconds: f64,
    /// PSNR and SSIM of the views held out, of the views trained on, and of those held out at twice the size.
    pub(super) held_out: [f64; 2],
    pub(super) training: [f64; 2],
    pub(super) finer: Option<[f64; 2]>,
}

impl Bed {
    /// The synthetic scene of seed 1, seen through air by so many cameras.
    pub(super) fn of_truth(count: usize, size: Size) -> Self {
        let views = truth::views(1, size, count, FINER);
        let images: Vec<_> = views.iter().map(TruthView::clear).collect();
        let points = truth::points(&views, &images, EVERY);
        let finer = views.iter().step_by(HELD);
        let finer = finer.map(|view| Shot { camera: view.fine.clone(), image: view.scene.clear.clone() });
        let finer = finer.collect();
        let (mut held_out, mut training) = (Vec::new(), Vec::new());
        for (i, (view, image)) in views.into_iter().zip(images).enumerate() {
            let shots = if i % HELD == 0 { &mut held_out } else { &mut training };
            shots.push(Shot { camera: view.camera, image });
        }
        Self { training, held_out, finer, points }
    }

    /// The scene of a folder, its images at most so many pixels long.
    ///
    /// Views are held out from the middle of each eight: what the first image of a way ahead shows at its rim, no other does.
    pub(super) fn of_folder(folder: &Path, longest: usize) -> Result<Self> {
        let reading = ReadOptions::default();
        let cameras = read_cameras(folder, &reading)?;
        let images = capture::images_of(folder, &cameras);
        let (mut held_out, mut training) = (Vec::new(), Vec::new());
        for (i, view) in capture::read(&cameras, &images, longest, &reading)?.into_iter().enumerate() {
            let shots = if i % HELD == HELD / 2 { &mut held_out } else { &mut training };
            shots.push(Shot { camera: view.camera, image: view.image });
        }
        Ok(Self { training, held_out, finer: Vec::new(), points: cameras.points })
    }

    /// Trains and scores.
    pub(super) fn run(&self, options: &Options) -> Result<Outcome> {
        let views = self.training.iter().map(|Shot { camera, image }| TrainView {
            camera: camera.clone(),
            target: Target::new(camera.width, camera.height, image.pixels()),
        });
        let views = views.collect();
        let began = clock::processor_seconds().own;
        let mut trainer = Trainer::new(options.clone(), views, points::splats(&self.points, 0), None);
        while !trainer.is_done() {
            trainer.step();
        }
        let seconds = clock::processor_seconds().own - began;
        let scores = |shots: &[Shot]| -> Result<[f64; 2]> {
            let mut sum = [0.0; 2];
            for Shot { camera, image: taken } in shots {
                let drawn = image(&render(trainer.splats(), 0, camera, &trainer.medium()).rendering);
                sum[0] += psnr(&drawn, taken)?;
                sum[1] += ssim(&drawn, taken)?.unwrap_or(f64::NAN);
            }
            Ok(sum.map(|sum| sum / shots.len() as f64))
        };
        Ok(Outcome {
            begun_with: self.points.len(),
            splats: trainer.splats().len(),
            seconds,
            held_out: scores(&self.held_out)?,
            training: scores(&self.training)?,
            finer: if self.finer.is_empty() { None } else { Some(scores(&self.finer)?) },
        })
    }
}
