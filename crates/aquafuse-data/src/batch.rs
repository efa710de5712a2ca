//! Operations on an image or a folder of images: planned once, then run.
//!
//! # Examples
//!
//! ```
//! use aquafuse::{fusion::Options, smooth::Smoothing};
//! use aquafuse_data::batch::{Plan, Recipe, Request};
//! use aquafuse_data::image_file::{ImageFile, WriteOptions};
//! use aquafuse_data::pipeline::{DepthSource, DepthSupply, Operation, analyse};
//! use aquafuse_data::run::{Event, RunOptions};
//! # use aquafuse::truth::{Scene, Size, waters};
//! # let folder = tempfile::tempdir()?;
//! # let path = |name: &str| folder.path().join(name);
//! # for (name, water) in ["content.png", "reference.png"].into_iter().zip(waters()) {
//! #     let scene = Scene::new(1, Size { width: 64, height: 48 });
//! #     let image = scene.seen_through(&water.water).convert::<u8>();
//! #     ImageFile::new(image).write(&path(name), &WriteOptions::default())?;
//! # }
//!
//! let reference = ImageFile::read(&path("reference.png"))?;
//! let reference = analyse(&reference, &DepthSource::default())?.estimate;
//! let recipe = Recipe::new(Operation::Fuse { reference: reference.into(), options: Options::default() });
//! let depth = DepthSupply::Estimated(Default::default());
//! let contents = [path("content.png")];
//! let plan = Plan::new(&Request::new(&contents, &path("fused.png"), &depth))?;
//! let summary = plan.run(&recipe, &RunOptions::default(), &|event| {
//!     if let Event::Done { item, result } = event {
//!         println!("{}: {:?}", item.output.display(), result.quality);
//!     }
//! })?;
//! assert_eq!((summary.done, summary.failed), (1, 0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod contents;
mod plan;
mod record;

use std::collections::BTreeSet;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use aquafuse::depth::SuppliedReport;
use aquafuse::fusion::Options;
use aquafuse::scene_area::SceneArea;
use aquafuse::smooth::Smoothing;
use aquafuse::stream::Steady;
use aquafuse::waterbody::Quality;
use serde_json::{Value, json};

use crate::files::{FileError, make_folder, make_folder_of, make_folder_within, remove_stale_parts};
use crate::image_file::{Format, ImageFile, Opened, ReadOptions, WriteOptions};
use crate::pipeline::{
    Analysis, DepthEstimator, DepthSource, Operation, Outcome, Scores, WaterEstimate, analyse_in, maps,
};
use crate::run::{self, Budget, Ending, Event, Permit, RunOptions, Summary};
use crate::water_file::Numbers;

pub use plan::{Plan, PlanError, Request};
#[cfg(feature = "fuzz-targets")]
pub(crate) use record::try_parse;
pub use record::{RECORD, Record, State};

/// One image of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Item {
    /// The content.
    pub input: PathBuf,
    /// Where the result goes.
    pub output: PathBuf,
    /// How the content's depth is obtained.
    pub depth: DepthSource,
}

/// Everything except the images that determines the outputs.
#[derive(Clone, Debug)]
pub struct Recipe {
    /// What is done to each image.
    pub operation: Operation,
    /// How outputs are smoothed. Default: not at all.
    pub smoothing: Smoothing,
    /// Rotate each output by its EXIF orientation. Default: no.
    pub upright: bool,
    /// JPEG quality, 1 to 100. Default: 95.
    pub quality: u8,
    /// The images are frames of a sequence, in the order of their names: water and levels are means over so many frames
    /// ([`Steady`]). Default: `None`, each image is by itself.
    pub steady_over: Option<usize>,
}

/// The outcome of one image.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// What the operation did.
    pub outcome: Outcome,
    /// The content's own water, in the encoding that the operation worked in; `None` where it was not estimated.
    pub water: Option<Numbers>,
    /// Scores before and after, if requested.
    pub scores: Option<[Scores; 2]>,
    /// The verdict on the estimate of the content, with its reasons; `None` where there is no estimate.
    pub quality: Option<Quality>,
    /// The report on supplied depth.
    pub supplied: Option<SuppliedReport>,
    /// Whether that is about the depth of a network.
    pub network: bool,
    /// Which part of the content is scene, if not all of it is: the rest is as it was.
    pub area: Option<SceneArea>,
    /// The damage of the content's file, if it was accepted.
    pub damage: Option<String>,
    /// Metadata of the content's file that the output lacks, in words.
    pub left_out: Vec<&'static str>,
}

/// Whoever listens to a batch.
pub type Listener<'a> = run::Listener<'a, Item, Box<Report>>;

impl Recipe {
    /// An operation, with the defaults for everything else.
    pub fn new(operation: Operation) -> Self {
        let quality = WriteOptions::default().quality;
        Self { operation, smoothing: Smoothing::default(), upright: false, quality, steady_over: None }
    }

