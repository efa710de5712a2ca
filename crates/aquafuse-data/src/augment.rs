//! Datasets multiplied: each image seen in other waters, its annotations carried over.
//!
//! Objects do not move, so boxes, outlines, key points, masks and captions of an image hold for its variants too.

mod annotations;
mod containers;
mod depth;
mod draw;
mod finish;
mod header;
mod journal;
mod line;
mod make;
mod manifest;
#[cfg(feature = "parquet")]
mod manifest_table;
mod plan;
mod preview;
mod replay;
mod verify;
mod water;

use std::path::PathBuf;

use aquafuse::fusion::Options;
use aquafuse::smooth::Smoothing;
use aquafuse::waterbody::Verdict;

#[cfg(feature = "fuzz-targets")]
pub(crate) use annotations::try_coco;
pub use draw::{Draw, Draws};
use journal::Journal;
pub use replay::{Again, Replayed, replay};
pub use verify::{Checked, Finding, verify};
pub use water::{OnDoubtful, Sea, Water};

use crate::dataset::{Dataset, Splits};
use crate::files::{FileError, display, make_folder_within, remove_stale_parts};

use crate::pipeline::PixelEncoding;
use crate::run::{self, Ending, Event, Permit, RunOptions, Summary};
use crate::water_file::WaterFileError;
pub use depth::DepthPlan;
pub use plan::{Plan, PlanError};

/// A dataset to multiply.
#[derive(Debug)]
pub struct Augmentation {
    /// The dataset.
    pub dataset: Dataset,
    /// The output folder: new, empty, or of a run to continue.
    pub output: PathBuf,
    /// How variants are made.
    pub recipe: Recipe,
    /// Which part of the dataset to make.
    pub shard: Shard,
    /// Delete what a run with other settings wrote, and start over.
    pub overwrite: bool,
    /// Also write the manifest as a Parquet table; needs the feature `parquet`.
    pub manifest_table: bool,
    /// Images on the sheet `preview.jpg`, each with its first variants and its annotations; 0: no sheet. Files that hold many
    /// images have none, nor have parts of a dataset.
    pub preview: usize,
    /// How to run.
    pub run_options: RunOptions,
}

/// Everything but the images that decides what is made.
#[derive(Clone, Debug)]
pub struct Recipe {
    /// The waters to draw from.
    pub waters: Vec<Water>,
    /// Also draw waters from the sea, every second one if there are others.
    pub sea: Option<Sea>,
    /// Which values to work on; the waters are of this encoding.
    pub encoding: PixelEncoding,
    /// Variants of each image.
    pub per_image: u32,
    /// How water, θ and α are sampled.
    pub draws: Draws,
    /// The model and its options, except θ and α.
    pub options: Options,
    /// How outputs are smoothed.
    pub smoothing: Smoothing,
    /// How depth is obtained.
    pub depth: DepthPlan,
    /// What to do about doubtful estimates.
    pub on_doubtful: OnDoubtful,
    /// What was done about bad annotations, for the manifest.
    pub on_bad_annotation: &'static str,
    /// Also copy the original images.
    pub keep_originals: bool,
    /// The share of the images written that are copies of originals, 0 to 1, as far as one copy of each makes it
    /// ([`Draws::keeps`]).
    pub keep_share: f64,
    /// Which splits are multiplied; images of the others are copied unchanged.
    pub splits: Splits,
    /// JPEG quality.
    pub quality: u8,
}

/// A part of a dataset: this one of so many, counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// Which.
    pub number: u32,
    /// Of how many.
    pub of: u32,
}

impl Default for Shard {
    /// All of it.
    fn default() -> Self {
        Self { number: 1, of: 1 }
    }
}

impl Shard {
    /// Whether an image belongs to it.
    pub fn holds(self, key: &str) -> bool {
        Draws::shard(key, self.of) == self.number.saturating_sub(1)
    }

    /// Part of the names of files about all images, so that shards write different files.
    fn infix(self) -> String {
        if self.of == 1 { String::new() } else { format!(".shard-{}-of-{}", self.number, self.of) }
    }

    fn manifest(self) -> String {
        format!("manifest{}.jsonl", self.infix())
    }

    #[cfg(feature = "parquet")]
    fn manifest_table(self) -> String {
        format!("manifest{}.parquet", self.infix())
    }
}

/// The outcome of one image.
#[derive(Clone, Debug, PartialEq)]
pub struct Multiplied {
    /// Variants that were made.
    pub variants: usize,
    /// Whether it was carried over unchanged, because its split is not multiplied.
    pub is_carried: bool,
    /// Originals that were copied beside their variants.
    pub originals: usize,
    /// Variants that were drawn again, because the scene was hidden or hardly changed.
    pub redrawn: usize,
    /// Variants in which the water hides the scene.
    pub vanished: usize,
    /// Variants that hardly differ from their image.
    pub unchanged: usize,
    /// The verdict on its estimate.
    pub verdict: Option<Verdict>,
    /// Its lines of the manifest.
    pub lines: String,
}

/// Whoever listens to an augmentation. An item is the key of an image; a file of many images may fail in several of
/// them and be done all the same.
pub type Listener<'a> = run::Listener<'a, str, Multiplied>;

