//! `aquafuse augment`: a dataset multiplied, its annotations carried over.

mod range;
mod summary;
mod waters;

use std::path::PathBuf;
use std::sync::Mutex;

use anyhow::anyhow;
use aquafuse_data::augment::{Augmentation, DepthPlan, Draws, OnDoubtful, Recipe, Shard};
use aquafuse_data::dataset::{Dataset, Layout};
use aquafuse_data::files::{display, make_folder};
use aquafuse_data::pipeline::PixelEncoding;
use aquafuse_data::run::{Event, RunOptions, Summary};
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueEnum};
use range::Range;

use crate::args::common::{Common, encoding};
use crate::args::depth::DepthArguments;
use crate::args::failures::FailureArguments;
use crate::args::fusion::{Settings, SettingsArgs};
use crate::args::water::{WaterArguments, WaterSource};
use crate::failure::Failure;
use crate::report::output;
use crate::report::progress::Progress;

const HELP: &str = "\
Layouts, told by looking:
  folder   images in folders, and nothing about them
  coco     JSON with images and annotations: boxes, outlines, key points, captions
  yolo     labels/NAME.txt for images/NAME.jpg, with data.yaml or without
  voc      Annotations/NAME.xml for JPEGImages/NAME.jpg, masks and lists of names
  masks    masks/NAME.png for images/NAME.jpg
  shards   WebDataset: tar files; KEY.jpg and all else of that key
  parquet  Hugging Face: tables with a column of images (built with --features parquet)

Pixels stay where they are, so annotations stay true: labels and masks are copied byte for byte,
of JSON and XML all but ids and names of files. Variants are named STEM__WATER__NUMBER and stand
where their image stands, and so in its split. manifest.jsonl says of each what it was made
from; `verify` checks it, `replay` makes one again. A run that was stopped goes on: the same
command makes what is missing.

Examples:
  aquafuse augment fish/ green.jpg blue.jpg -o more/ --per-image 2 --keep-originals
  aquafuse augment fish/ waters/ preset:jerlov-3C -o more/ --per-image 5 --theta-range 0,60
                                                     a folder of reference images, and a preset
  aquafuse augment coco/ waters/ -o more/ --shard 1/4
                                                     on one of four machines; afterwards, the four outputs
                                                     put together, the same without --shard joins them";

/// Multiply a dataset: every image in other waters, annotations carried over.
#[derive(Args)]
#[command(after_help = HELP)]
pub(crate) struct Augment {
    /// The folder of the dataset.
    dataset: PathBuf,
    /// The waters to draw from: images, folders of images, NAME.water.json, preset:NAME.
    #[arg(required = true)]
    waters: Vec<PathBuf>,
    /// The folder to write to: new or empty, or that of a run to go on with.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// How the dataset is laid out, where that cannot be told.
    #[arg(long, value_name = "LAYOUT", value_parser = layout())]
    format: Option<Layout>,
    /// Variants of each image.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    per_image: u32,
    /// Carry the images themselves over too, byte for byte.
    #[arg(long)]
    keep_originals: bool,
    /// What is drawn depends on this, the image's path and the variant's number alone.
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
    /// Draw a water again before every other was drawn.
    #[arg(long)]
    with_replacement: bool,
    /// Draw theta evenly from this range of degrees.
    #[arg(long, value_name = "LOW,HIGH", conflicts_with = "theta")]
    theta_range: Option<Range>,
    /// Draw alpha evenly from this range.
    #[arg(long, value_name = "LOW,HIGH", conflicts_with = "alpha")]
    alpha_range: Option<Range>,
    /// What to do where an image's own water, or one to draw, cannot be told well: `flag` says so in the manifest, `skip`
    /// leaves it out, preset:NAME takes that water instead.
    #[arg(long, value_name = "HOW", default_value = "flag")]
    on_doubtful: Doubtful,
    /// What to do about images with bad annotations: a box outside the image, an id that is not unique, a name that
    /// leads out of the dataset. `skip` leaves the images out, `keep` carries the annotations over; what has no
    /// image is left out by both.
    #[arg(long, value_name = "HOW", value_enum, default_value_t)]
    on_bad_annotation: OnBad,
    /// Make part I of N only, for N machines that share the dataset.
    #[arg(long, value_name = "I/N", value_parser = shard)]
    shard: Option<Shard>,
    /// Say what would be made, and make nothing.
    #[arg(long)]
    dry_run: bool,
    #[command(flatten)]
    settings: SettingsArgs,
    #[command(flatten)]
    depth: DepthArguments,
    #[command(flatten)]
    presets: WaterArguments,
    /// JPEG quality, 1 to 100.
    #[arg(long, value_name = "Q", default_value_t = 95, value_parser = clap::value_parser!(u8).range(1..=100))]
    quality: u8,
    /// Work in linear light instead of the values that cameras write.
    #[arg(long)]
    linear: bool,
    /// Begin again where DIR holds what other settings made, which is removed.
    #[arg(long)]
    overwrite: bool,
    #[command(flatten)]
    failures: FailureArguments,
    /// How the manifest is written beside manifest.jsonl, which always is: `parquet` adds a table with a row a variant.
    #[arg(long, value_name = "AS", value_enum, default_value_t)]
    manifest: Manifest,
    /// Print the manifest's lines as they come, for programs, instead of the summary.
    #[arg(long)]
    json: bool,
}

