//! Images made from images, one or a folder of them: what `fuse`, `restore` and `enhance` have in common.

mod json;
mod plan;
mod summary;

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use anyhow::anyhow;
use aquafuse::depth::DepthModel;
use aquafuse::smooth::Smoothing;
use aquafuse_data::files::{FileError, display, remove_stale_parts, write_text};
use aquafuse_data::image_file::WriteOptions;
use aquafuse_data::job::{Conduct, Item, Job, Message, RECORD, Recipe, Record, Summary};
use aquafuse_data::treatment::{Space, Treatment};
use clap::Args;
use serde::Serialize;
use serde_json::Value;
use serde_json::value::RawValue;

use crate::common::Common;
use crate::depth_arguments::DepthArguments;
use crate::failure::Failure;
use crate::output;
use crate::progress::Progress;

/// What is read, and where and how the outputs are written.
#[derive(Args)]
pub(crate) struct WorkArguments {
    /// Where to write: a file or a folder for an image, a folder for a folder. Missing folders are made. The name says
    /// the format: .png and .tif keep 16 bits and transparency, .webp is lossless, .jpg is 4:4:4.
    #[arg(short, long, value_name = "OUT")]
    pub(crate) output: PathBuf,
    #[command(flatten)]
    pub(crate) depth: DepthArguments,
    /// JPEG quality, 1 to 100.
    #[arg(long, value_name = "Q", default_value_t = 95, value_parser = clap::value_parser!(u8).range(1..=100))]
    pub(crate) quality: u8,
    /// Turn outputs as their EXIF orientation asks for. By default pixels stay as stored, so that labels do too, and
    /// the orientation is carried over.
    #[arg(long)]
    pub(crate) upright: bool,
    /// Replace images that exist.
    #[arg(long)]
    pub(crate) overwrite: bool,
    /// Stop at the first image that fails, as `--max-errors 0`.
    #[arg(long, conflicts_with = "max_errors")]
    fail_fast: bool,
    /// Stop once more images than this have failed [default: go on].
    #[arg(long, value_name = "N")]
    max_errors: Option<usize>,
    /// Print one JSON object an image, for programs, instead of the summary.
    #[arg(long)]
    pub(crate) json: bool,
    /// Write what each image is made from into this folder, as images: STEM.depth.png (16 bits: 65535 is the
    /// farthest, or one millimetre a step), .backscatter, .illumination and .change (mid grey: nothing).
    #[arg(long, value_name = "DIR")]
    maps: Option<PathBuf>,
    /// Write settings, waters and a record of each image into this file, as JSON.
    #[arg(long, value_name = "FILE.json")]
    report: Option<PathBuf>,
    /// Work in linear light instead of the values that cameras write, which the paper works on. Depth from colour is
    /// told from those in any case.
    #[arg(long)]
    pub(crate) linear: bool,
}

/// One command's work.
pub(crate) struct Work<'a, E: Space> {
    pub(crate) content: &'a Path,
    /// Further inputs, which are not to be written over.
    pub(crate) beside: &'a [&'a Path],
    pub(crate) depth_model: DepthModel,
    pub(crate) treatment: Treatment<E>,
    pub(crate) smoothing: Smoothing,
    /// Score each image before and after.
    pub(crate) scores: bool,
    /// The first line of the summary.
    pub(crate) heading: String,
    /// What the report says of the settings.
    pub(crate) settings: Value,
}

/// `--report`; `schema` changes when a field changes its meaning or goes.
#[derive(Serialize)]
struct Report {
    schema: u32,
    version: &'static str,
    settings: Value,
    images: Vec<Box<RawValue>>,
}

impl WorkArguments {
    /// Refuses what can be refused before any image is read, and gives the images.
    pub(crate) fn plan(
        &self,
        content: &Path,
        beside: &[&Path],
        model: DepthModel,
    ) -> Result<Vec<Item>, Failure> {
        let is_job = content.is_dir();
        let supply = self.depth.supply(is_job, model).map_err(Failure::usage)?;
        let items = plan::items(content, beside, &self.output, &supply).map_err(Failure::usage)?;
        if !self.overwrite {
            plan::refuse_unrecorded(&items, is_job).map_err(Failure::usage)?;
        }
        if let Some(report) = &self.report {
            let exists = || FileError::Exists { path: report.clone() };
            let is_there = report.symlink_metadata().is_ok();
            (self.overwrite || !is_there).then_some(()).ok_or_else(exists)?;
        }
        Ok(items)
    }

