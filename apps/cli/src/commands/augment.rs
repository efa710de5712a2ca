//! `aquafuse augment`: a dataset multiplied, with its annotations.

mod range;
mod summary;
mod waters;

use std::path::PathBuf;
use std::sync::Mutex;

use anyhow::anyhow;
use aquafuse_data::augment::{Augmentation, DepthPlan, Draws, OnDoubtful, Recipe, Shard};
use aquafuse_data::dataset::{Dataset, DatasetOptions, Layout, Splits};
use aquafuse_data::files::{display, make_folder};
use aquafuse_data::pipeline::PixelEncoding;
use aquafuse_data::run::{Event, RunOptions, Summary};
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{ArgGroup, Args, ValueEnum};
use range::Range;

use crate::args::border::BorderArgument;
use crate::args::common::{Common, encoding};
use crate::args::depth::DepthArguments;
use crate::args::failures::FailureArguments;
use crate::args::fusion::{Settings, SettingsArgs};
use crate::args::water::{WaterArguments, WaterSource};
use crate::failure::Failure;
use crate::report::output;
use crate::report::progress::Progress;

const HELP: &str = "\
Layouts, detected from the files:
  folder   images in folders, where nothing looks like annotations
  coco     JSON with images and annotations: boxes, outlines, key points, captions
  yolo     images/NAME.jpg with labels/NAME.txt, and data.yaml if there is one
  voc      JPEGImages/NAME.jpg with Annotations/NAME.xml, and lists of names
  masks    images/NAME.jpg with masks/NAME.png, or a folder in masks/ for each class
  shards   WebDataset: tar files with KEY.jpg and all other members of that key
  parquet  Hugging Face: tables with a column of images (needs a build with --features parquet)

Only the training split is multiplied: images to validate and test by are copied unchanged, with
their annotations. Splits are those of data.yaml, of lists as ImageSets/Main/train.txt, of the names
of COCO files and of folders (train, valid, val, test). --splits chooses others.

Folders may have the other usual names (img, label, gt, ...), and labels may stand beside images.
Files that are not part of the dataset are named and counted; if they look like annotations and
none was read, nothing is written, unless --format folder leaves them out.

Pixels do not move, so annotations stay valid: labels and masks are copied byte for byte, JSON
and XML with new ids and file names, data.yaml without its `path`. A variant is named
STEM__WATER__NUMBER and is written to the folder (and so the split) of its image. manifest.jsonl
records how each variant was made: `verify` checks it, `replay` repeats it; preview.jpg shows a few
images with their variants and what their annotations say. To continue a run that
was stopped, repeat the command.

So that a model that trains on the output also sees the water of the originals, a quarter of the
images written are copies of originals, each at most once and with its annotations. For variants
alone set --keep-share 0, for all originals --keep-originals.

Where theta, alpha or the water is drawn, a variant in which the water hides the scene, or which
hardly differs from its image, is drawn again, up to 7 times.

Examples:
  aquafuse augment fish/ green.jpg blue.jpg -o more/ --per-image 2 --keep-originals
  aquafuse augment fish/ waters/ preset:jerlov-3C -o more/ --per-image 5 --theta-range 0,60
                                                     a folder of reference images, and a preset
  aquafuse augment fish/ --waters sea --model relight --per-image 5 -o more/
                                                     a new water for each variant, without references
  aquafuse augment coco/ waters/ -o more/ --shard 1/4
                                                     on 1 of 4 machines; to join, put the outputs
                                                     into one folder, repeat without --shard";

