//! `aquafuse evaluate`: what methods are worth, in figures.

mod depth;
mod enhancement;
mod fusion;
mod truth;

use clap::{Args, Subcommand};

use crate::args::common::Common;
use crate::failure::Failure;

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
