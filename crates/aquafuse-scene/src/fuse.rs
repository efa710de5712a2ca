//! All images of a scene in another water, by the one water that they share: planned once, then run.
//!
//! # Stages
//!
//! No image can be fused before the shared water is known, and that takes all images. So a run has two stages: it looks at
//! every image for its unit of depth and its water, pools the waters, and then fuses every image.
//!
//! # What stays in memory
//!
//! Between the stages, decoded images and their depth maps stay in memory, so that each image is decoded once. They are
//! counted in the run's budget and may take half of it. Images beyond that are decoded again in the second stage, and of those,
//! one whose unit comes from the other images a third time. No output depends on which images stay.

use std::collections::{BTreeMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use aquafuse::depth::DepthMap;
use aquafuse_data::batch::{Item, RECORD, Recipe, Record, State};
use aquafuse_data::files::{
    FileError, display, holds_files, make_folder, place_of, remove_stale_parts, write_bytes,
};
use aquafuse_data::image_file::{Format, ImageFile, ReadOptions, WriteOptions};
use aquafuse_data::pipeline::{Analysis, DepthEstimator, DepthSource, Limited, OperationError, Outcome};
use aquafuse_data::run::{self, Budget, Event, RunOptions, Stopped, Summary};
use aquafuse_data::water_file::Numbers;
use serde_json::json;

use crate::capture::{CaptureError, Unused, images_of, without_unused};
use crate::files::{Cameras, SceneFileError, read_cameras, write_transforms};
use crate::lens::Lens;
use crate::shared_water::{self, MissingUnit, SharedWater, SharedWaterError, in_scene};

/// One part in so many of the budget may hold images between the stages. With more, few images would be in work at once;
/// with less, more of them would be decoded twice.
const KEPT: u64 = 2;
/// Bytes a pixel of a depth map in units of the scene, and of estimating a water by it: distances, those nearer than the
/// horizon, and their steps.
const DEPTH_IN_SCENE: u64 = 16;
/// Bytes a pixel of a relative depth map: in steps from colour, in floats from a network.
const RELATIVE_DEPTH: [u64; 2] = [2, 4];

/// What nerfstudio calls its file of cameras.
const TRANSFORMS: &str = "transforms.json";

/// The files of a COLMAP or NeRF model.
const MODEL: [&str; 8] = [
    "cameras.bin",
    "images.bin",
    "points3D.bin",
    "cameras.txt",
    "images.txt",
    "points3D.txt",
    TRANSFORMS,
    "transforms_train.json",
];

/// What is to be fused.
#[derive(Clone, Copy, Debug)]
pub struct Request<'a> {
    /// A folder with cameras and images.
    pub scene: &'a Path,
    /// The folder of the new scene; made if it is missing.
    pub output: &'a Path,
    /// What estimates depth: a model of colours, or a network.
    pub depth_model: &'a DepthEstimator,
    /// Further inputs, which no output may replace.
    pub inputs: &'a [&'a Path],
    /// How its files are read.
    pub reading: &'a ReadOptions,
    /// Fuse the scene without the images that are not there.
    pub skip_missing: bool,
    /// Write into a folder that is not empty, and replace images of the same names.
    pub overwrite: bool,
}

/// The images of a scene, each with its output. Made once, by [`Plan::new`]; [`Plan::run`] fuses them.
#[derive(Clone, Debug)]
pub struct Plan {
    cameras: Cameras,
    items: Vec<Item>,
    unused: Unused,
    depth_model: DepthEstimator,
    scene: PathBuf,
    output: PathBuf,
    overwrite: bool,
}

/// How a run ended.
#[derive(Clone, Debug)]
pub struct Fused {
    /// The water that the images share, and their units.
    pub shared: SharedWater,
    /// Images that were fused, and those that a run before this one had fused.
    pub summary: Summary,
    /// How much the images of this run changed: the mean of their [`Outcome::change`]s, ΔE; `None` where all were fused before.
    pub change: Option<f64>,
    /// Which safety bounds acted: the same for all images, as the water is.
    pub limited: Limited,
}

/// Whoever listens to a run: every image is an item twice, by its input when it was looked at, by its output when it was
/// fused.
pub type Listener<'a> = run::Listener<'a, Path>;

