//! Scores of methods, as `aquafuse evaluate` gives them, with events for Python and a way to stop.

use std::path::PathBuf;

use aquafuse::depth::{DepthModel, SuppliedKind};
use aquafuse::formation::RestoreOptions;
use aquafuse::fusion::Model;
use aquafuse::levels::LevelsOptions;
use aquafuse::truth::{LitWaters, Site};
use aquafuse_data::depth_file::DepthFolder;
use aquafuse_data::evaluate::{
    self, Depth, Enhancement, EvaluateError, Fusion, GroupBy, Maps, Method, Outputs, Pairing, Report, Rival,
    Truth, report,
};
use aquafuse_data::files::{make_folder, make_folder_of};
use aquafuse_data::image_file::ReadOptions;
use aquafuse_data::pairs;
use aquafuse_data::pipeline::{DepthEstimator, DepthSource, DepthSupply, MapSize, Operation};
use aquafuse_data::run::RunOptions;
use pyo3::prelude::*;
use serde_json::{Map, json};

use crate::error::Fault;
use crate::runs::{self, Limits};
use crate::settings::{ModelArgument, Reading, fusion_options, kind, optional, scale, whole};
use crate::water::Water;

/// The figures of an evaluation.
#[pyclass(frozen, name = "Report", module = "aquafuse._native")]
pub(crate) struct PyReport(Report);

#[pymethods]
impl PyReport {
    #[getter]
    fn title(&self) -> &str {
        &self.0.title
    }

    /// All but the images, as the command writes it.
    fn to_json(&self) -> String {
        report::json(&self.0)
    }

    fn to_markdown(&self) -> String {
        report::markdown(&self.0)
    }

    /// Writes it in the format that the name says, or in all of them into a folder.
    fn save(&self, py: Python<'_>, path: PathBuf, overwrite: bool) -> Result<(), Fault> {
        py.detach(|| {
            match path.extension() {
                Some(_) if !path.is_dir() => make_folder_of(&path).map(|_| ())?,
                _ => make_folder(&path)?,
            }
            Ok(report::write(&self.0, &path, overwrite)?)
        })
    }
}

/// What all evaluations are asked: where the report goes, the seed of draws and intervals, and what a run may take.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Run<'py> {
    output: Option<PathBuf>,
    overwrite: bool,
    seed: u64,
    limits: Limits,
    listener: Bound<'py, PyAny>,
}

impl Run<'_> {
    /// Refuses what can be refused before any image is read.
    fn check(&self) -> Result<(), Fault> {
        runs::refuse_fork("evaluate")?;
        let Some(path) = &self.output else { return Ok(()) };
        Ok(report::check_name(path, self.overwrite)?)
    }

    /// Runs an evaluation, and writes its figures.
    fn report(
        &self,
        py: Python<'_>,
        options: &RunOptions,
        evaluation: impl FnOnce(evaluate::Listener<'_>) -> Result<Report, EvaluateError> + Send,
    ) -> PyResult<PyReport> {
        let found = runs::run(py, &options.stop, &self.listener, |reporter| {
            evaluation(&|event| reporter.report(&event, str::to_owned)).map_err(Fault::from)
        })?;
        let found = PyReport(found);
        if let Some(path) = &self.output {
            found.save(py, path.clone(), self.overwrite)?;
        }
        Ok(found)
    }
}

impl From<EvaluateError> for Fault {
    fn from(error: EvaluateError) -> Self {
        match error {
            EvaluateError::File(error) => error.into(),
            error => Self::run(error),
        }
    }
}

/// A folder of depth maps, and what their values are.
type MapsOf = (PathBuf, String);

/// How images are fused that are scored.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Fused {
    contents: PathBuf,
    references: PathBuf,
    group_by: Option<String>,
    pairs: Option<i64>,
    rivals: bool,
    methods: Vec<(String, PathBuf)>,
    depth: Option<MapsOf>,
    water_depth: Option<MapsOf>,
    model: String,
    theta: Option<f32>,
    alpha: Option<f32>,
    smooth: String,
}