/// Multiply a dataset: put every image into other waters and keep its annotations.
#[derive(Args)]
#[command(after_help = HELP, group = ArgGroup::new("area").args(["border", "water_map"]).multiple(true).conflicts_with("as_published"))]
pub(crate) struct Augment {
    /// The folder of the dataset.
    dataset: PathBuf,
    /// The waters to sample from: images, folders of images, NAME.water.json, preset:NAME, sea:NUMBER.
    #[arg(required_unless_present = "drawn")]
    waters: Vec<PathBuf>,
    /// `sea`: draw a water for each variant: type of water, depth below the surface, camera, balance and exposure together.
    /// Needs no reference. With WATERS too, every second variant gets one of them.
    #[arg(long = "waters", id = "drawn", value_name = "FROM", value_enum)]
    drawn: Option<Drawn>,
    /// Output folder: new, empty, or of a run to continue.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Layout of the dataset [default: detected].
    #[arg(long, value_name = "LAYOUT", value_parser = layout())]
    format: Option<Layout>,
    /// Number of variants of each image: at most the number of waters, unless theta or alpha has a range or waters are drawn.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    per_image: u32,
    /// The splits to multiply: all, or some of train,val,test. Images of other splits are copied unchanged, with their
    /// annotations [default: train, if the dataset has a training split and others; else all].
    #[arg(long, value_name = "SPLITS")]
    splits: Option<Splits>,
    /// Extensions of further files, as json,txt. A file that has one and the name of an image belongs to that image: it is
    /// copied for each variant, and the image's file name in it becomes the variant's.
    #[arg(long, value_name = "EXT", value_delimiter = ',')]
    sidecar: Vec<String>,
    /// Share of the images written that are copies of originals, 0 to 1: with one variant of each image, 0.25 copies one image
    /// in three; with three variants or more it copies every image once.
    #[arg(long, value_name = "SHARE", default_value_t = 0.25, value_parser = share)]
    keep_share: f64,
    /// Copy all original images, byte for byte.
    #[arg(long, conflicts_with = "keep_share")]
    keep_originals: bool,
    /// Random seed. Draws depend only on it, the image path and the variant number.
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
    /// Sample waters with replacement: an image may get one water twice, and equal variants without a range of theta or
    /// alpha.
    #[arg(long)]
    with_replacement: bool,
    /// Sample theta uniformly from this range, in degrees.
    #[arg(long, value_name = "LOW,HIGH", conflicts_with = "theta")]
    theta_range: Option<Range>,
    /// Sample alpha uniformly from this range.
    #[arg(long, value_name = "LOW,HIGH", conflicts_with = "alpha")]
    alpha_range: Option<Range>,
    /// What to do if the estimate of an image's own water, or of a water to sample, is doubtful or failed: `flag` notes
    /// it in the manifest, `skip` leaves the image or water out, preset:NAME uses that water instead.
    #[arg(long, value_name = "HOW", default_value = "flag")]
    on_doubtful: Doubtful,
    /// What to do about bad annotations: a box outside the image, a duplicate id, a path outside the dataset. Both
    /// `skip` and `keep` drop annotations without an image.
    #[arg(long, value_name = "HOW", value_enum, default_value_t)]
    on_bad_annotation: OnBad,
    /// Process only part I of N, for N machines that share the dataset.
    #[arg(long, value_name = "I/N", value_parser = shard)]
    shard: Option<Shard>,
    /// Print what would be written, and write nothing.
    #[arg(long)]
    dry_run: bool,
    #[command(flatten)]
    settings: SettingsArgs,
    #[command(flatten)]
    border: BorderArgument,
    #[command(flatten)]
    depth: DepthArguments,
    #[command(flatten)]
    presets: WaterArguments,
    /// JPEG quality, 1 to 100.
    #[arg(long, value_name = "Q", default_value_t = 95, value_parser = clap::value_parser!(u8).range(1..=100))]
    quality: u8,
    /// Compute in linear light instead of encoded values.
    #[arg(long)]
    linear: bool,
    /// Delete what a run with other settings wrote to DIR, and start over.
    #[arg(long)]
    overwrite: bool,
    #[command(flatten)]
    failures: FailureArguments,
    /// Format of the manifest. manifest.jsonl is always written; `parquet` adds a table with one row per variant.
    #[arg(long, value_name = "AS", value_enum, default_value_t)]
    manifest: Manifest,
    /// Images on the sheet preview.jpg, each with three variants and its boxes, outlines and masks; 0: no sheet.
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u16).range(0..=100))]
    preview: u16,
    /// Print the lines of the manifest as they are written instead of the summary.
    #[arg(long)]
    json: bool,
}

/// Where waters come from that need no file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Drawn {
    /// Jerlov's types of water, looked at from many depths with many cameras.
    Sea,
}

/// How the manifest is written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum Manifest {
    /// JSON lines.
    #[default]
    Jsonl,
    /// JSON lines, and a Parquet table.
    Parquet,
}

