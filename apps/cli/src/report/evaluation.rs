//! A running evaluation: progress, tables, report.

use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

use anyhow::anyhow;
use aquafuse_data::evaluate::report::{self, markdown_of_table};
use aquafuse_data::evaluate::{EvaluateError, Listener, Report};
use aquafuse_data::files::{display, make_folder, make_folder_of};
use aquafuse_data::run::Event;

use super::output;
use super::progress::Progress;
use crate::args::common::Common;
use crate::args::evaluation::ReportArguments;
use crate::failure::Failure;

/// Failures printed while it runs; the report lists all.
const COMPLAINTS: usize = 12;

impl ReportArguments {
    /// Runs an evaluation, shows its progress, and writes its figures. `more` may add to them.
    pub(crate) fn run(
        &self,
        common: &Common,
        evaluation: impl FnOnce(Listener<'_>) -> Result<Report, EvaluateError>,
        more: impl FnOnce(&mut Report),
    ) -> Result<(), Failure> {
        let progress = Progress::new(common.quiet);
        let complaints = AtomicUsize::new(0);
        let found = evaluation(&|event| match event {
            Event::Started { total } => progress.start(total),
            Event::Done { item, .. } => progress.done(item),
            Event::Failed { error, .. } => match complaints.fetch_add(1, Ordering::Relaxed) {
                earlier if earlier < COMPLAINTS => progress.complain(&error),
                COMPLAINTS => progress.complain(&"more images failed; the report lists all of them"),
                _ => {}
            },
            _ => {}
        });
        progress.finish();
        let mut report = found?;
        more(&mut report);
        if let Some(path) = &self.output {
            match path.extension() {
                Some(_) if !path.is_dir() => make_folder_of(path).map(|_| ())?,
                _ => make_folder(path)?,
            }
            report::write(&report, path, self.overwrite)?;
        }
        if self.json {
            output::print(&report::json(&report))?;
        } else if !common.quiet || self.output.is_none() {
            // The tables are what was asked for, unless a file has them.
            output::print(&text(&report, self.output.as_deref()))?;
        }
        match report.failed.len() {
            0 => Ok(()),
            count => Err(Failure::work(anyhow!(
                "{count} failed and are missing from the figures; the report lists them"
            ))),
        }
    }
}

/// The tables, and where the report is.
fn text(report: &Report, path: Option<&Path>) -> String {
    let tables =
        report.tables.iter().map(|table| format!("{}\n\n{}\n", table.title, markdown_of_table(table)));
    let written = path.map(|path| format!("{}: written\n", display(path)));
    tables.chain(written).collect()
}