    /// Everything that determines the outputs: two recipes with the same fingerprint write the same bytes.
    pub fn fingerprint(&self, reading: &ReadOptions) -> Value {
        let Self { operation, smoothing, upright, quality, steady_over } = self;
        let encoding = operation.encoding().name();
        let fusion = |reference: &WaterEstimate, options: &Options| {
            json!({
                "model": options.model.name(),
                "theta": options.incidence.degrees(),
                "alpha": options.gain.get(),
                "most_gain": options.max_gain,
                "water": Numbers::from(reference),
                "quality": reference.quality(),
            })
        };
        let operation = match operation {
            Operation::Fuse { reference, options } => fusion(reference, options),
            Operation::Clarify { reference, options } => json!({ "clarify": fusion(reference, options) }),
            Operation::Restore { options, levels, .. } => {
                json!({ "restore": { "most_gain": options.max_gain, "levels": levels } })
            }
            Operation::Enhance { levels } => json!({ "levels": levels }),
        };
        let mut fingerprint = json!({
            "version": env!("CARGO_PKG_VERSION"),
            "encoding": encoding,
            "treatment": operation,
            "smooth": smoothing.name(),
            "upright": upright,
            "lenient": reading.lenient,
            "border": reading.border.to_string(),
            "water_map": reading.water_map.name(),
            "quality": quality,
        });
        if let (Some(frames), Some(settings)) = (steady_over, fingerprint.as_object_mut()) {
            settings.insert("steady_over".to_owned(), json!(frames));
        }
        fingerprint
    }
}

impl Plan {
    /// Makes every image of the plan that is not made yet, and reports to `listener` in the order in which images get
    /// done.
    ///
    /// The files do not depend on threads or order. A run over a folder continues where it was stopped. The frames of a sequence are
    /// made one after another; one that a run before this one has made is looked at again for those that follow it.
    ///
    /// # Errors
    ///
    /// [`PlanError`] when the run cannot begin: nothing was written then. An image that fails is an event.
    pub fn run(
        &self,
        recipe: &Recipe,
        options: &RunOptions,
        listener: Listener<'_>,
    ) -> Result<Summary, PlanError> {
        let record = self.prepare(recipe, options)?;
        listener(Event::Started { total: self.items().len() });
        let steady = recipe.steady_over.map(|frames| Mutex::new(Steady::over(frames)));
        // One frame after another, by name: with one permit no frame begins before the one before it is made.
        let threads = if steady.is_some() { NonZeroUsize::new(1) } else { options.threads };
        let each = RunOptions { threads, ..options.clone() };
        let work = Work { plan: self, recipe, options, record, budget: options.budget(), steady };
        Ok(each.each(self.items(), &|item, permit| match work.make(item, permit) {
            Ok(Some(report)) => {
                listener(Event::Done { item, result: Box::new(report) });
                Ending::Done
            }
            Ok(None) => {
                listener(Event::Skipped { item });
                Ending::Skipped
            }
            Err(FileError::Stopped { .. }) => Ending::Left,
            Err(error) => {
                listener(Event::Failed { item, error });
                Ending::Failed
            }
        }))
    }

    /// Makes the folders of the outputs ready, and opens the record of a folder's run.
    fn prepare(&self, recipe: &Recipe, options: &RunOptions) -> Result<Option<Record>, PlanError> {
        if let (Some(maps), Some(_)) = (self.maps(), recipe.steady_over) {
            return Err(PlanError::MapsOfSequence { folder: maps.to_owned() });
        }
        // All outputs of a run are in one folder.
        let Some(first) = self.items().first() else { return Ok(None) };
        let record = match self.folder() {
            Some(folder) => {
                make_folder(folder)?;
                let settings = recipe.fingerprint(&options.reading);
                let record = Record::open(folder, &settings, self.overwrite())?;
                self.refuse_foreign(&record)?;
                let inner =
                    self.items().iter().filter_map(|item| item.output.parent()?.strip_prefix(folder).ok());
                for inner in inner.collect::<BTreeSet<_>>() {
                    remove_stale_parts(&make_folder_within(folder, inner)?);
                }
                Some(record)
            }
            None => {
                remove_stale_parts(make_folder_of(&first.output)?);
                None
            }
        };
        if let Some(maps) = self.maps() {
            make_folder(maps)?;
            self.refuse_maps(maps, &recipe.operation, record.as_ref())?;
        }
        Ok(record)
    }
}

/// A plan at work.
struct Work<'a> {
    plan: &'a Plan,
    recipe: &'a Recipe,
    options: &'a RunOptions,
    record: Option<Record>,
    budget: Budget,
    /// What the frames of a sequence say together.
    steady: Option<Mutex<Steady>>,
}

