//! A long run as a stream of messages: whoever started it decides what to show.

mod record;

use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;

use aquafuse::depth::SuppliedReport;
use aquafuse::fusion::{Bounded, Bounds, Clipping, Options};
use aquafuse::smooth::Smoothing;
use aquafuse::waterbody::{Estimate, Quality};

use crate::analysis::{DepthSource, analyse};
use crate::memory::Budget;
use crate::picture::{FileError, Format, Opened, Picture, ReadOptions, WriteOptions};

#[cfg(feature = "fuzz-targets")]
pub(crate) use record::try_parse;
pub use record::{Plan, RECORD, Record};

/// Fuses pictures with one water.
#[derive(Debug)]
pub struct Fuse {
    /// What to read, and where to write it.
    pub items: Vec<Item>,
    /// How to fuse them.
    pub recipe: Recipe,
    /// How to run.
    pub conduct: Conduct,
    /// Which items are done already, and where to say so; none for single pictures.
    pub record: Option<Record>,
}

/// Everything but the pictures that decides what is written.
#[derive(Clone, Debug)]
pub struct Recipe {
    /// The reference's water, and what it is worth.
    pub reference: Estimate,
    /// How to fuse.
    pub options: Options,
    /// How to smooth what was fused.
    pub smoothing: Smoothing,
    /// Turn each output as its EXIF orientation asks for.
    pub upright: bool,
    /// How to read.
    pub reading: ReadOptions,
    /// How to write.
    pub writing: WriteOptions,
}

/// How a job runs; nothing that is written depends on it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Conduct {
    /// Pictures in work at once; none: one a core.
    pub threads: Option<NonZeroUsize>,
    /// Stop once more pictures than this have failed; none: never.
    pub most_failures: Option<usize>,
}

/// One picture of a job.
#[derive(Clone, Debug, PartialEq)]
pub struct Item {
    /// The content.
    pub input: PathBuf,
    /// The fused picture.
    pub output: PathBuf,
    /// How to come by the content's depth.
    pub depth: DepthSource,
}

/// What a running job says.
#[derive(Debug)]
#[non_exhaustive]
pub enum Message<'a> {
    /// It begins, with this many pictures.
    Started {
        /// Pictures.
        total: usize,
    },
    /// A picture was written by a run before this one.
    Kept {
        /// Which.
        item: &'a Item,
    },
    /// A picture is written.
    Done {
        /// Which.
        item: &'a Item,
        /// What is worth knowing about it.
        report: Report,
    },
    /// A picture failed; the others go on.
    Failed {
        /// Which.
        item: &'a Item,
        /// Why.
        error: FileError,
    },
}

/// What is worth knowing about a fused picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Values that did not fit into the range.
    pub clipping: Clipping,
    /// What the estimate of the content is worth.
    pub quality: Quality,
    /// Which safety bounds acted.
    pub bounds: Bounds,
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
    /// Pictures written.
    pub done: usize,
    /// Pictures that a run before had written.
    pub kept: usize,
    /// Pictures that failed.
    pub failed: usize,
    /// Pictures that were not tried, because too many had failed.
    pub left: usize,
}

impl Recipe {
    /// Everything in it that decides what is written, as text: two recipes of one text write the same bytes.
    pub fn fingerprint(&self) -> String {
        let Self { reference, options, smoothing, upright, reading, writing } = self;
        let (water, verdict) = (&reference.water, reference.quality);
        let (lenient, quality) = (reading.lenient, writing.quality);
        let version = env!("CARGO_PKG_VERSION");
        format!(
            "{version} {water:?} {verdict:?} {options:?} {smoothing:?} upright {upright} lenient {lenient} JPEG {quality}"
        )
    }
}

