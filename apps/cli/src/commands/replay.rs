//! `aquafuse replay`: variants made again from their manifest.

use std::path::PathBuf;

use anyhow::anyhow;
use aquafuse_data::augment::{Again, Replayed, replay};
use aquafuse_data::files::display;
use clap::Args;

use crate::args::common::{Common, encoding};
use crate::failure::Failure;
use crate::report::output;

/// Make variants again from their manifest, and compare them with it.
#[derive(Args)]
#[command(after_help = "\
To continue a run that was stopped, repeat the command: variants that are there as the manifest says are kept.

Example:
  aquafuse replay more/manifest.jsonl --only images/reef__green__0.jpg -o again/")]
pub(crate) struct Replay {
    /// The manifest of `augment`, or its folder.
    manifest: PathBuf,
    /// Only the variant with this path in the manifest, or the variants of this image [default: all].
    #[arg(long, value_name = "KEY")]
    only: Option<String>,
    /// Output folder.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Folder of the dataset [default: as in the manifest].
    #[arg(long, value_name = "DIR")]
    dataset: Option<PathBuf>,
    /// Make variants again that exist, and replace them.
    #[arg(long)]
    overwrite: bool,
    /// Refuse the network of depth that the manifest names, FILE.onnx, if reading it, or one image, takes more than N seconds [default: 600].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    depth_model_seconds: Option<u32>,
    /// Set this if the manifest is from a run with --linear.
    #[arg(long)]
    linear: bool,
}

impl Replay {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        let reading = common.reading.options();
        let (only, dataset) = (self.only.as_deref(), self.dataset.as_deref());
        let manifest = match self.manifest.is_dir() {
            true => self.manifest.join("manifest.jsonl"),
            false => self.manifest.clone(),
        };
        let again = Again {
            only,
            dataset,
            output: &self.output,
            overwrite: self.overwrite,
            reading,
            encoding: encoding(self.linear),
            network_seconds: self.depth_model_seconds,
        };
        let (mut equal, mut kept, mut different, mut failed) = (0, 0, 0, 0);
        replay(&manifest, &again, |made| match made {
            Replayed::Equal(_) => equal += 1,
            Replayed::Kept(_) => kept += 1,
            Replayed::Different(path) => {
                different += 1;
                output::complain(&format!(
                    "{}: it differs from the manifest; the image or the version of aquafuse changed",
                    display(&path)
                ));
            }
            Replayed::Failed(error) => {
                failed += 1;
                output::complain(&error);
            }
        })?;
        if !common.quiet {
            let kept = match kept {
                0 => String::new(),
                kept => format!("; {kept} were made by an earlier run"),
            };
            output::print(&format!("{equal} variants made again, equal to the manifest{kept}\n"))?;
        }
        match (different, failed) {
            (0, 0) => Ok(()),
            (different, failed) => Err(Failure::work(anyhow!(
                "failed: {failed}, different from the manifest: {different}; see the messages above"
            ))),
        }
    }
}
