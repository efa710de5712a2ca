//! What every evaluation takes: where the figures go, other tools' outputs, the network of LPIPS.

use std::path::PathBuf;

use anyhow::anyhow;
use aquafuse_data::evaluate::report;
use aquafuse_data::evaluate::{Lpips, Outputs};
use clap::Args;

use crate::failure::Failure;

/// Where the figures go.
#[derive(Args)]
pub(crate) struct ReportArguments {
    /// Where to write: .md, .csv (a line a figure), .json (all figures and results) or .html (one page with plots), or
    /// a folder, which gets report.md, .csv, .json and .html, and items.csv with a line a result. A missing folder is
    /// made. Without it the tables are printed alone.
    #[arg(short, long, value_name = "REPORT")]
    pub(crate) output: Option<PathBuf>,
    /// Replace a report that exists.
    #[arg(long)]
    pub(crate) overwrite: bool,
    /// Print the report as JSON, for programs, instead of the tables.
    #[arg(long)]
    pub(crate) json: bool,
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

impl ReportArguments {
    /// Refuses what can be refused before any image is read.
    pub(crate) fn check(&self) -> Result<(), Failure> {
        let Some(path) = &self.output else { return Ok(()) };
        Ok(report::check_name(path, self.overwrite)?)
    }
}

/// `NAME=DIR`: what another tool has made.
#[derive(Clone, Debug)]
pub(crate) struct Named {
    name: String,
    folder: PathBuf,
}

pub(crate) fn named(text: &str) -> anyhow::Result<Named> {
    match text.split_once('=') {
        Some((name, folder)) if !name.is_empty() && !folder.is_empty() => {
            Ok(Named { name: name.to_owned(), folder: folder.into() })
        }
        _ => Err(anyhow!("give a name and a folder: NAME=DIR")),
    }
}

/// The outputs of tools, each called unlike the others and unlike the methods that are there already.
pub(crate) fn outputs(named: &[Named], taken: &[&str]) -> Result<Vec<Outputs>, Failure> {
    let mut all: Vec<Outputs> = Vec::new();
    for Named { name, folder } in named {
        if taken.contains(&name.as_str()) || all.iter().any(|outputs| outputs.name() == name) {
            return Err(Failure::usage(anyhow!("two methods are called {name}; give --method another name")));
        }
        all.push(Outputs::list(name, folder)?);
    }
    Ok(all)
}
