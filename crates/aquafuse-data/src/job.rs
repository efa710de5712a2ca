//! A long run as a stream of messages: whoever started it decides what to show.

mod crew;
mod record;

use std::num::NonZeroUsize;
use std::path::PathBuf;

use aquafuse::depth::SuppliedReport;
use aquafuse::image::{Encoded, Encoding};
use aquafuse::smooth::Smoothing;
use aquafuse::waterbody::Quality;
use serde_json::{Value, json};

use crate::analysis::{DepthSource, analyse};
use crate::files::FileError;
use crate::image_file::{Format, ImageFile, Opened, ReadOptions, WriteOptions};
use crate::maps;
use crate::run::Budget;
use crate::scores::Scores;
use crate::treatment::{Space, Treated, Treatment};
use crate::water_file::Numbers;

pub(crate) use crew::{Crew, Outcome, Turn};
#[cfg(feature = "fuzz-targets")]
pub(crate) use record::try_parse;
pub use record::{Plan, RECORD, Record};

/// Treats images alike: fuses them with one water, or restores them.
#[derive(Debug)]
pub struct Job<E: Encoding = Encoded> {
    /// What to read, and where to write it.
    pub items: Vec<Item>,
    /// What to do with them.
    pub recipe: Recipe<E>,
    /// How to run.
    pub conduct: Conduct,
    /// Which items are done already, and where to say so; none for single images.
    pub record: Option<Record>,
}

/// Everything but the images that decides what is written.
#[derive(Clone, Debug)]
pub struct Recipe<E: Encoding = Encoded> {
    /// What is done to each image.
    pub treatment: Treatment<E>,
    /// How to smooth what comes out.
    pub smoothing: Smoothing,
    /// Turn each output as its EXIF orientation asks for.
    pub upright: bool,
    /// How to read.
    pub reading: ReadOptions,
    /// How to write.
    pub writing: WriteOptions,
}

/// How a job runs; nothing that is written depends on it.
#[derive(Clone, Debug, Default)]
pub struct Conduct {
    /// Images in work at once, beside those that wait for the disk; none: one a core.
    pub threads: Option<NonZeroUsize>,
    /// Stop once more images than this have failed; none: never.
    pub most_failures: Option<usize>,
    /// Score each image before and after.
    pub scores: bool,
    /// Write the maps of each image into this folder.
    pub maps: Option<PathBuf>,
}

/// One image of a job.
#[derive(Clone, Debug, PartialEq)]
pub struct Item {
    /// The content.
    pub input: PathBuf,
    /// What comes of it.
    pub output: PathBuf,
    /// How to come by the content's depth.
    pub depth: DepthSource,
}

/// What a running job says.
#[derive(Debug)]
#[non_exhaustive]
pub enum Message<'a> {
    /// It begins, with this many images.
    Started {
        /// Images.
        total: usize,
    },
    /// An image was written by a run before this one.
    Kept {
        /// Which.
        item: &'a Item,
    },
    /// An image is written.
    Done {
        /// Which.
        item: &'a Item,
        /// What is worth knowing about it.
        report: Box<Report>,
    },
    /// An image failed; the others go on.
    Failed {
        /// Which.
        item: &'a Item,
        /// Why.
        error: FileError,
    },
}

/// What is worth knowing about a treated image.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// What was done to it.
    pub treated: Treated,
    /// Its own water, of the encoding it was worked on in.
    pub water: Numbers,
    /// How good it looks before and after, where that was asked for.
    pub scores: Option<[Scores; 2]>,
    /// What the estimate of the content is worth.
    pub quality: Quality,
    /// What is worth knowing about its depth, where that was supplied.
    pub supplied: Option<SuppliedReport>,
    /// What was wrong with its file, where that was taken nevertheless.
    pub damage: Option<String>,
    /// What its file holds and the output does not, in words.
    pub left_out: Vec<&'static str>,
}

/// How a job ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Summary {
    /// Images written.
    pub done: usize,
    /// Images that a run before had written.
    pub kept: usize,
    /// Images that failed.
    pub failed: usize,
    /// Images that were not tried, because too many had failed.
    pub left: usize,
}

impl<E: Space> Recipe<E> {
    /// Everything in it that decides what is written: two recipes of one fingerprint write the same bytes.
    pub fn fingerprint(&self) -> Value {
        let Self { treatment, smoothing, upright, reading, writing } = self;
        let treatment = match treatment {
            Treatment::Fuse { reference, options } => json!({
                "model": options.model.name(),
                "theta": options.incidence.degrees(),
                "alpha": options.gain.get(),
                "most_gain": options.max_gain,
                "water": Numbers::from(&reference.water),
                "quality": reference.quality,
            }),
            Treatment::Restore(options) => json!({ "restore": { "most_gain": options.max_gain } }),
        };
        json!({
            "version": env!("CARGO_PKG_VERSION"),
            "encoding": E::NAME,
            "treatment": treatment,
            "smooth": smoothing.name(),
            "upright": upright,
            "lenient": reading.lenient,
            "quality": writing.quality,
        })
    }
}