    /// Does the work.
    pub(crate) fn run<E: Space>(&self, work: Work<'_, E>, common: &Common) -> Result<(), Failure> {
        let items = self.plan(work.content, work.beside, work.depth_model)?;
        let recipe = Recipe {
            treatment: work.treatment,
            smoothing: work.smoothing,
            upright: self.upright,
            reading: common.reading.options(),
            writing: WriteOptions { overwrite: self.overwrite, quality: self.quality },
        };
        let record = self.prepare(&items, &recipe, work.content.is_dir())?;
        let conduct = Conduct {
            threads: common.threads.and_then(|threads| NonZeroUsize::new(threads.into())),
            most_failures: if self.fail_fast { Some(0) } else { self.max_errors },
            scores: work.scores,
            maps: self.maps.clone(),
        };
        let job = Job { items, recipe, conduct, record };

        let progress = Progress::new(common.quiet || job.items.len() == 1);
        let (reports, records) = (Mutex::new(Vec::new()), Mutex::new(Vec::new()));
        let ended = job.run(&|message| {
            if (self.json || self.report.is_some())
                && let Some(record) = json::record(&message)
            {
                if self.json {
                    // A reader that has gone away does not stop the work.
                    let _ = output::print(&format!("{record}\n"));
                }
                if let Ok(mut records) = records.lock() {
                    records.push(record);
                }
            }
            progress.show(&message);
            if let (Message::Done { item, report }, Ok(mut reports)) = (message, reports.lock()) {
                reports.push((item.clone(), *report));
            }
        });
        progress.finish();
        let mut reports = reports.into_inner().unwrap_or_default();
        reports.sort_by(|(a, _), (b, _)| a.output.cmp(&b.output));
        if !common.quiet && !self.json {
            output::print(&(work.heading + &summary::of(&reports, ended.kept)))?;
        }
        self.write_report(work.settings, records.into_inner().unwrap_or_default())?;
        self.outcome(&ended, job.items.len())
    }

    /// Makes the folders of the outputs ready; the record, where it is a folder's job.
    fn prepare<E: Space>(
        &self,
        items: &[Item],
        recipe: &Recipe<E>,
        is_job: bool,
    ) -> Result<Option<Record>, Failure> {
        // All outputs of a run stand in one folder.
        let Some(first) = items.first() else { return Ok(None) };
        let folder = output::make_folder_of(&first.output)?;
        remove_stale_parts(folder);
        let record = match is_job {
            true => {
                let record = Record::open(folder, &recipe.fingerprint(), self.overwrite)?;
                plan::refuse_foreign(items, &record, self.overwrite).map_err(Failure::usage)?;
                Some(record)
            }
            false => None,
        };
        if let Some(maps) = &self.maps {
            output::make_folder(maps)?;
            plan::refuse_maps(items, maps, record.as_ref(), self.overwrite).map_err(Failure::usage)?;
        }
        Ok(record)
    }

    fn write_report(&self, settings: Value, mut images: Vec<Box<RawValue>>) -> Result<(), Failure> {
        let Some(path) = &self.report else { return Ok(()) };
        // Images get done in any order; their names stand first in their records.
        images.sort_by(|a, b| a.get().cmp(b.get()));
        let report = Report { schema: 1, version: env!("CARGO_PKG_VERSION"), settings, images };
        let text = serde_json::to_string_pretty(&report).map_err(Failure::work)?;
        output::make_folder_of(path)?;
        Ok(write_text(path, &(text + "\n"), self.overwrite)?)
    }

    fn outcome(&self, ended: &Summary, all: usize) -> Result<(), Failure> {
        match ended {
            Summary { failed: 0, .. } => Ok(()),
            // Its own line has said why.
            _ if all == 1 => Err(Failure::Told),
            Summary { failed, left, .. } => {
                let left = if *left > 0 { format!(", {left} were not tried") } else { String::new() };
                Err(Failure::work(anyhow!(
                    "{failed} of {all} failed{left}; the messages above say why, and {} lists them",
                    display(&self.output.join(RECORD))
                )))
            }
        }
    }
}