/// How the manifest is written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum Manifest {
    /// Lines of JSON.
    #[default]
    Jsonl,
    /// A table too.
    Parquet,
}

/// What to do about bad annotations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum OnBad {
    /// Name them, and make nothing.
    #[default]
    Refuse,
    /// Leave their images out.
    Skip,
    /// Carry them over.
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
        .try_map(|name| Layout::from_name(&name).ok_or_else(|| anyhow!("there is no layout of that name")))
}

fn shard(text: &str) -> anyhow::Result<Shard> {
    let (number, of) = text.split_once('/').ok_or_else(|| anyhow!("give I/N, as 1/4"))?;
    let (number, of): (u32, u32) = (number.parse()?, of.parse()?);
    if number == 0 || number > of {
        return Err(anyhow!("parts are counted from 1 to N"));
    }
    Ok(Shard { number, of })
}

impl Augment {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        let encoding = encoding(self.linear);
        let mut dataset =
            Dataset::open(&self.dataset, self.format, &common.reading.options()).map_err(Failure::usage)?;
        let bad = self.without_bad(&mut dataset)?;
        let job = Augmentation {
            recipe: self.recipe(encoding, common)?,
            dataset,
            output: self.output.clone(),
            shard: self.shard.unwrap_or_default(),
            overwrite: self.overwrite,
            manifest_table: self.manifest == Manifest::Parquet,
            run_options: RunOptions { max_failures: self.failures.max(), ..common.run_options() },
        };
        // What can be refused is, before a folder is made.
        let plan = job.plan().map_err(Failure::usage)?;
        if self.dry_run {
            return output::print(&summary::planned(&job, &plan, bad));
        }
        make_folder(&self.output)?;
        let progress = Progress::new(common.quiet);
        let tally = Mutex::new(summary::Tally::default());
        let ended = job.run(&plan, &|event| {
            progress.show(&event, str::to_owned);
            if let Event::Done { result, .. } = &event {
                if self.json {
                    // A reader that has gone away does not stop the work.
                    let _ = output::print(&result.lines);
                }
                if let Ok(mut tally) = tally.lock() {
                    tally.add(result);
                }
            }
        });
        progress.finish();
        let ended = ended?;
        let tally = tally.into_inner().unwrap_or_default();
        if !common.quiet && !self.json {
            output::print(&summary::of(&job, &tally, &ended, bad))?;
        }
        self.outcome(&ended)
    }

    fn outcome(&self, ended: &Summary) -> Result<(), Failure> {
        match ended {
            Summary { failed: 0, .. } => Ok(()),
            Summary { failed, left: 0, done, skipped } => Err(Failure::work(anyhow!(
                "{failed} of {} images failed; the messages above say why, and the manifest in {} lists them",
                failed + done + skipped,
                display(&self.output)
            ))),
            Summary { failed, left, .. } => Err(Failure::work(anyhow!(
                "failed: {failed}, not tried: {left}; fix them, then rerun the same command to continue"
            ))),
        }
    }

    /// Does what is to be done about bad annotations, and says how many images were left out.
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
                "{} has annotations that are not right; mend them, or --on-bad-annotation skip or keep:{}{more}",
                display(&self.dataset),
                named.concat()
            )));
        }
        let before = dataset.samples.len();
        if self.on_bad_annotation == OnBad::Skip {
            dataset.samples.retain(|sample| !dataset.faults.concern(&sample.key));
        }
        if dataset.samples.is_empty() {
            return Err(Failure::usage(anyhow!("no image of {} is left", display(&self.dataset))));
        }
        Ok(before - dataset.samples.len())
    }

    fn recipe(&self, encoding: PixelEncoding, common: &Common) -> Result<Recipe, Failure> {
        let Settings { depth_model, options, smoothing, .. } = self.settings.get();
        let kind = self.depth.kind_of_map();
        let read =
            |source: &WaterSource| waters::read(source, &self.presets, depth_model, kind, encoding, common);
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
            encoding,
            per_image: self.per_image,
            draws,
            options,
            smoothing,
            depth: self.depth.plan(depth_model).map_err(Failure::usage)?,
            on_doubtful,
            on_bad_annotation: self.on_bad_annotation.name(),
            keep_originals: self.keep_originals,
            quality: self.quality,
        })
    }
}

impl DepthArguments {
    /// Where the depth of a dataset's images comes from. Errors are wrong usage.
    fn plan(&self, model: aquafuse::depth::DepthModel) -> anyhow::Result<DepthPlan> {
        use aquafuse_data::pipeline::DepthSupply;
        Ok(match self.supply(true, model)? {
            DepthSupply::Estimated(model) => DepthPlan::Estimated(model),
            DepthSupply::File(folder, kind) => DepthPlan::Maps { folder, kind },
            DepthSupply::Folder(maps, kind) => DepthPlan::Maps { folder: maps.path().to_owned(), kind },
        })
    }
}
