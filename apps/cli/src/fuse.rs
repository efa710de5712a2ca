//! `aquafuse fuse`: a picture, or a folder of them, in another picture's water.

mod json;
mod plan;
mod settings;
mod summary;

use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::Mutex;

use anyhow::anyhow;
use aquafuse_data::analysis::{DepthSource, analyse};
use aquafuse_data::job::{self, Conduct, Message, RECORD, Recipe, Record};
use aquafuse_data::picture::{WriteOptions, remove_stale_parts, shown};
use clap::Args;
use settings::SettingsArgs;

use crate::depth_arguments::DepthArguments;
use crate::failure::Failure;
use crate::inspect::veiling_light;
use crate::output;
use crate::progress::Progress;
use crate::reading::Reading;

/// Put a picture, or a folder of them, into another picture's water.
///
/// A folder's run that was stopped goes on where it was: the same command makes what is missing.
#[derive(Args)]
#[command(after_help = settings::HELP)]
pub(crate) struct Fuse {
    /// The objects: a picture (PNG, JPEG, TIFF, WebP, BMP, GIF), or a folder of pictures (not GIF).
    /// Folders inside it are not entered.
    content: PathBuf,
    /// The reference: the picture whose water is taken. Best one with open water in view.
    water: PathBuf,
    /// Where to write: a file or a folder for a picture, a folder for a folder. Missing folders are made. The name says
    /// the format: .png and .tif keep 16 bits and transparency, .webp is lossless, .jpg is 4:4:4.
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    #[command(flatten)]
    depth: DepthArguments,
    #[command(flatten)]
    settings: SettingsArgs,
    /// JPEG quality, 1 to 100.
    #[arg(long, value_name = "Q", default_value_t = 95, value_parser = clap::value_parser!(u8).range(1..=100))]
    quality: u8,
    /// Turn outputs as their EXIF orientation asks for. By default pixels stay as stored, so that labels do too, and
    /// the orientation is carried over.
    #[arg(long)]
    upright: bool,
    /// Replace pictures that exist.
    #[arg(long)]
    overwrite: bool,
    /// Stop at the first picture that fails, as `--max-errors 0`.
    #[arg(long, conflicts_with = "max_errors")]
    fail_fast: bool,
    /// Stop once more pictures than this have failed [default: go on].
    #[arg(long, value_name = "N")]
    max_errors: Option<usize>,
    /// Print one JSON object a picture, for programs, instead of the summary.
    #[arg(long)]
    json: bool,
}

impl Fuse {
    pub(crate) fn run(&self, threads: Option<u16>, reading: &Reading, quiet: bool) -> Result<(), Failure> {
        let settings = self.settings.get();
        let supply =
            self.depth.supply(self.content.is_dir(), settings.depth_model).map_err(Failure::usage)?;
        let items = plan::items(&self.content, &self.water, &self.output, &supply).map_err(Failure::usage)?;
        let is_job = self.content.is_dir();
        if !self.overwrite {
            plan::refuse_unrecorded(&items, is_job).map_err(Failure::usage)?;
        }
        let reference =
            analyse(&reading.read(&self.water)?, &DepthSource::Estimated(settings.depth_model))?.estimate;
        let recipe = Recipe {
            reference,
            options: settings.options,
            smoothing: settings.smoothing,
            upright: self.upright,
            reading: reading.options(),
            writing: WriteOptions { overwrite: self.overwrite, quality: self.quality },
        };
        let record = self.prepare(&items, &recipe, is_job)?;
        let most_failures = if self.fail_fast { Some(0) } else { self.max_errors };
        let threads = threads.and_then(|threads| NonZeroUsize::new(threads.into()));
        let job = job::Fuse { items, recipe, conduct: Conduct { threads, most_failures }, record };

        let progress = Progress::new(quiet || job.items.len() == 1);
        let reports = Mutex::new(Vec::new());
        let ended = job.run(&|message| {
            if self.json
                && let Some(line) = json::line(&message)
            {
                // A reader that has gone away does not stop the work.
                let _ = output::print(&line);
            }
            progress.show(&message);
            if let (Message::Done { item, report }, Ok(mut reports)) = (message, reports.lock()) {
                reports.push((item.clone(), report));
            }
        });
        progress.finish();
        let mut reports = reports.into_inner().unwrap_or_default();
        reports.sort_by(|(a, _), (b, _)| a.output.cmp(&b.output));
        if !quiet && !self.json {
            let water = format!("{}: {}\n", shown(&self.water), veiling_light(&reference));
            output::print(&(water + &summary::of(&reports, ended.kept)))?;
        }
        self.outcome(&ended, job.items.len())
    }

    /// Makes the folder of the outputs ready; its record, where it is a folder's job.
    fn prepare(&self, items: &[job::Item], recipe: &Recipe, is_job: bool) -> Result<Option<Record>, Failure> {
        // All outputs of a run stand in one folder.
        let Some(first) = items.first() else { return Ok(None) };
        let folder = output::make_folder_of(&first.output)?;
        remove_stale_parts(folder);
        if !is_job {
            return Ok(None);
        }
        let record = Record::open(folder, &recipe.fingerprint(), self.overwrite)?;
        plan::refuse_foreign(items, &record, self.overwrite).map_err(Failure::usage)?;
        Ok(Some(record))
    }

    fn outcome(&self, ended: &job::Summary, all: usize) -> Result<(), Failure> {
        match ended {
            job::Summary { failed: 0, .. } => Ok(()),
            // Its own line has said why.
            _ if all == 1 => Err(Failure::Told),
            job::Summary { failed, left, .. } => {
                let left = if *left > 0 { format!(", {left} were not tried") } else { String::new() };
                Err(Failure::work(anyhow!(
                    "{failed} of {all} failed{left}; the messages above say why, and {} lists them",
                    shown(&self.output.join(RECORD))
                )))
            }
        }
    }
}
