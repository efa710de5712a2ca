//! Scenes in 3D, as `aquafuse scene` trains, renders and fuses them, with events for Python and a way to stop.

use std::path::PathBuf;

use aquafuse::depth::DepthKind;
use aquafuse::fusion::Model;
use aquafuse_data::batch::Recipe;
use aquafuse_data::files::{Claim, FileError, display};
use aquafuse_data::image_file::ReadOptions;
use aquafuse_data::pipeline::Operation;
use aquafuse_scene::fuse::{self, FuseError};
use aquafuse_scene::medium::Medium;
use aquafuse_scene::train::Options as TrainOptions;
use aquafuse_scene::training::{self, StepReport, TrainingError};
use aquafuse_scene::views::{self, ViewsError};
use pyo3::prelude::*;

use crate::error::Fault;
use crate::runs::{self, Limits};
use crate::settings::{Reading, fusion_options, optional, scale, whole};
use crate::threads;
use crate::water::{Water, checked};

/// How a scene is trained.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Training {
    scene: PathBuf,
    output: PathBuf,
    images: Option<PathBuf>,
    skip_missing: bool,
    iterations: i64,
    seed: i64,
    sh_degree: i64,
    water: String,
    splats: i64,
    longest: i64,
    hold: Option<i64>,
    overwrite: bool,
}

/// Splats, images held out, their mean PSNR and SSIM.
type Trained = (usize, Option<(usize, f64, f64)>);

/// Trains splats, and writes them.
#[pyfunction]
pub(crate) fn train_scene(
    py: Python<'_>,
    asked: Training,
    limits: Limits,
    listener: &Bound<'_, PyAny>,
) -> PyResult<Trained> {
    runs::refuse_fork("scene train")?;
    let request = asked.request()?;
    let options = limits.options(ReadOptions::default())?;
    runs::run(py, &options.stop, listener, |reporter| {
        threads::install(runs::threads_of(&options), || {
            let training = training::Plan::new(request, &options.reading)?.load(&options)?;
            // Before the work of hours: a second run to this output would be refused after it.
            let training::Request { output, overwrite, .. } = training.request();
            let _claim = Claim::of(output)?;
            if !overwrite && output.symlink_metadata().is_ok() {
                return Err(FileError::Exists { path: output.clone() }.into());
            }
            let about = |step: &StepReport| format!("{} splats, loss {:.4}", step.splats, step.loss);
            let model =
                training.run(&options, &|event| reporter.report_with(&event, u32::to_string, about))?;
            training.write(&model)?;
            let scores = training.held_out_scores(&model);
            Ok((model.splats.len(), scores.map(|scores| (scores.views, scores.psnr, scores.ssim))))
        })
    })
}

impl Training {
    fn request(self) -> Result<training::Request, Fault> {
        let learns_water = match self.water.as_str() {
            "none" => false,
            "learn" => true,
            _ => return Err(Fault::argument("water: give none or learn")),
        };
        let options = TrainOptions {
            iterations: whole("iterations", self.iterations, 1..=1_000_000)?,
            seed: whole("seed", self.seed, 0..=i64::MAX)?,
            max_splats: whole("splats", self.splats, 1..=100_000_000)?,
            ..TrainOptions::default()
        };
        Ok(training::Request {
            scene: self.scene,
            images: self.images,
            skip_missing: self.skip_missing,
            output: self.output,
            options,
            sh_degree: whole("sh_degree", self.sh_degree, 0..=3)?,
            learns_water,
            longest: whole("longest", self.longest, 16..=65535)?,
            hold_out: optional("hold", self.hold, 2..=1_000_000)?,
            overwrite: self.overwrite,
        })
    }
}

/// How a trained scene is rendered.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Rendering<'py> {
    splats: PathBuf,
    scene: PathBuf,
    output: PathBuf,
    /// Whether it is seen through air.
    air: bool,
    /// The water it is seen through; none for the one that it was trained with.
    water: Option<Bound<'py, Water>>,
    visibility: Option<f32>,
    metres_per_unit: f32,
    orbit: Option<i64>,
    depth: bool,
    longest: i64,
    overwrite: bool,
}

