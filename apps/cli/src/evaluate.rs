//! `aquafuse evaluate`: what methods are worth, in figures.

mod depth;
mod enhancement;
mod fusion;
pub(crate) mod published;
mod truth;

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use anyhow::anyhow;
use aquafuse_data::evaluate::report::{self, markdown_of_table};
use aquafuse_data::evaluate::{Conduct, EvaluateError, Listener, Lpips, Message, Outputs, Report};
use aquafuse_data::files::display;
use clap::{Args, Subcommand};

use crate::common::Common;
use crate::failure::Failure;
use crate::output;
use crate::progress::Progress;

const EXAMPLES: &str = "\
Examples:
  aquafuse evaluate fusion --contents dives/ --references waters/ --rivals -o report.html
                                                     how much fused images look like their contents
  aquafuse evaluate truth -o truth.html              how much of the true change each method makes
  aquafuse evaluate enhancement dives/ -o clearer.md before and after
  aquafuse evaluate depth pairs/ --depth-kind metres -o depth.csv
                                                     depth from colour against measured depth";

/// Measure what methods are worth: on your images, or on scenes of known truth.
///
/// Means come with their variance and a 95 % interval by resampling whole images. No figure depends on the number of
/// threads. An image that fails is named and listed in the report; the others go on, and the exit code is 1.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Evaluate {
    #[command(subcommand)]
    what: What,
}

#[derive(Subcommand)]
enum What {
    Fusion(fusion::FusionArguments),
    Truth(truth::TruthArguments),
    Enhancement(enhancement::EnhancementArguments),
    Depth(depth::DepthEvaluationArguments),
}

impl Evaluate {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        match &self.what {
            What::Fusion(fusion) => fusion.run(common),
            What::Truth(truth) => truth.run(common),
            What::Enhancement(enhancement) => enhancement.run(common),
            What::Depth(depth) => depth.run(common),
        }
    }
}

/// Where the figures go.
#[derive(Args)]
pub(crate) struct ReportArguments {
    /// Where to write: .md, .csv (a line a figure), .json (all figures and results) or .html (one page with plots), or
    /// a folder, which gets report.md, .csv, .json and .html, and items.csv with a line a result. A missing folder is
    /// made. Without it the tables are printed alone.
    #[arg(short, long, value_name = "REPORT")]
    output: Option<PathBuf>,
    /// Replace a report that exists.
    #[arg(long)]
    overwrite: bool,
    /// Print the report as JSON, for programs, instead of the tables.
    #[arg(long)]
    json: bool,
}

/// The network to score LPIPS by.
#[derive(Args)]
pub(crate) struct LpipsArguments {
    /// Also score LPIPS, by the network in this file: ONNX, as `lpips/export.py` of crates/aquafuse-data writes it.
    #[cfg(feature = "lpips")]
    #[arg(long, value_name = "FILE")]
    lpips_weights: Option<PathBuf>,
}

impl LpipsArguments {
    /// The network, if one is named.
    #[cfg(feature = "lpips")]
    pub(crate) fn network(&self) -> Result<Option<Lpips>, Failure> {
        Ok(self.lpips_weights.as_deref().map(Lpips::read).transpose()?)
    }

    /// Without the feature there is no network to ask.
    #[cfg(not(feature = "lpips"))]
    pub(crate) fn network(&self) -> Result<Option<Lpips>, Failure> {
        Ok(None)
    }
}

/// Complaints shown while it runs; the report lists all.
const COMPLAINTS: usize = 12;

impl ReportArguments {
    /// Refuses what can be refused before any image is read.
    pub(crate) fn check(&self) -> Result<(), Failure> {
        let Some(path) = &self.output else { return Ok(()) };
        Ok(report::check_name(path, self.overwrite)?)
    }

    /// Runs an evaluation, showing how far it is, and hands its figures out. `more` may add to them.
    pub(crate) fn run(
        &self,
        common: &Common,
        evaluation: impl FnOnce(Listener<'_>) -> Result<Report, EvaluateError>,
        more: impl FnOnce(&mut Report),
    ) -> Result<(), Failure> {
        let progress = Progress::new(common.quiet);
        let complaints = AtomicUsize::new(0);
        let found = evaluation(&|message| match message {
            Message::Started { total } => progress.start(total),
            Message::Done { name } => progress.done(name.to_owned()),
            Message::Failed(failed) => match complaints.fetch_add(1, Ordering::Relaxed) {
                earlier if earlier < COMPLAINTS => progress.complain(&failed.error),
                COMPLAINTS => progress.complain(&"there are more failures; the report lists them all"),
                _ => {}
            },
            _ => {}
        });
        progress.finish();
        let mut report = found?;
        more(&mut report);
        if let Some(path) = &self.output {
            match path.extension() {
                Some(_) if !path.is_dir() => output::make_folder_of(path).map(|_| ())?,
                _ => output::make_folder(path)?,
            }
            report::write(&report, path, self.overwrite)?;
        }
        if self.json {
            output::print(&report::json(&report))?;
        } else if !common.quiet {
            output::print(&text(&report, self.output.as_deref()))?;
        }
        match report.failed.len() {
            0 => Ok(()),
            count => Err(Failure::work(anyhow!(
                "{count} failed and are left out of the figures; the report lists them"
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

fn conduct(common: &Common) -> Conduct {
    let threads = common.threads.and_then(|threads| NonZeroUsize::new(threads.into()));
    Conduct { threads, reading: common.reading.options() }
}

/// `NAME=DIR`: what another tool has made.
#[derive(Clone, Debug)]
struct Named {
    name: String,
    folder: PathBuf,
}

fn named(text: &str) -> anyhow::Result<Named> {
    match text.split_once('=') {
        Some((name, folder)) if !name.is_empty() && !folder.is_empty() => {
            Ok(Named { name: name.to_owned(), folder: folder.into() })
        }
        _ => Err(anyhow!("give a name and a folder: NAME=DIR")),
    }
}

/// The outputs of tools, each called unlike the others and unlike the methods that are there already.
fn outputs(named: &[Named], taken: &[&str]) -> Result<Vec<Outputs>, Failure> {
    let mut all: Vec<Outputs> = Vec::new();
    for Named { name, folder } in named {
        if taken.contains(&name.as_str()) || all.iter().any(|outputs| outputs.name() == name) {
            return Err(Failure::usage(anyhow!("two methods are called {name}; give --method another name")));
        }
        all.push(Outputs::list(name, folder)?);
    }
    Ok(all)
}

impl From<EvaluateError> for Failure {
    /// What is told before work begins, and is no image's fault, is wrong usage.
    fn from(error: EvaluateError) -> Self {
        match error {
            EvaluateError::File(error) => error.into(),
            error => Self::usage(error),
        }
    }
}
