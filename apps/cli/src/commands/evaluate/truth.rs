//! `aquafuse evaluate truth`: how much of the true change each method makes.

use aquafuse_data::evaluate::{Listener, Truth};
use clap::Args;

use crate::args::common::Common;
use crate::args::evaluation::ReportArguments;
use crate::failure::Failure;

const HELP: &str = "\
Share of the true change: 1 is the truth, 0 the content, below 0 farther from the truth than the content
was. Truth A is the content's place with nothing exchanged but the veiling light, truth B the same place
wholly in the other water. `z` is the depth, given or told from colour.

Examples:
  aquafuse evaluate truth -o truth.html
  aquafuse evaluate truth --exchanges 12             a first look, in seconds
  aquafuse evaluate truth --linear -o linear.md";

/// Measure how much of the true change each method makes, on synthetic scenes whose truth is known.
///
/// The three models with depth and water given or told, and colour transfer. Needs no images: scenes are numbered, and
/// the same everywhere.
#[derive(Args)]
#[command(after_help = HELP)]
pub(crate) struct TruthArguments {
    /// Exchanges: a content each, and a reference in another water.
    #[arg(long, value_name = "N", default_value_t = 120, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    exchanges: u32,
    /// Form, tell and fuse scenes in linear light.
    #[arg(long)]
    linear: bool,
    /// What resamplings are drawn by.
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
    #[command(flatten)]
    report: ReportArguments,
}

impl TruthArguments {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        self.report.check()?;
        let truth = Truth {
            exchanges: self.exchanges as usize,
            linear: self.linear,
            seed: self.seed,
            run_options: common.run_options(),
        };
        self.report.run(common, |listener: Listener<'_>| truth.run(listener), |_| {})
    }
}