impl Work<'_> {
    /// Makes one image; `None` if a run before this one has made it.
    fn make(&self, item: &Item, permit: &mut Permit<'_>) -> Result<Option<Report>, FileError> {
        let mut writing = WriteOptions { overwrite: self.plan.overwrite(), quality: self.recipe.quality };
        if let Some(record) = &self.record {
            match record.state(item, writing.overwrite) {
                State::Made => {
                    self.look_again(item)?;
                    return Ok(None);
                }
                State::Replaceable => writing.overwrite = true,
                State::Missing | State::Foreign => {}
            }
        }
        let made = self.operate(item, permit, &writing);
        if let (Err(error), Some(record)) = (&made, &self.record)
            && !matches!(error, FileError::Stopped { .. })
        {
            record.failed(item, error)?;
        }
        made.map(Some)
    }

    /// Takes a frame that is made already into the mean, so that the next ones are what they would be in one run.
    fn look_again(&self, item: &Item) -> Result<(), FileError> {
        if self.steady.is_none() {
            return Ok(());
        }
        let opened = ImageFile::open(&item.input, &self.options.reading)?;
        let room = self.budget.reserve(opened.memory_until_written(Format::Png, self.beside(item, &opened))?);
        self.options.stop.check(&item.output)?;
        let mut image = opened.decode()?;
        let found = self.analyse(&image, item)?;
        self.apply(&mut image, found.as_ref());
        drop(room);
        Ok(())
    }

    fn analyse(&self, image: &ImageFile, item: &Item) -> Result<Option<Analysis<WaterEstimate>>, FileError> {
        let operation = &self.recipe.operation;
        let analyse = || analyse_in(operation.encoding(), image, &item.depth);
        operation.needs_analysis().then(analyse).transpose()
    }

    fn apply(&self, image: &mut ImageFile, found: Option<&Analysis<WaterEstimate>>) -> Outcome {
        let operation = &self.recipe.operation;
        let outcome = match &self.steady {
            Some(steady) => {
                let mut steady = steady.lock().unwrap_or_else(PoisonError::into_inner);
                operation.apply_next(&mut image.pixels, found, &mut steady)
            }
            None => operation.apply(&mut image.pixels, found),
        };
        outcome.expect("the depth map is this image's")
    }

    fn operate(
        &self,
        item: &Item,
        permit: &mut Permit<'_>,
        writing: &WriteOptions,
    ) -> Result<Report, FileError> {
        let Self { recipe, options, .. } = self;
        let sources = self.record.as_ref().map(|record| record.sources(item)).transpose()?;
        let opened = ImageFile::open(&item.input, &options.reading)?;
        let format = Format::written(&item.output).unwrap_or(Format::Png);
        let room = self.budget.reserve_for(&opened, format, self.beside(item, &opened))?;
        options.stop.check(&item.output)?;
        let mut image = opened.decode()?;
        options.stop.check(&item.output)?;
        let found = self.analyse(&image, item)?;
        options.stop.check(&item.output)?;
        let scored = |image: &ImageFile| self.plan.scores().then(|| Scores::of(&image.bytes()));
        let before = scored(&image);
        if let (Some(folder), Some(found)) = (self.plan.maps(), &found) {
            maps::write(folder, &item.input, &image, found, &recipe.operation)?;
        }
        let outcome = self.apply(&mut image, found.as_ref());
        let (estimate, supplied) = found.map(|found| (found.estimate, found.supplied)).unzip();
        image.pixels = image.pixels.smoothed(recipe.smoothing);
        let scores = before.zip(scored(&image)).map(|(before, after)| [before, after]);
        let area = image.area().cloned();
        image = image.joined();
        if recipe.upright {
            image = image.upright();
        }
        options.stop.check(&item.output)?;
        let staged = image.stage(&item.output, writing)?;
        let ImageFile { metadata, damage, pixels, .. } = image;
        drop((pixels, room));
        permit.release();
        options.stop.check(&item.output)?;
        if let (Some(record), Some(sources)) = (&self.record, &sources) {
            record.begin(item, sources)?;
        }
        staged.persist()?;
        if let (Some(record), Some(sources)) = (&self.record, sources) {
            record.done(item, sources)?;
        }
        Ok(Report {
            outcome,
            water: estimate.as_ref().map(Numbers::from),
            scores,
            quality: estimate.map(|estimate| estimate.quality()),
            supplied: supplied.flatten(),
            network: matches!(item.depth, DepthSource::Estimated(DepthEstimator::Network(_))),
            area,
            damage,
            left_out: metadata.left_out,
        })
    }

    /// Memory that an item takes beside its image.
    fn beside(&self, item: &Item, opened: &Opened) -> u64 {
        let depth = item.depth.memory(opened.pixels());
        let scores = if self.plan.scores() { SCORED } else { 0 };
        let maps = if self.plan.maps().is_some() { maps::BYTES_A_PIXEL } else { 0 };
        let a_pixel = [scores, maps, self.recipe.operation.bytes_a_pixel()];
        opened.pixels().saturating_mul(a_pixel.into_iter().fold(0, u64::saturating_add)).saturating_add(depth)
    }
}

/// What scoring takes in bytes a pixel: colours in CIELab, chroma and lightness by themselves.
const SCORED: u64 = 48;
