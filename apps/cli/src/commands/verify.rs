//! `aquafuse verify`: whether the outputs of `augment` are unchanged.

use std::path::PathBuf;

use anyhow::anyhow;
use aquafuse_data::augment::verify;
use aquafuse_data::files::display;
use clap::Args;
use serde::Serialize;

use crate::args::common::Common;
use crate::failure::Failure;
use crate::report::output;

/// Check the outputs of `augment` against their manifest, bit for bit.
#[derive(Args)]
#[command(after_help = "Examples:\n  aquafuse verify more/\n  aquafuse verify more/ --dataset fish/")]
pub(crate) struct Verify {
    /// The output folder of `augment`, or the manifest in it.
    folder: PathBuf,
    /// Also check the source images in this dataset.
    #[arg(long, value_name = "DIR")]
    dataset: Option<PathBuf>,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// `schema` changes when a field changes its meaning or goes.
#[derive(Serialize)]
struct Report {
    schema: u32,
    files: usize,
    wrong: Vec<Wrong>,
    unlisted: Vec<String>,
}

#[derive(Serialize)]
struct Wrong {
    file: String,
    cause: String,
}

impl Verify {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        let folder = match self.folder.parent() {
            Some(parent) if self.folder.is_file() && parent.as_os_str().is_empty() => ".".as_ref(),
            Some(parent) if self.folder.is_file() => parent,
            _ => &self.folder,
        };
        let check = verify(folder, self.dataset.as_deref(), &common.reading.options())?;
        if self.json {
            let wrong = |(path, cause): &(PathBuf, String)| Wrong {
                file: display(path).to_string(),
                cause: cause.clone(),
            };
            let report = Report {
                schema: 1,
                files: check.files,
                wrong: check.wrong.iter().map(wrong).collect(),
                unlisted: check.unlisted.iter().map(|path| display(path).to_string()).collect(),
            };
            let text = serde_json::to_string_pretty(&report).map_err(Failure::work)?;
            output::print_json(&(text + "\n"))?;
        } else {
            for (path, cause) in &check.wrong {
                output::complain(&format!("{}: {cause}", display(path)));
            }
            if !common.quiet {
                let right = check.files.saturating_sub(check.wrong.len());
                output::print(&format!("{right} of {} files are unchanged\n", check.files))?;
                if let Some(first) = check.unlisted.first() {
                    let (count, first) = (check.unlisted.len(), display(first));
                    output::print(&format!(
                        "  files that no manifest lists: {count}, the first is {first}\n"
                    ))?;
                }
            }
        }
        match check.wrong.len() {
            0 => Ok(()),
            // Named above, one by one.
            _ if !self.json => Err(Failure::Reported),
            wrong => Err(Failure::work(anyhow!("{wrong} files are missing or changed"))),
        }
    }
}