/// Views that are rendered, and those that a run before this one rendered.
#[pyfunction]
pub(crate) fn render_scene(
    py: Python<'_>,
    asked: Rendering<'_>,
    limits: Limits,
    listener: &Bound<'_, PyAny>,
) -> PyResult<(usize, usize)> {
    runs::refuse_fork("scene render")?;
    let medium = asked.medium()?;
    let request = asked.request()?;
    let options = limits.options(ReadOptions::default())?;
    runs::run(py, &options.stop, listener, |reporter| {
        threads::install(runs::threads_of(&options), || {
            let plan = views::Plan::new(request, &options.reading)?;
            let plan = match medium {
                Some(medium) => plan.through(medium),
                None => plan,
            };
            let rendered =
                plan.run(&options, &|event| reporter.report(&event, |path| display(path).to_string()))?;
            Ok((rendered.done, rendered.skipped))
        })
    })
}

impl Rendering<'_> {
    fn medium(&self) -> Result<Option<Medium<f32>>, Fault> {
        if self.air {
            return Ok(Some(Medium::Air));
        }
        let Some(water) = self.water.as_ref().map(Bound::get) else { return Ok(None) };
        if !(1e-4..=1e4).contains(&self.metres_per_unit) {
            return Err(Fault::argument(format!(
                "metres_per_unit is {}; give 0.0001 to 10000 metres",
                self.metres_per_unit
            )));
        }
        let mut file = water.file().clone();
        file.estimate = water.per(DepthKind::Metres, scale(None)?, checked(self.visibility)?)?;
        Ok(Some(Medium::of_file(&file).with_metres_per_unit(self.metres_per_unit)))
    }

    fn request(&self) -> Result<views::Request, Fault> {
        Ok(views::Request {
            splats: self.splats.clone(),
            scene: self.scene.clone(),
            output: self.output.clone(),
            orbit: optional("orbit", self.orbit, 1..=100_000)?,
            distances: self.depth,
            longest: whole("longest", self.longest, 16..=16384)?,
            overwrite: self.overwrite,
        })
    }
}

/// How all images of a scene are fused.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Fusing<'py> {
    scene: PathBuf,
    water: Bound<'py, Water>,
    /// The file of the water, which no output may replace.
    water_file: Option<PathBuf>,
    output: PathBuf,
    model: String,
    theta: Option<f32>,
    alpha: Option<f32>,
    smooth: String,
    metres_at_one: Option<f32>,
    visibility: Option<f32>,
    skip_missing: bool,
    overwrite: bool,
}

/// Images that are fused, those that a run before this one fused, and units of the scene in a relative depth of 1.
#[pyfunction]
pub(crate) fn fuse_scene(
    py: Python<'_>,
    asked: Fusing<'_>,
    reading: Reading,
    limits: Limits,
    listener: &Bound<'_, PyAny>,
) -> PyResult<(usize, usize, Option<f32>)> {
    runs::refuse_fork("scene fuse")?;
    let model: Model = asked.model.parse().map_err(Fault::from)?;
    if asked.visibility.is_some() && model != Model::Exchange {
        return Err(Fault::argument("visibility needs model=\"exchange\"; leave it out").into());
    }
    let options = fusion_options(model, asked.theta, asked.alpha)?;
    let reference =
        asked.water.get().per(DepthKind::Metres, scale(asked.metres_at_one)?, checked(asked.visibility)?)?;
    let smoothing = asked.smooth.parse().map_err(Fault::from)?;
    let recipe = Recipe { smoothing, ..Recipe::new(Operation::Fuse { reference, options }) };
    let (estimator, run_options) = (reading.estimator()?, limits.options(reading.scene()?)?);
    let inputs: Vec<&std::path::Path> = asked.water_file.iter().map(PathBuf::as_path).collect();
    let request = fuse::Request {
        scene: &asked.scene,
        output: &asked.output,
        depth_model: &estimator,
        inputs: &inputs,
        reading: &run_options.reading,
        skip_missing: asked.skip_missing,
        overwrite: asked.overwrite,
    };
    let plan = threads::work(py, || Ok(fuse::Plan::new(&request)?))?;
    runs::run(py, &run_options.stop, listener, |reporter| {
        let fused = plan
            .run(&recipe, &run_options, &|event| reporter.report(&event, |path| display(path).to_string()))?;
        Ok((fused.summary.done, fused.summary.skipped, fused.shared.unit))
    })
}

/// What stops a run of a scene; a file is a fault of that file.
macro_rules! of_scenes {
    ($($error:ident),*) => {$(
        impl From<$error> for Fault {
            fn from(error: $error) -> Self {
                match error {
                    $error::File(error) => error.into(),
                    error => Self::run(error),
                }
            }
        }
    )*};
}
of_scenes!(TrainingError, ViewsError, FuseError);
