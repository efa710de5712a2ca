//! Options of every evaluation: the report, outputs of other tools, the network of LPIPS.

use std::path::PathBuf;

use anyhow::anyhow;
use aquafuse_data::evaluate::report;
use aquafuse_data::evaluate::{Lpips, Outputs};
use clap::Args;

use crate::failure::Failure;

/// Where the figures go.
#[derive(Args)]
pub(crate) struct ReportArguments {
    /// Report file: .md, .csv (one line per figure), .json (all figures and results) or .html (with plots); or a
    /// folder for report.md, report.csv, report.json, report.html and items.csv (one line per result). A missing
    /// folder is created [default: only print the tables].
    #[arg(short, long, value_name = "REPORT")]
    pub(crate) output: Option<PathBuf>,
    /// Replace an existing report.
    #[arg(long)]
    pub(crate) overwrite: bool,
    /// Print the report as JSON instead of the tables.
    #[arg(long)]
    pub(crate) json: bool,
}

/// The network that LPIPS uses.
#[derive(Args)]
pub(crate) struct LpipsArguments {
    /// Also score LPIPS with this network: an ONNX file written by `lpips/export.py` in crates/aquafuse-data.
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

    /// Without the feature there is no network.
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

/// `NAME=DIR`: the outputs of another tool.
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
        _ => Err(anyhow!("give a name and a folder, as NAME=DIR")),
    }
}

/// The outputs of tools. Their names must differ from each other and from the names in `taken`.
pub(crate) fn outputs(named: &[Named], taken: &[&str]) -> Result<Vec<Outputs>, Failure> {
    let mut all: Vec<Outputs> = Vec::new();
    for Named { name, folder } in named {
        if taken.contains(&name.as_str()) || all.iter().any(|outputs| outputs.name() == name) {
            return Err(Failure::usage(anyhow!("two methods are named {name}; give --method another name")));
        }
        all.push(Outputs::list(name, folder)?);
    }
    Ok(all)
}