/// What to do about bad annotations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum OnBad {
    /// List them and write nothing.
    #[default]
    Refuse,
    /// Leave out the images they belong to.
    Skip,
    /// Copy them unchanged.
    Keep,
}

impl OnBad {
    fn name(self) -> &'static str {
        match self {
            Self::Refuse => "refuse",
            Self::Skip => "skip",
            Self::Keep => "keep",
        }
    }
}

/// What to do about doubtful waters.
#[derive(Clone, Debug)]
enum Doubtful {
    Flag,
    Skip,
    Instead(WaterSource),
}

impl std::str::FromStr for Doubtful {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> anyhow::Result<Self> {
        match text {
            "flag" => Ok(Self::Flag),
            "skip" => Ok(Self::Skip),
            preset if preset.starts_with("preset:") => match WaterSource::parse(preset.as_ref()) {
                Ok(source) => Ok(Self::Instead(source)),
                Err(failure) => Err(anyhow!("{failure}")),
            },
            _ => Err(anyhow!("give flag, skip or preset:NAME")),
        }
    }
}

fn layout() -> impl TypedValueParser<Value = Layout> {
    PossibleValuesParser::new(Layout::ALL.map(Layout::name))
        .try_map(|name| Layout::from_name(&name).ok_or_else(|| anyhow!("unknown layout")))
}

fn share(text: &str) -> Result<f64, String> {
    let share: f64 = text.parse().map_err(|_| "not a number")?;
    if (0.0..=1.0).contains(&share) { Ok(share) } else { Err("give 0 to 1".into()) }
}

fn shard(text: &str) -> anyhow::Result<Shard> {
    let (number, of) = text.split_once('/').ok_or_else(|| anyhow!("give I/N, as 1/4"))?;
    let (number, of): (u32, u32) = (number.parse()?, of.parse()?);
    if number == 0 || number > of {
        return Err(anyhow!("I must be from 1 to N"));
    }
    Ok(Shard { number, of })
}

