//! A running batch: progress, a line for each image, the summary, the report.

use std::path::{Path, PathBuf};
use std::sync::Mutex;

use anyhow::anyhow;
use aquafuse_data::batch::{Plan, RECORD, Recipe};
use aquafuse_data::files::{display, make_folder_of, write_text};
use aquafuse_data::run::{Event, RunOptions, Summary};
use serde::Serialize;
use serde_json::Value;
use serde_json::value::RawValue;

use super::network::{self, Slow};
use super::progress::Progress;
use super::{json, output, summary};
use crate::args::batch::BatchArguments;
use crate::args::common::Common;
use crate::failure::Failure;

/// The words of a command about its batch.
pub(crate) struct Words {
    /// The first line of the summary.
    pub(crate) heading: String,
    /// The settings in the report.
    pub(crate) settings: Value,
}

/// `--report`; `schema` changes when a field changes its meaning or goes.
#[derive(Serialize)]
struct Report {
    schema: u32,
    version: &'static str,
    settings: Value,
    #[serde(rename = "pictures")]
    images: Vec<Box<RawValue>>,
}

/// Runs a plan, shows its progress, and prints its outcome.
pub(crate) fn run(
    plan: &Plan,
    recipe: &Recipe,
    words: Words,
    arguments: &BatchArguments,
    common: &Common,
) -> Result<(), Failure> {
    let options = RunOptions { max_failures: arguments.failures.max(), ..common.run_options() };
    if !plan.unread().is_empty() {
        output::complain(&unread(plan.unread()));
    }
    if plan.folders_left_out() > 0 && !common.quiet {
        output::complain(&format_args!(
            "left out: {} folders in the content; --recursive enters them",
            plan.folders_left_out()
        ));
    }
    let progress = Progress::new(common.quiet || plan.items().len() == 1);
    let slow = Slow::new();
    let (reports, records) = (Mutex::new(Vec::new()), Mutex::new(Vec::new()));
    let ended = plan.run(recipe, &options, &|event| {
        if (arguments.json || arguments.report.is_some())
            && let Some(record) = json::record(&event)
        {
            if arguments.json {
                // A reader that has gone away does not stop the work.
                let _ = output::print_json(&format!("{record}\n"));
            }
            if let Ok(mut records) = records.lock() {
                records.push(record);
            }
        }
        progress.show(&event, |item| display(&item.output).to_string());
        if let Some(said) = slow.said(plan.network()).filter(|_| !common.quiet) {
            progress.complain(&said);
        }
        if let (Event::Done { item, result }, Ok(mut reports)) = (event, reports.lock()) {
            reports.push((item.clone(), *result));
        }
    });
    progress.finish();
    let ended = ended?;
    if let Some(said) = network::kept(plan.network()).filter(|_| !common.quiet) {
        output::complain(&said);
    }
    let mut reports = reports.into_inner().unwrap_or_default();
    reports.sort_by(|(a, _), (b, _)| a.output.cmp(&b.output));
    if !common.quiet && !arguments.json {
        output::print(&(words.heading + &summary::of(&reports, ended.skipped, common.verbose)))?;
    }
    if let Some(path) = &arguments.report {
        let images = records.into_inner().unwrap_or_default();
        write_report(path, words.settings, images, arguments.overwrite)?;
    }
    outcome(&ended, plan.items().len(), &arguments.output)
}

/// Which pictures of a folder are left out.
fn unread(pictures: &[PathBuf]) -> String {
    const NAMED: usize = 3;
    let names =
        pictures.iter().take(NAMED).map(|path| display(path).to_string()).collect::<Vec<_>>().join(", ");
    let more = if pictures.len() > NAMED { ", …" } else { "" };
    format!(
        "left out, because their formats are not read: {} ({names}{more}); convert them, and develop raw files",
        pictures.len()
    )
}

fn write_report(
    path: &Path,
    settings: Value,
    mut images: Vec<Box<RawValue>>,
    overwrite: bool,
) -> Result<(), Failure> {
    // Images end in any order; a record begins with the name of its image.
    images.sort_by(|a, b| a.get().cmp(b.get()));
    let report = Report { schema: 1, version: env!("CARGO_PKG_VERSION"), settings, images };
    let text = serde_json::to_string_pretty(&report).map_err(Failure::work)?;
    make_folder_of(path)?;
    Ok(write_text(path, &(text + "\n"), overwrite)?)
}

fn outcome(ended: &Summary, all: usize, output: &Path) -> Result<(), Failure> {
    match ended {
        Summary { failed: 0, .. } => Ok(()),
        // Its message was printed already.
        _ if all == 1 => Err(Failure::Reported),
        Summary { failed, left, .. } => {
            let left = if *left > 0 { format!(", {left} were not tried") } else { String::new() };
            Err(Failure::work(anyhow!(
                "{failed} of {all} images failed{left}; see the messages above and {}",
                display(&output.join(RECORD))
            )))
        }
    }
}