/// Fused images beside their contents.
#[pyfunction]
pub(crate) fn evaluate_fusion(
    py: Python<'_>,
    asked: Fused,
    reading: Reading,
    run: Run<'_>,
) -> PyResult<PyReport> {
    run.check()?;
    let by = match asked.group_by.as_deref() {
        None => GroupBy::Nothing,
        Some("folder") => GroupBy::Folder,
        Some("prefix") => GroupBy::Prefix,
        Some(_) => return Err(Fault::argument("group_by: give folder or prefix").into()),
    };
    let model: Model = asked.model.parse().map_err(Fault::from)?;
    let settings = evaluate::Settings {
        depth_model: reading.estimator()?,
        options: fusion_options(model, asked.theta, asked.alpha)?,
        smoothing: asked.smooth.parse().map_err(Fault::from)?,
        encoding: reading.encoding(),
    };
    let own = match model {
        Model::Aquafuse => "AquaFuse".to_owned(),
        model => format!("AquaFuse {}", model.name()),
    };
    let mut methods = vec![Method::Aquafuse(own)];
    if asked.rivals {
        methods.extend(Rival::ALL.map(Method::Rival));
    }
    let taken: Vec<&str> = methods.iter().map(Method::name).collect();
    let others = outputs(&asked.methods, &taken)?;
    methods.extend(others.into_iter().map(Method::Outputs));
    let supply = |maps: Option<MapsOf>| -> Result<Option<DepthSupply>, Fault> {
        let Some((folder, name)) = maps else { return Ok(None) };
        Ok(Some(DepthSupply::Folder(DepthFolder::list(&folder)?, kind(&name)?, MapSize::Exact)))
    };
    let fusion = Fusion {
        contents: by.list(&asked.contents).map_err(Fault::from)?,
        references: by.list(&asked.references).map_err(Fault::from)?,
        pairing: Pairing { references: optional("pairs", asked.pairs, 1..=1_000_000)?, seed: run.seed },
        settings,
        methods,
        content_depth: supply(asked.depth)?,
        reference_depth: supply(asked.water_depth)?,
        lpips: None,
        run_options: run.limits.options(reading.scene()?)?,
    };
    run.report(py, &fusion.run_options, |listener| fusion.run(listener))
}

/// Which images are scored, before and after what.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Enhanced<'py> {
    images: PathBuf,
    references: Option<PathBuf>,
    clear: Option<(String, Bound<'py, Water>)>,
    methods: Vec<(String, PathBuf)>,
    model: String,
    theta: f32,
    alpha: f32,
    metres_at_one: Option<f32>,
}

const ENHANCE: &str = "AquaFuse enhance";
const RESTORE: &str = "AquaFuse restore";
const CLARIFY: &str = "AquaFuse enhance, with clear water";

/// Images before and after.
#[pyfunction]
pub(crate) fn evaluate_enhancement(
    py: Python<'_>,
    asked: Enhanced<'_>,
    reading: Reading,
    run: Run<'_>,
) -> PyResult<PyReport> {
    run.check()?;
    let encoding = reading.encoding();
    let (estimator, levels) = (reading.estimator()?, LevelsOptions::default());
    let mut methods = vec![
        (ENHANCE.to_owned(), Operation::Enhance { levels }),
        (RESTORE.to_owned(), Operation::Restore { options: RestoreOptions::default(), levels, encoding }),
    ];
    let mut settings = Map::from_iter([("encoding".to_owned(), json!(encoding.name()))]);
    if let Some((name, water)) = &asked.clear {
        let options =
            fusion_options(asked.model.parse().map_err(Fault::from)?, Some(asked.theta), Some(asked.alpha))?;
        let reference = water.get().per(estimator.kind(), scale(asked.metres_at_one)?, None)?;
        settings.insert("water".into(), json!(name));
        settings.insert("model".into(), json!(options.model.name()));
        settings.insert("theta".into(), json!(options.incidence.degrees()));
        settings.insert("alpha".into(), json!(options.gain.get()));
        methods.push((CLARIFY.to_owned(), Operation::Clarify { reference, options }));
    }
    let references = asked.references.as_ref().map(|folder| Outputs::list("reference", folder));
    let enhancement = Enhancement {
        images: GroupBy::Nothing.list(&asked.images).map_err(Fault::from)?,
        methods,
        references: references.transpose().map_err(Fault::from)?,
        source: DepthSource::Estimated(estimator),
        outputs: outputs(&asked.methods, &[ENHANCE, RESTORE, CLARIFY])?,
        seed: run.seed,
        run_options: run.limits.options(reading.scene()?)?,
        settings,
    };
    run.report(py, &enhancement.run_options, |listener| enhancement.run(listener))
}