/// A scene cannot be fused. One image that fails ends the run: a scene without one of its images is another scene.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FuseError {
    /// A file cannot be read or written.
    #[error(transparent)]
    File(FileError),
    /// The cameras cannot be read.
    #[error(transparent)]
    Cameras(#[from] SceneFileError),
    /// Images are missing.
    #[error(transparent)]
    Images(#[from] CaptureError),
    /// The images give no shared water.
    #[error(transparent)]
    Water(#[from] SharedWaterError),
    /// The water is of another encoding than the images are analysed in.
    #[error(transparent)]
    Operation(#[from] OperationError),
    /// An output would replace an input.
    #[error("{} is an input and must not be overwritten; give another output folder", display(path))]
    Input {
        /// The input.
        path: PathBuf,
    },
    /// The output folder holds files that no run of this kind has made.
    #[error("{} is not empty; name another folder with -o, or add --overwrite", display(folder))]
    Filled {
        /// The folder.
        folder: PathBuf,
    },
    /// The run was stopped.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

impl From<FileError> for FuseError {
    fn from(error: FileError) -> Self {
        match error {
            FileError::Stopped { .. } => Self::Stopped(Stopped),
            error => Self::File(error),
        }
    }
}

impl Plan {
    /// Reads the cameras of a scene, and refuses an output folder that holds other files. Nothing is written.
    ///
    /// # Errors
    ///
    /// [`FuseError`] when the cameras cannot be read, or the output must not be touched.
    pub fn new(request: &Request<'_>) -> Result<Self, FuseError> {
        let Request { scene, output, depth_model, inputs, reading, skip_missing, overwrite } = *request;
        let mut cameras = read_cameras(scene, reading)?;
        let images = images_of(scene, &cameras);
        let unused = without_unused(&mut cameras, &images, skip_missing)?;
        let into = output.join(images.strip_prefix(scene).unwrap_or(Path::new("")));
        let items = cameras.images.iter().map(|one| Item {
            input: images.join(&one.name),
            output: into.join(&one.name),
            depth: DepthSource::Estimated(depth_model.clone()),
        });
        let items: Vec<Item> = items.collect();
        // What is read, and what is written: the images, and the model beside them.
        let of_model = |folder: &Path| MODEL.map(|name| folder.join(&cameras.model).join(name));
        let read = items.iter().map(|item| item.input.clone()).chain(of_model(scene));
        let read = read.chain(inputs.iter().map(|input| (*input).to_owned()));
        let read: HashSet<PathBuf> = read.filter_map(|path| path.canonicalize().ok()).collect();
        let mut written = items.iter().map(|item| item.output.clone()).chain(of_model(output));
        if let Some(path) = written.find(|path| place_of(path).is_some_and(|place| read.contains(&place))) {
            return Err(FuseError::Input { path });
        }
        let is_recorded = items.iter().any(|item| folder_of(item).join(RECORD).is_file());
        if !overwrite && !is_recorded && holds_files(output, &[]) {
            return Err(FuseError::Filled { folder: output.to_owned() });
        }
        let (scene, output, depth_model) = (scene.to_owned(), output.to_owned(), depth_model.clone());
        Ok(Self { cameras, items, unused, depth_model, scene, output, overwrite })
    }

    /// The images, by name.
    pub fn items(&self) -> &[Item] {
        &self.items
    }

    /// The images that the scene is fused without.
    pub fn unused(&self) -> &Unused {
        &self.unused
    }

    /// Fuses every image that is not fused yet, and copies the cameras beside them.
    ///
    /// The recipe's reference is per unit of the scene. Images stay as they are stored, whatever `recipe.upright` says: their
    /// cameras belong to the stored pixels. A run that was stopped continues. The files do not depend on
    /// threads or memory.
    ///
    /// # Errors
    ///
    /// [`FuseError`] when an image cannot be read or written, an output is not ours, or the run was stopped.
    pub fn run(
        &self,
        recipe: &Recipe,
        options: &RunOptions,
        listener: Listener<'_>,
    ) -> Result<Fused, FuseError> {
        let needs = self.needs(options)?;
        let budget = options.budget();
        let _kept = budget.reserve(needs.iter().filter(|need| need.is_kept).map(|need| need.kept).sum());
        let slots = self.items.iter().map(|_| Mutex::default()).collect();
        let work = Work { plan: self, options, needs, budget: &budget, slots };
        listener(Event::Started { total: self.items.len().saturating_mul(2) });
        let lenses: Vec<&Lens> = self.cameras.images.iter().map(|one| &one.lens).collect();
        let points = &self.cameras.points;
        let shared =
            shared_water::estimate(&lenses, points, MissingUnit::OfOthers, options, &|index, look| {
                let is_first = work.show(index, look)?;
                if is_first {
                    listener(Event::Done { item: &self.items[index].input, result: () });
                }
                Ok::<(), FuseError>(())
            })?;
        let records = self.records(recipe, &shared, options)?;
        let indices: Vec<usize> = (0..self.items.len()).collect();
        let made = options.try_map(&indices, |&index| {
            let item = &self.items[index];
            let record = records.get(folder_of(item)).expect("each folder has one");
            let was_made = record
                .make(item, self.overwrite, |may_replace| work.fuse(index, recipe, &shared, may_replace))?;
            listener(match was_made {
                true => Event::Skipped { item: &item.output },
                false => Event::Done { item: &item.output, result: () },
            });
            Ok::<bool, FuseError>(was_made)
        })?;
        self.copy_model()?;
        let skipped = made.iter().filter(|was_made| **was_made).count();
        let summary = Summary { done: made.len() - skipped, skipped, ..Summary::default() };
        let outcomes: Vec<Outcome> = (0..self.items.len()).filter_map(|i| work.slot(i).outcome).collect();
        let all: f64 = outcomes.iter().map(|outcome| outcome.change).sum();
        let change = (!outcomes.is_empty()).then(|| all / outcomes.len() as f64);
        let limited = outcomes.first().map_or_else(Limited::default, |outcome| outcome.limited);
        Ok(Fused { shared, summary, change, limited })
    }

    /// What each image takes of the budget, by its header, and whether it stays decoded between the stages.
    fn needs(&self, options: &RunOptions) -> Result<Vec<Need>, FileError> {
        let relative_depth = match self.depth_model {
            DepthEstimator::Colour(_) => RELATIVE_DEPTH[0],
            DepthEstimator::Network(_) => RELATIVE_DEPTH[1],
        };
        let need = |item: &Item| {
            let opened = ImageFile::open(&item.input, &options.reading)?;
            let format = Format::written(&item.output).unwrap_or(Format::Png);
            let estimator = self.depth_model.memory(opened.pixels());
            let beside = opened.pixels().saturating_mul(DEPTH_IN_SCENE).saturating_add(estimator);
            let depth = opened.pixels().saturating_mul(relative_depth);
            Ok(Need {
                work: opened.memory_until_written(format, beside)?,
                kept: opened.memory_of_pixels().saturating_add(depth),
                is_kept: false,
            })
        };
        let mut needs = self.items.iter().map(need).collect::<Result<Vec<Need>, FileError>>()?;
        let largest = needs.iter().map(|need| need.work).max().unwrap_or(0);
        let most = options.reading.max_memory;
        // The largest image must still find room beside all that is kept, or it would wait for ever.
        let mut left = (most / KEPT).min(most.saturating_sub(largest));
        for need in &mut needs {
            if let Some(rest) = left.checked_sub(need.kept) {
                (left, need.is_kept) = (rest, true);
            }
        }
        Ok(needs)
    }

    /// The records of all folders, which say what is fused already; images that are not ours are refused.
    fn records(
        &self,
        recipe: &Recipe,
        shared: &SharedWater,
        options: &RunOptions,
    ) -> Result<BTreeMap<PathBuf, Record>, FileError> {
        let made_with = json!({
            "recipe": recipe.fingerprint(&options.reading),
            "water": Numbers::from(&shared.water.water),
            "units": shared.units,
        });
        let mut records = BTreeMap::new();
        for item in &self.items {
            let folder = folder_of(item);
            if !records.contains_key(folder) {
                make_folder(folder)?;
                remove_stale_parts(folder);
                records.insert(folder.to_owned(), Record::open(folder, &made_with, self.overwrite)?);
            }
            if records.get(folder).is_some_and(|record| record.state(item, self.overwrite) == State::Foreign)
            {
                return Err(FileError::Exists { path: item.output.clone() });
            }
        }
        Ok(records)
    }

    /// Copies the cameras and points as they are, and writes `transforms.json` beside a COLMAP model: nerfstudio reads it.
    fn copy_model(&self) -> Result<(), FuseError> {
        let model = &self.cameras.model;
        let (from, to) = (self.scene.join(model), self.output.join(model));
        make_folder(&to)?;
        remove_stale_parts(&to);
        for name in MODEL.iter().filter(|name| from.join(name).is_file()) {
            let path = from.join(name);
            let bytes = std::fs::read(&path).map_err(|error| FileError::Read { path, error })?;
            write_bytes(&to.join(name), &bytes, true)?;
        }
        let [path, other] = [TRANSFORMS, "transforms_train.json"].map(|name| self.output.join(name));
        let is_copied = [&path, &other].iter().any(|path| from == self.scene && path.is_file());
        if !is_copied {
            let images = self.items.first().zip(self.cameras.images.first());
            let images = images.and_then(|(item, one)| folder_without(&item.output, &one.name));
            let images =
                images.and_then(|folder| folder.strip_prefix(&self.output).ok()).unwrap_or(Path::new(""));
            write_transforms(&path, &self.cameras.images, images, true)?;
        }
        Ok(())
    }
}

/// The path without its last parts, which are those of `name`.
fn folder_without<'a>(path: &'a Path, name: &Path) -> Option<&'a Path> {
    path.ancestors().nth(name.components().count())
}

fn folder_of(item: &Item) -> &Path {
    item.output.parent().unwrap_or(Path::new(""))
}

/// What an image takes of the budget, in bytes.
#[derive(Clone, Copy, Debug)]
struct Need {
    /// While it is in work.
    work: u64,
    /// Between the stages.
    kept: u64,
    /// Whether it stays decoded between the stages.
    is_kept: bool,
}

/// What is known of an image while the run goes on.
#[derive(Default)]
struct Slot {
    was_shown: bool,
    /// The image and its relative depth, where it stays decoded.
    decoded: Option<(ImageFile, DepthMap)>,
    /// How it was fused in this run.
    outcome: Option<Outcome>,
}

/// A plan at work.
struct Work<'a> {
    plan: &'a Plan,
    options: &'a RunOptions,
    needs: Vec<Need>,
    budget: &'a Budget,
    slots: Vec<Mutex<Slot>>,
}

impl Work<'_> {
    /// Shows an image and its relative depth, and keeps both if they are to stay. Says whether it was the first time.
    fn show(&self, index: usize, look: &mut dyn FnMut(&ImageFile, &DepthMap)) -> Result<bool, FileError> {
        let _room = self.budget.reserve(self.needs[index].work);
        let (image, depth) = self.decoded(index)?;
        look(&image, &depth);
        let mut slot = self.slot(index);
        if self.needs[index].is_kept {
            slot.decoded = Some((image, depth));
        }
        Ok(!std::mem::replace(&mut slot.was_shown, true))
    }

    /// Fuses an image and writes it.
    fn fuse(
        &self,
        index: usize,
        recipe: &Recipe,
        shared: &SharedWater,
        may_replace: bool,
    ) -> Result<(), FuseError> {
        let item = &self.plan.items[index];
        let _room = self.budget.reserve(self.needs[index].work);
        let (mut image, relative) = self.decoded(index)?;
        let share = shared.share_in(&image, &relative)?;
        let found = Analysis {
            depth: in_scene(&relative, shared.units[index]),
            depth_source: item.depth.clone(),
            supplied: None,
            share,
            estimate: shared.water.into(),
        };
        drop(relative);
        let outcome = recipe.operation.apply(&mut image.pixels, Some(&found))?;
        drop(found);
        image.pixels = image.pixels.smoothed(recipe.smoothing);
        self.options.stop.check(&item.output)?;
        let writing = WriteOptions { overwrite: may_replace, quality: recipe.quality };
        image.write(&item.output, &writing)?;
        self.slot(index).outcome = Some(outcome);
        Ok(())
    }

    /// The image and its relative depth: those that stayed, or decoded now.
    fn decoded(&self, index: usize) -> Result<(ImageFile, DepthMap), FileError> {
        let item = &self.plan.items[index];
        self.options.stop.check(&item.output)?;
        // Taken in a statement of its own: no other image waits for the lock while this one is decoded.
        let stayed = self.slot(index).decoded.take();
        if let Some(decoded) = stayed {
            return Ok(decoded);
        }
        let image = ImageFile::open(&item.input, &self.options.reading)?.decode()?;
        self.options.stop.check(&item.output)?;
        let (depth, _) = self.plan.depth_model.depth(&image, &image.bytes())?;
        Ok((image, depth))
    }

    fn slot(&self, index: usize) -> std::sync::MutexGuard<'_, Slot> {
        self.slots[index].lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests;