/// A dataset cannot be multiplied, or its manifest cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AugmentError {
    /// A file cannot be read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// The requested variants cannot be made.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// A file is no manifest of this version.
    #[error(
        "cannot read {}: line {line} is not of a manifest of this version. Move it away, or give another output",
        display(path)
    )]
    Manifest {
        /// The manifest.
        path: PathBuf,
        /// The line.
        line: usize,
    },
    /// An image has no variants that could be made again.
    #[error(
        "cannot replay {key} from {}: it was copied unchanged, because its split was not multiplied; copy it from the dataset",
        display(path)
    )]
    Carried {
        /// The manifest.
        path: PathBuf,
        /// The image.
        key: String,
    },
    /// There is no manifest.
    #[error("{} holds no manifest.jsonl; it was not made by `aquafuse augment`", display(folder))]
    NoManifest {
        /// The folder.
        folder: PathBuf,
    },
    /// There is no variant of this name.
    #[error("{} lists no variant and no image {key:?}; copy a path from the manifest", display(path))]
    NoSuchKey {
        /// The manifest.
        path: PathBuf,
        /// What was asked for.
        key: String,
    },
    /// A water in a manifest is invalid.
    #[error(transparent)]
    Water(#[from] WaterFileError),
}

impl Augmentation {
    /// Makes the variants of a [plan](Self::plan) that do not exist yet, reports to `listener`, and writes the manifest.
    ///
    /// The files do not depend on threads, nor on how often the run was stopped.
    ///
    /// # Errors
    ///
    /// [`AugmentError`] when the work cannot begin, or the files about all images cannot be written. An image that
    /// fails is no error: it is counted, and listed in the manifest.
    pub fn run(&self, plan: &Plan<'_>, listener: Listener<'_>) -> Result<Summary, AugmentError> {
        let samples = &self.dataset.samples;
        let mut depths = depth::Maps::of(&self.recipe.depth, Some(&self.output))?;
        plan.samples().try_for_each(|sample| depths.know(&sample.key))?;
        let header = self.header();
        let place = |key: &str| {
            let place = samples.binary_search_by(|sample| sample.key.as_str().cmp(key)).ok();
            place.filter(|_| self.shard.holds(key))
        };
        let journal = Journal::open(
            &self.output,
            self.shard,
            &header,
            self.overwrite,
            &self.run_options.reading,
            &place,
        )?;
        for folder in plan.folders() {
            remove_stale_parts(&make_folder_within(&self.output, &folder)?);
        }
        listener(Event::Started { total: plan.files() });
        let maker = make::Maker::new(self, depths);
        let work = |&index: &usize, _: &mut Permit<'_>| {
            let Some(sample) = plan.planned(index) else { return Ending::Skipped };
            let make::Made { multiplied, failures } = maker.make(&sample, &journal);
            let outcome = match (&multiplied, &failures[..]) {
                (_, [FileError::Stopped { .. }]) => return Ending::Left,
                (_, [_, ..]) => Ending::Failed,
                (Some(_), []) => Ending::Done,
                (None, []) => Ending::Skipped,
            };
            for error in failures {
                listener(Event::Failed { item: sample.key, error });
            }
            if let Some(result) = multiplied {
                listener(Event::Done { item: sample.key, result });
            } else if outcome == Ending::Skipped {
                listener(Event::Skipped { item: sample.key });
            }
            outcome
        };
        let summary = self.run_options.each(plan.indices(), &work);
        if summary.left == 0 {
            let indices = self.write_indices(plan, &journal)?;
            journal.seal(&header, indices)?;
        }
        Ok(summary)
    }
}

/// Reads a manifest for nothing but that: a target of fuzzing.
#[cfg(feature = "fuzz-targets")]
pub(crate) fn try_manifest(bytes: &[u8]) {
    use std::io::Cursor;

    use line::Line;
    use manifest::{Manifest, Sealing, scan};

    let lines = |bytes: &[u8]| {
        let mut lines = Vec::new();
        let scanned = scan(bytes, (bytes.len() as u64).saturating_add(1), |line, _| lines.push(line)).ok()?;
        // As a run that ends writes them: those about all images come last.
        lines.sort_by_key(|line| matches!(line, Line::Index(_)));
        Some((scanned.header, lines))
    };
    let Some((header, found)) = lines(bytes) else { return };
    let most_line = (bytes.len() as u64).saturating_add(1);
    let shown = Manifest::of(Cursor::new(bytes), most_line).and_then(|mut manifest| manifest.show(|_| {}));
    assert!(shown.is_ok(), "what was read is read again");
    let mut sealing = Sealing::begin(Vec::new(), &header).expect("memory takes what is written");
    let mut indices = Vec::new();
    for line in &found {
        match line {
            Line::Index(written) => indices.push(written.clone()),
            line => sealing.add(line.text().as_bytes()).expect("memory takes what is written"),
        }
    }
    let text = sealing.end(indices).expect("memory takes what is written");
    assert_eq!(lines(&text), Some((header, found)), "what is written is read");
}

#[cfg(test)]
mod tests;
