//! `aquafuse replay`: variants made again from their manifest.

use std::path::PathBuf;

use anyhow::anyhow;
use aquafuse::image::{Encoded, Linear};
use aquafuse_data::augment::{Replayed, replay};
use aquafuse_data::picture::shown;
use clap::Args;

use crate::augment::failure;
use crate::common::Common;
use crate::failure::Failure;
use crate::output;

/// Make variants again, as their manifest says, and compare them with it.
#[derive(Args)]
#[command(
    after_help = "Example:\n  aquafuse replay more/manifest.jsonl --only images/reef__green__0.jpg -o again/"
)]
pub(crate) struct Replay {
    /// The manifest that `augment` wrote.
    manifest: PathBuf,
    /// Of the variants only this one, by its path in the manifest, or those of this picture [default: all].
    #[arg(long, value_name = "KEY")]
    only: Option<String>,
    /// Where to write them.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Where the data set is now [default: where it was].
    #[arg(long, value_name = "DIR")]
    dataset: Option<PathBuf>,
    /// The manifest is of a run with --linear.
    #[arg(long)]
    linear: bool,
}

impl Replay {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        let reading = common.reading.options();
        let (only, dataset) = (self.only.as_deref(), self.dataset.as_deref());
        let made = match self.linear {
            true => replay::<Linear>(&self.manifest, only, dataset, &self.output, reading),
            false => replay::<Encoded>(&self.manifest, only, dataset, &self.output, reading),
        };
        let Replayed { equal, different, failed } = made.map_err(failure)?;
        for (_, error) in &failed {
            output::complain(error);
        }
        for path in &different {
            output::complain(&format!(
                "{}: its bytes are others than in the manifest; the picture or the version changed",
                shown(path)
            ));
        }
        if !common.quiet {
            output::print(&format!("{} variants made again, equal to the manifest\n", equal.len()))?;
        }
        match different.len() + failed.len() {
            0 => Ok(()),
            wrong => Err(Failure::work(anyhow!("{wrong} variants are not as in the manifest"))),
        }
    }
}
