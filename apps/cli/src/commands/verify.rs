//! `aquafuse verify`: whether the outputs of `augment` are unchanged.

use std::path::PathBuf;

use anyhow::anyhow;
use aquafuse_data::augment::{Finding, verify};
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

#[derive(PartialEq, Eq, PartialOrd, Ord, Serialize)]
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
        let (mut wrong, mut unlisted) = (Vec::new(), Vec::new());
        let mut first_unlisted = None;
        let checked =
            verify(folder, self.dataset.as_deref(), &common.reading.options(), |found| match found {
                Finding::Wrong(path, cause) if self.json => {
                    wrong.push(Wrong { file: display(&path).to_string(), cause });
                }
                Finding::Wrong(path, cause) => output::complain(&format!("{}: {cause}", display(&path))),
                Finding::Unlisted(path) if self.json => unlisted.push(display(&path).to_string()),
                Finding::Unlisted(path) => _ = first_unlisted.get_or_insert(path),
            })?;
        if self.json {
            wrong.sort();
            let report = Report { schema: 1, files: checked.files, wrong, unlisted };
            let text = serde_json::to_string_pretty(&report).map_err(Failure::work)?;
            output::print_json(&(text + "\n"))?;
        } else if !common.quiet {
            let right = checked.files.saturating_sub(checked.wrong);
            output::print(&format!("{right} of {} files are unchanged\n", checked.files))?;
            if let Some(first) = &first_unlisted {
                let (count, first) = (checked.unlisted, display(first));
                output::print(&format!("  files that no manifest lists: {count}, the first is {first}\n"))?;
            }
        }
        match checked.wrong {
            0 => Ok(()),
            // Named above, one by one.
            _ if !self.json => Err(Failure::Reported),
            wrong => Err(Failure::work(anyhow!("{wrong} files are missing or changed"))),
        }
    }
}