impl Fuse {
    /// Runs the job, telling `listener` in the order in which pictures get done. The files do not depend on that
    /// order.
    pub fn run(&self, listener: &(dyn Fn(Message<'_>) + Sync)) -> Summary {
        listener(Message::Started { total: self.items.len() });
        let cores = || thread::available_parallelism().map_or(1, NonZeroUsize::get);
        let threads = self.conduct.threads.map_or_else(cores, NonZeroUsize::get);
        let progress = Progress::default();
        let budget = self.recipe.reading.budget();
        // Threads of its own: one that waits for memory in a pool could be given work that waits for it.
        thread::scope(|scope| {
            for _ in 0..threads.min(self.items.len()) {
                scope.spawn(|| self.work(&progress, &budget, listener));
            }
        });
        let Progress { done, kept, failed, .. } = progress;
        let [done, kept, failed] = [done, kept, failed].map(AtomicUsize::into_inner);
        let tried = done.saturating_add(kept).saturating_add(failed);
        Summary { done, kept, failed, left: self.items.len().saturating_sub(tried) }
    }

    /// Takes item after item until there is none left or too many failed.
    fn work(&self, progress: &Progress, budget: &Budget, listener: &(dyn Fn(Message<'_>) + Sync)) {
        while let Some(item) = self.items.get(progress.next.fetch_add(1, Ordering::Relaxed)) {
            if progress.stopped.load(Ordering::Relaxed) {
                return;
            }
            match self.make(item, budget) {
                Ok(Some(report)) => {
                    progress.done.fetch_add(1, Ordering::Relaxed);
                    listener(Message::Done { item, report });
                }
                Ok(None) => {
                    progress.kept.fetch_add(1, Ordering::Relaxed);
                    listener(Message::Kept { item });
                }
                Err(error) => {
                    let failed_before = progress.failed.fetch_add(1, Ordering::Relaxed);
                    if self.conduct.most_failures.is_some_and(|most| failed_before >= most) {
                        progress.stopped.store(true, Ordering::Relaxed);
                    }
                    listener(Message::Failed { item, error });
                }
            }
        }
    }

    /// Makes one picture; none if it is there already.
    fn make(&self, item: &Item, budget: &Budget) -> Result<Option<Report>, FileError> {
        let mut writing = self.recipe.writing;
        if let Some(record) = &self.record {
            match record.plan(item, writing.overwrite) {
                Plan::Kept => return Ok(None),
                Plan::Replace => writing.overwrite = true,
                Plan::Make | Plan::Foreign => {}
            }
        }
        let made = self.fuse_file(item, budget, &writing);
        if let (Err(error), Some(record)) = (&made, &self.record) {
            record.failed(item, error)?;
        }
        made.map(Some)
    }

    fn fuse_file(&self, item: &Item, budget: &Budget, writing: &WriteOptions) -> Result<Report, FileError> {
        let sources = self.record.as_ref().map(|record| record.sources(item)).transpose()?;
        let opened = Picture::open(&item.input, &self.recipe.reading)?;
        let format = Format::written(&item.output).unwrap_or(Format::Png);
        let _room = budget.reserve(opened.memory_until_written(format, beside(item, &opened))?);
        let mut picture = opened.decode()?;
        let found = analyse(&picture, &item.depth)?;
        let bounded = Bounded::new(&found.estimate, &self.recipe.reference, self.recipe.options);
        let clipping = picture
            .pixels
            .fuse_mut(&found.depth, bounded.waters(), &bounded.options)
            .expect("the depth map was made for this picture");
        let (quality, supplied) = (found.estimate.quality, found.supplied);
        drop(found.depth);
        picture.pixels = picture.pixels.smoothed(self.recipe.smoothing);
        if self.recipe.upright {
            picture = picture.upright();
        }
        if let (Some(record), Some(sources)) = (&self.record, &sources) {
            record.begin(item, sources)?;
        }
        picture.write(&item.output, writing)?;
        if let (Some(record), Some(sources)) = (&self.record, sources) {
            record.done(item, sources)?;
        }
        let Picture { metadata, damage, .. } = picture;
        Ok(Report {
            clipping,
            quality,
            bounds: bounded.bounds,
            supplied,
            damage,
            left_out: metadata.left_out,
        })
    }
}

/// What a supplied depth map takes in bytes a pixel: as stored, as floats of its file and as distances.
const SUPPLIED: u64 = 16;

/// Memory that an item takes beside its picture.
fn beside(item: &Item, opened: &Opened) -> u64 {
    match &item.depth {
        DepthSource::Supplied { .. } => opened.pixels().saturating_mul(SUPPLIED),
        DepthSource::Estimated(_) => 0,
    }
}

#[derive(Default)]
struct Progress {
    next: AtomicUsize,
    done: AtomicUsize,
    kept: AtomicUsize,
    failed: AtomicUsize,
    stopped: AtomicBool,
}
