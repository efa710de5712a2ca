//! A dataset multiplied, as `aquafuse augment` does it, with events for Python and a way to stop.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use aquafuse::depth::DepthKind;
use aquafuse::waterbody::Verdict;
use aquafuse_data::augment::{
    Augmentation, DepthPlan, Draws, OnDoubtful, Recipe, Sea, Shard, Water as Drawable,
};
use aquafuse_data::dataset::{Dataset, DatasetOptions, Layout, Splits};
use aquafuse_data::files::{display, make_folder, sha256};
use aquafuse_data::pipeline::MapSize;
use aquafuse_data::run::{RunOptions, Summary};
use aquafuse_data::water_file::WaterFile;
use pyo3::prelude::*;

use crate::error::Fault;
use crate::runs;
use crate::settings::{Reading, fusion_options, kind, scale};
use crate::threads;
use crate::water::{Water, checked};

/// A water by its name, and its file if it has one.
type Named<'py> = (String, Bound<'py, Water>, Option<PathBuf>);

/// How a dataset is multiplied.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Settings<'py> {
    layout: Option<String>,
    sidecars: Vec<String>,
    splits: Option<String>,
    preview: u16,
    per_image: u32,
    keep_originals: bool,
    keep_share: f64,
    sea: bool,
    seed: u64,
    with_replacement: bool,
    theta_range: Option<(f32, f32)>,
    alpha_range: Option<(f32, f32)>,
    on_doubtful: String,
    instead: Option<Named<'py>>,
    on_bad_annotation: String,
    shard: (u32, u32),
    overwrite: bool,
    quality: u8,
    threads: Option<NonZeroUsize>,
    max_errors: Option<usize>,
    depth: Option<PathBuf>,
    depth_kind: Option<String>,
    depth_resize: bool,
    model: String,
    theta: Option<f32>,
    alpha: Option<f32>,
    smooth: String,
    metres_at_one: Option<f32>,
    visibility: Option<f32>,
}

/// Multiplies a dataset; returns how many images are done, skipped, failed and left.
#[pyfunction]
pub(crate) fn augment<'py>(
    py: Python<'py>,
    dataset: PathBuf,
    waters: Vec<Named<'py>>,
    output: PathBuf,
    reading: Reading,
    settings: Settings<'py>,
    listener: &Bound<'py, PyAny>,
) -> PyResult<(usize, usize, usize, usize)> {
    runs::refuse_fork("augment")?;
    let recipe = settings.recipe(waters, &reading)?;
    let run_options = RunOptions {
        threads: settings.threads,
        max_failures: settings.max_errors,
        reading: reading.scene()?,
        ..RunOptions::default()
    };
    let reading = run_options.reading;
    let layout = settings.layout.as_deref().map(layout).transpose()?;
    let how = DatasetOptions { layout, sidecars: settings.sidecars.clone(), reading };
    let splits = settings.splits.as_deref().map(str::parse::<Splits>).transpose().map_err(Fault::argument)?;
    let shard = shard(settings.shard)?;
    let (overwrite, on_bad, preview) =
        (settings.overwrite, recipe.on_bad_annotation, settings.preview.into());
    let job = threads::work(py, || {
        let mut dataset = Dataset::open_with(&dataset, &how).map_err(Fault::run)?;
        let splits = dataset.splits(splits.as_ref()).map_err(Fault::run)?;
        without_bad(&mut dataset, on_bad)?;
        let recipe = Recipe { splits, ..recipe };
        let manifest_table = false;
        Ok(Augmentation { dataset, output, recipe, shard, overwrite, manifest_table, preview, run_options })
    })?;
    let plan = job.plan().map_err(Fault::run)?;
    make_folder(&job.output).map_err(Fault::from)?;
    let Summary { done, skipped, failed, left } =
        runs::run(py, &job.run_options.stop, listener, |reporter| {
            job.run(&plan, &|event| reporter.report(&event, str::to_owned)).map_err(Fault::run)
        })?;
    Ok((done, skipped, failed, left))
}

fn layout(name: &str) -> Result<Layout, Fault> {
    Layout::from_name(name).ok_or_else(|| {
        let names = Layout::ALL.map(Layout::name).join(", ");
        Fault::argument(format!("there is no layout {name:?}; give one of {names}"))
    })
}

fn shard((number, of): (u32, u32)) -> Result<Shard, Fault> {
    match (1..=of).contains(&number) {
        true => Ok(Shard { number, of }),
        false => Err(Fault::argument(format!("shard is ({number}, {of}); give (I, N) with I from 1 to N"))),
    }
}