impl Augment {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        let common = &self.settings.cutting(&self.border, common);
        let encoding = encoding(self.linear);
        let how = DatasetOptions {
            layout: self.format,
            sidecars: self.sidecar.clone(),
            reading: common.reading.options(),
        };
        let mut dataset = Dataset::open_with(&self.dataset, &how).map_err(Failure::usage)?;
        let splits = dataset.splits(self.splits.as_ref()).map_err(Failure::usage)?;
        let bad = self.without_bad(&mut dataset)?;
        if (common.quiet || self.json) && dataset.left_out.has_labels() {
            output::complain(&format!("{}: left out: {}", display(&self.dataset), dataset.left_out));
        }
        let job = Augmentation {
            recipe: Recipe { splits, ..self.recipe(encoding, common)? },
            dataset,
            output: self.output.clone(),
            shard: self.shard.unwrap_or_default(),
            overwrite: self.overwrite,
            manifest_table: self.manifest == Manifest::Parquet,
            preview: self.preview.into(),
            run_options: RunOptions { max_failures: self.failures.max(), ..common.run_options() },
        };
        // Refusals come before the folder is created.
        let plan = job.plan().map_err(Failure::usage)?;
        if self.dry_run {
            return output::print(&summary::planned(&job, &plan, bad, common.verbose));
        }
        make_folder(&self.output)?;
        let progress = Progress::new(common.quiet);
        let tally = Mutex::new(summary::Tally::default());
        let ended = job.run(&plan, &|event| {
            progress.show(&event, str::to_owned);
            if let Event::Done { item, result } = &event {
                if self.json {
                    // A reader that has gone away does not stop the work.
                    let _ = output::print_json(&result.lines);
                }
                if let Ok(mut tally) = tally.lock() {
                    tally.add(item, result);
                }
            }
        });
        progress.finish();
        let ended = ended?;
        let tally = tally.into_inner().unwrap_or_default();
        if !common.quiet && !self.json {
            output::print(&summary::of(&job, &tally, &ended, bad, common.verbose))?;
        }
        self.outcome(&ended)
    }

    fn outcome(&self, ended: &Summary) -> Result<(), Failure> {
        match ended {
            Summary { failed: 0, .. } => Ok(()),
            Summary { failed, left: 0, done, skipped } => Err(Failure::work(anyhow!(
                "{failed} of {} images failed; see the messages above and the manifest in {}",
                failed + done + skipped,
                display(&self.output)
            ))),
            Summary { failed, left, .. } => Err(Failure::work(anyhow!(
                "failed: {failed}, not tried: {left}; fix the files, then repeat the command to continue"
            ))),
        }
    }

    /// Applies --on-bad-annotation; returns how many images were left out.
    fn without_bad(&self, dataset: &mut Dataset) -> Result<usize, Failure> {
        let faults = &dataset.faults;
        if self.on_bad_annotation == OnBad::Refuse && !faults.is_empty() {
            const NAMED: usize = 10;
            let named: Vec<String> =
                faults.first().iter().take(NAMED).map(|fault| format!("\n  {fault}")).collect();
            let more = match faults.count().saturating_sub(NAMED) {
                0 => String::new(),
                more => format!("\n  and {more} more"),
            };
            return Err(Failure::usage(anyhow!(
                "{} has bad annotations; fix them, or add --on-bad-annotation skip or keep:{}{more}",
                display(&self.dataset),
                named.concat()
            )));
        }
        let before = dataset.samples.len();
        if self.on_bad_annotation == OnBad::Skip {
            dataset.samples.retain(|sample| !dataset.faults.concern(&sample.key));
        }
        if dataset.samples.is_empty() {
            return Err(Failure::usage(anyhow!(
                "every image of {} has bad annotations; fix them, or add --on-bad-annotation keep",
                display(&self.dataset)
            )));
        }
        Ok(before - dataset.samples.len())
    }

    fn recipe(&self, encoding: PixelEncoding, common: &Common) -> Result<Recipe, Failure> {
        let Settings { depth_model, options, smoothing, .. } = self.settings.get()?;
        self.presets.refuse_unread(options.model)?;
        let kind = self.depth.kind_of_map(&depth_model);
        let read =
            |source: &WaterSource| waters::read(source, &self.presets, &depth_model, kind, encoding, common);
        let on_doubtful = match &self.on_doubtful {
            Doubtful::Flag => OnDoubtful::Flag,
            Doubtful::Skip => OnDoubtful::Skip,
            Doubtful::Instead(source) => OnDoubtful::Instead(Box::new(read(source)?)),
        };
        let sources = waters::sources(&self.waters)?;
        let waters = sources.iter().map(read).collect::<Result<Vec<_>, _>>()?;
        let waters = waters::without_doubtful(waters, &on_doubtful);
        let theta = options.incidence.degrees();
        let draws = Draws {
            seed: self.seed,
            with_replacement: self.with_replacement,
            theta: self.theta_range.map_or(Ok((theta, theta)), Range::of_theta).map_err(Failure::usage)?,
            alpha: self
                .alpha_range
                .map_or(Ok((options.gain.get(), options.gain.get())), Range::of_alpha)
                .map_err(Failure::usage)?,
        };
        Ok(Recipe {
            waters,
            sea: self.drawn.map(|Drawn::Sea| self.presets.sea(kind)).transpose()?,
            encoding,
            per_image: self.per_image,
            draws,
            options,
            smoothing,
            depth: self.depth.plan(&depth_model).map_err(Failure::usage)?,
            on_doubtful,
            on_bad_annotation: self.on_bad_annotation.name(),
            keep_originals: self.keep_originals,
            keep_share: if self.keep_originals { 0.0 } else { self.keep_share },
            splits: Splits::All,
            quality: self.quality,
        })
    }
}

impl DepthArguments {
    /// Where the depth of a dataset's images comes from. Errors are wrong usage.
    fn plan(&self, model: &aquafuse_data::pipeline::DepthEstimator) -> anyhow::Result<DepthPlan> {
        use aquafuse_data::pipeline::DepthSupply;
        Ok(match self.supply(true, model)? {
            DepthSupply::Estimated(model) => DepthPlan::Estimated(model),
            DepthSupply::File(folder, kind, size) => DepthPlan::Maps { folder, kind, size },
            DepthSupply::Folder(maps, kind, size) => {
                DepthPlan::Maps { folder: maps.path().to_owned(), kind, size }
            }
        })
    }
}