impl<E: Space> Job<E> {
    /// Runs the job, telling `listener` in the order in which images get done. The files do not depend on that
    /// order.
    pub fn run(&self, listener: &(dyn Fn(Message<'_>) + Sync)) -> Summary {
        listener(Message::Started { total: self.items.len() });
        let budget = self.recipe.reading.budget();
        let Conduct { threads, most_failures, .. } = self.conduct;
        Crew { threads, most_failures }.each(
            &self.items,
            &|item, turn| match self.make(item, &budget, turn) {
                Ok(Some(report)) => {
                    listener(Message::Done { item, report: Box::new(report) });
                    Outcome::Done
                }
                Ok(None) => {
                    listener(Message::Kept { item });
                    Outcome::Kept
                }
                Err(error) => {
                    listener(Message::Failed { item, error });
                    Outcome::Failed
                }
            },
        )
    }

    /// Makes one image; none if it is there already.
    fn make(&self, item: &Item, budget: &Budget, turn: &mut Turn<'_>) -> Result<Option<Report>, FileError> {
        let mut writing = self.recipe.writing;
        if let Some(record) = &self.record {
            match record.plan(item, writing.overwrite) {
                Plan::Kept => return Ok(None),
                Plan::Replace => writing.overwrite = true,
                Plan::Make | Plan::Foreign => {}
            }
        }
        let made = self.treat(item, budget, turn, &writing);
        if let (Err(error), Some(record)) = (&made, &self.record) {
            record.failed(item, error)?;
        }
        made.map(Some)
    }

    fn treat(
        &self,
        item: &Item,
        budget: &Budget,
        turn: &mut Turn<'_>,
        writing: &WriteOptions,
    ) -> Result<Report, FileError> {
        let sources = self.record.as_ref().map(|record| record.sources(item)).transpose()?;
        let opened = ImageFile::open(&item.input, &self.recipe.reading)?;
        let format = Format::written(&item.output).unwrap_or(Format::Png);
        let room = budget.reserve(opened.memory_until_written(format, self.beside(item, &opened))?);
        let mut image = opened.decode()?;
        let found = analyse::<E>(&image, &item.depth)?;
        let scored = |image: &ImageFile| self.conduct.scores.then(|| Scores::of(&image.bytes()));
        let before = scored(&image);
        if let Some(folder) = &self.conduct.maps {
            maps::write(folder, &item.input, &image, &found, &self.recipe.treatment)?;
        }
        let treated =
            self.recipe.treatment.apply(&mut image.pixels, &found).expect("the depth map is this image's");
        let (estimate, supplied) = (found.estimate, found.supplied);
        drop(found.depth);
        image.pixels = image.pixels.smoothed(self.recipe.smoothing);
        let scores = before.zip(scored(&image)).map(|(before, after)| [before, after]);
        if self.recipe.upright {
            image = image.upright();
        }
        let staged = image.stage(&item.output, writing)?;
        let ImageFile { metadata, damage, pixels } = image;
        drop((pixels, room));
        turn.end();
        if let (Some(record), Some(sources)) = (&self.record, &sources) {
            record.begin(item, sources)?;
        }
        staged.persist()?;
        if let (Some(record), Some(sources)) = (&self.record, sources) {
            record.done(item, sources)?;
        }
        Ok(Report {
            treated,
            water: Numbers::from(&estimate.water),
            scores,
            quality: estimate.quality,
            supplied,
            damage,
            left_out: metadata.left_out,
        })
    }

    /// Memory that an item takes beside its image.
    fn beside(&self, item: &Item, opened: &Opened) -> u64 {
        let supplied = match &item.depth {
            DepthSource::Supplied { .. } => SUPPLIED,
            DepthSource::Estimated(_) => 0,
        };
        let scores = if self.conduct.scores { SCORED } else { 0 };
        let maps = if self.conduct.maps.is_some() { maps::BYTES_A_PIXEL } else { 0 };
        let a_pixel = [supplied, scores, maps, self.recipe.treatment.bytes_a_pixel()];
        opened.pixels().saturating_mul(a_pixel.into_iter().fold(0, u64::saturating_add))
    }
}

/// What a supplied depth map takes in bytes a pixel: as stored, as floats of its file and as distances.
pub(crate) const SUPPLIED: u64 = 16;
/// What scoring takes in bytes a pixel: colours in CIELab, chroma and lightness by themselves.
const SCORED: u64 = 48;