/// Applies `on_bad_annotation`.
fn without_bad(dataset: &mut Dataset, how: &str) -> Result<(), Fault> {
    let (root, faults) = (display(&dataset.root).to_string(), &dataset.faults);
    if how == "refuse" && !faults.is_empty() {
        const NAMED: usize = 10;
        let named: Vec<String> =
            faults.first().iter().take(NAMED).map(|fault| format!("\n  {fault}")).collect();
        return Err(Fault::run(format!(
            "{root} has {} bad annotations; fix them, or pass on_bad_annotation=\"skip\" or \"keep\":{}",
            faults.count(),
            named.concat()
        )));
    }
    if how == "skip" {
        dataset.samples.retain(|sample| !dataset.faults.concern(&sample.key));
    }
    match dataset.samples.is_empty() {
        true => Err(Fault::run(format!(
            "{root}: no image is left; look at its annotations, or pass on_bad_annotation=\"keep\""
        ))),
        false => Ok(()),
    }
}

impl Settings<'_> {
    fn recipe(&self, waters: Vec<Named<'_>>, reading: &Reading) -> PyResult<Recipe> {
        let options = fusion_options(self.model.parse().map_err(Fault::from)?, self.theta, self.alpha)?;
        let estimator = reading.estimator()?;
        let of_map = match self.depth_kind.as_deref() {
            Some("metres" | "millimetres") => DepthKind::Metres,
            Some(_) => DepthKind::Relative,
            None => estimator.kind(),
        };
        let instead = self.instead.as_ref().map(|water| self.drawable(water, of_map)).transpose()?;
        let on_doubtful = match (self.on_doubtful.as_str(), instead) {
            ("flag", _) => OnDoubtful::Flag,
            ("skip", _) => OnDoubtful::Skip,
            (_, Some(water)) => OnDoubtful::Instead(Box::new(water)),
            _ => return Err(Fault::argument("on_doubtful: give flag, skip or preset:NAME").into()),
        };
        let on_bad_annotation = match self.on_bad_annotation.as_str() {
            "refuse" => "refuse",
            "skip" => "skip",
            "keep" => "keep",
            _ => return Err(Fault::argument("on_bad_annotation: give refuse, skip or keep").into()),
        };
        let waters = waters.iter().map(|water| self.drawable(water, of_map)).collect::<PyResult<Vec<_>>>()?;
        let (theta, alpha) = (options.incidence.degrees(), options.gain.get());
        let draws = Draws {
            seed: self.seed,
            with_replacement: self.with_replacement,
            theta: self.theta_range.unwrap_or((theta, theta)),
            alpha: self.alpha_range.unwrap_or((alpha, alpha)),
        };
        let depth = match (&self.depth, self.depth_kind.as_deref()) {
            (None, None) => DepthPlan::Estimated(estimator),
            (Some(folder), Some(name)) => {
                let size = if self.depth_resize { MapSize::Scaled } else { MapSize::Exact };
                DepthPlan::Maps { folder: folder.clone(), kind: kind(name)?, size }
            }
            _ => {
                return Err(Fault::argument("depth, a folder of maps, and depth_kind need each other").into());
            }
        };
        Ok(Recipe {
            waters: without_doubtful(waters, &on_doubtful),
            sea: if self.sea { Some(self.sea(of_map)?) } else { None },
            encoding: reading.encoding(),
            per_image: self.per_image,
            draws,
            options,
            smoothing: self.smooth.parse().map_err(Fault::from)?,
            depth,
            on_doubtful,
            on_bad_annotation,
            keep_originals: self.keep_originals,
            keep_share: self.keep_share,
            splits: Splits::All,
            quality: self.quality,
        })
    }

    /// The sea, per unit of the images' depth.
    fn sea(&self, depth_kind: DepthKind) -> Result<Sea, Fault> {
        Ok(Sea { depth_kind, scale: scale(self.metres_at_one)?, visibility: checked(self.visibility)? })
    }

    /// A water per unit of the images' depth.
    fn drawable(&self, (name, water, path): &Named<'_>, kind: DepthKind) -> PyResult<Drawable> {
        let estimate = water.get().per(kind, scale(self.metres_at_one)?, self.visibility)?;
        let sha256 = path.as_ref().map(std::fs::read).transpose()?.map(|bytes| sha256(&bytes));
        let file = WaterFile { depth_kind: kind, estimate, ..water.get().file().clone() };
        Ok(Drawable { name: name.clone(), sha256, file })
    }
}

/// The waters to draw from; one that replaces several is not drawn more often for that.
fn without_doubtful(waters: Vec<Drawable>, how: &OnDoubtful) -> Vec<Drawable> {
    let is_good = |water: &Drawable| water.file.estimate.quality().verdict == Verdict::Good;
    match how {
        OnDoubtful::Flag => waters,
        OnDoubtful::Skip => waters.into_iter().filter(is_good).collect(),
        OnDoubtful::Instead(instead) => {
            let mut kept: Vec<Drawable> = Vec::new();
            for water in waters.into_iter().map(|own| if is_good(&own) { own } else { (**instead).clone() }) {
                if !kept.iter().any(|other| other.name == water.name) {
                    kept.push(water);
                }
            }
            kept
        }
    }
}