/// Which depth is scored.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Known {
    pairs: PathBuf,
    depth_kind: String,
    depth_models: Vec<(String, ModelArgument)>,
    maps: Vec<(String, String, PathBuf)>,
}

/// Depth from colour, and other depth, against known depth.
#[pyfunction]
pub(crate) fn evaluate_depth(py: Python<'_>, asked: Known, run: Run<'_>) -> PyResult<PyReport> {
    run.check()?;
    let listing = pairs::list(&asked.pairs).map_err(Fault::run)?;
    if listing.pairs.is_empty() {
        let (folder, others) = (asked.pairs.display(), listing.without_partner.len());
        return Err(Fault::run(format!(
            "{folder} holds no pair: {others} files of rgb/ and depth/ have no partner with the same stem. Give the two files \
             of a pair the same stem"
        ))
        .into());
    }
    let mut models: Vec<(String, DepthEstimator)> =
        DepthModel::ALL.iter().map(|model| (format!("`{}`", model.name()), (*model).into())).collect();
    for (name, model) in &asked.depth_models {
        models.push((name.clone(), model.estimator()?));
    }
    let of_maps = |(name, kind_of, folder): &(String, String, PathBuf)| -> Result<Maps, Fault> {
        let kind: SuppliedKind = kind(kind_of)?;
        Ok(Maps { name: name.clone(), kind, folder: DepthFolder::list(folder)? })
    };
    let depth = Depth {
        pairs: listing.pairs,
        kind: kind(&asked.depth_kind)?,
        models,
        maps: asked.maps.iter().map(of_maps).collect::<Result<_, _>>()?,
        seed: run.seed,
        run_options: run.limits.options(ReadOptions::default())?,
    };
    run.report(py, &depth.run_options, |listener| depth.run(listener))
}

/// Which synthetic scenes.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Synthetic {
    exchanges: i64,
    places: String,
    lit: Option<String>,
    linear: bool,
}

/// The share of the true change that each method achieves.
#[pyfunction]
pub(crate) fn evaluate_truth(py: Python<'_>, asked: Synthetic, run: Run<'_>) -> PyResult<PyReport> {
    run.check()?;
    let places = match asked.places.as_str() {
        "reef" => Site::Reef,
        "harbour" => Site::Harbour,
        "wall" => Site::Wall,
        "open-water" => Site::OpenWater,
        _ => return Err(Fault::argument("places: give reef, harbour, wall or open-water").into()),
    };
    let lit = match asked.lit.as_deref() {
        None => None,
        Some("jerlov") => Some(LitWaters::Jerlov),
        Some("sea") => Some(LitWaters::Sea),
        Some(_) => return Err(Fault::argument("lit: give jerlov or sea").into()),
    };
    let truth = Truth {
        exchanges: whole("exchanges", asked.exchanges, 1..=100_000)?,
        places,
        lit,
        linear: asked.linear,
        seed: run.seed,
        run_options: run.limits.options(ReadOptions::default())?,
    };
    run.report(py, &truth.run_options, |listener| truth.run(listener))
}

/// The outputs of other tools, whose names must differ from those that are taken.
fn outputs(named: &[(String, PathBuf)], taken: &[&str]) -> Result<Vec<Outputs>, Fault> {
    let list = |(name, folder): &(String, PathBuf)| {
        if taken.contains(&name.as_str()) {
            return Err(Fault::argument(format!("two methods are named {name}; give yours another name")));
        }
        Ok(Outputs::list(name, folder)?)
    };
    named.iter().map(list).collect()
}
