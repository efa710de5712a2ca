//! `aquafuse verify`: whether what was made is still as it was made.

use std::path::PathBuf;

use anyhow::anyhow;
use aquafuse_data::augment::verify;
use aquafuse_data::files::display;
use clap::Args;
use serde::Serialize;

use crate::args::common::Common;
use crate::failure::Failure;
use crate::report::output;

/// Check what `augment` made against its manifest, bit for bit.
#[derive(Args)]
#[command(after_help = "Example:\n  aquafuse verify more/\n  aquafuse verify more/ --dataset fish/")]
pub(crate) struct Verify {
    /// The folder that `augment` wrote, or the manifest in it.
    folder: PathBuf,
    /// Check the images that it was made from too, in this dataset.
    #[arg(long, value_name = "DIR")]
    dataset: Option<PathBuf>,
    /// Print one JSON object, for programs.
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
        let check = verify(folder, self.dataset.as_deref())?;
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
            output::print(&(text + "\n"))?;
        } else {
            for (path, cause) in &check.wrong {
                output::complain(&format!("{}: {cause}", display(path)));
            }
            if !common.quiet {
                let right = check.files.saturating_sub(check.wrong.len());
                output::print(&format!("{right} of {} files are as they were made\n", check.files))?;
                if let Some(first) = check.unlisted.first() {
                    let (count, first) = (check.unlisted.len(), display(first));
                    output::print(&format!("  in no manifest: {count}, the first of them {first}\n"))?;
                }
            }
        }
        match check.wrong.len() {
            0 => Ok(()),
            // Named above, one by one.
            _ if !self.json => Err(Failure::Told),
            wrong => Err(Failure::work(anyhow!("{wrong} files are not as they were made"))),
        }
    }
}
