//! `aquafuse fuse`: a picture, or a folder of them, in another picture's water.

mod plan;
mod settings;
mod summary;

use std::path::PathBuf;
use std::sync::Mutex;

use anyhow::anyhow;
use aquafuse_data::analysis::{DepthSource, analyse};
use aquafuse_data::job::{self, Message};
use aquafuse_data::picture::{Picture, WriteOptions};
use clap::Args;
use settings::SettingsArgs;

use crate::depth_arguments::DepthArguments;
use crate::failure::Failure;
use crate::inspect::veiling_light;
use crate::output;
use crate::progress::Progress;

/// Put a picture, or a folder of them, into another picture's water.
#[derive(Args)]
#[command(after_help = settings::HELP)]
pub(crate) struct Fuse {
    /// The objects: a picture (PNG or JPEG, 8 bits a channel), or a folder of pictures.
    /// Folders inside it are not entered.
    content: PathBuf,
    /// The reference: the picture whose water is taken. Best one with open water in view.
    water: PathBuf,
    /// Where to write: a file or a folder for a picture, a folder for a folder. Missing folders are made.
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    #[command(flatten)]
    depth: DepthArguments,
    #[command(flatten)]
    settings: SettingsArgs,
    /// JPEG quality, 1 to 100.
    #[arg(long, value_name = "Q", default_value_t = 95, value_parser = clap::value_parser!(u8).range(1..=100))]
    quality: u8,
    /// Replace pictures that exist.
    #[arg(long)]
    overwrite: bool,
}

impl Fuse {
    pub(crate) fn run(&self, quiet: bool) -> Result<(), Failure> {
        let settings = self.settings.get();
        let supply =
            self.depth.supply(self.content.is_dir(), settings.depth_model).map_err(Failure::usage)?;
        let items = plan::items(&self.content, &self.water, &self.output, &supply).map_err(Failure::usage)?;
        if !self.overwrite {
            plan::refuse_existing(&items).map_err(Failure::usage)?;
        }
        let reference =
            analyse(&Picture::read(&self.water)?, &DepthSource::Estimated(settings.depth_model))?.estimate;
        // All outputs of a run stand in one folder.
        if let Some(first) = items.first() {
            output::make_folder_of(&first.output)?;
        }
        let job = job::Fuse {
            items,
            reference,
            options: settings.options,
            smoothing: settings.smoothing,
            writing: WriteOptions { overwrite: self.overwrite, quality: self.quality },
        };
        let progress = Progress::new(quiet || job.items.len() == 1);
        let reports = Mutex::new(Vec::new());
        let summary = job.run(&|message| {
            progress.show(&message);
            if let (Message::Done { item, report }, Ok(mut reports)) = (&message, reports.lock()) {
                reports.push(((*item).clone(), *report));
            }
        });
        progress.finish();
        let mut reports = reports.into_inner().unwrap_or_default();
        reports.sort_by(|(a, _), (b, _)| a.output.cmp(&b.output));
        if !quiet {
            let water = format!("{}: {}\n", self.water.display(), veiling_light(&reference));
            output::print(&(water + &summary::of(&reports)))?;
        }
        match (summary.failed, job.items.len()) {
            (0, _) => Ok(()),
            (failed, all) => {
                Err(Failure::work(anyhow!("{failed} of {all} failed; the messages above say why")))
            }
        }
    }
}
