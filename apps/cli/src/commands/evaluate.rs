//! `aquafuse evaluate`: scores of methods.

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
                                                     similarity of fused images to their contents
  aquafuse evaluate truth -o truth.html              share of the true change each method achieves
  aquafuse evaluate enhancement dives/ -o clearer.md scores before and after
  aquafuse evaluate depth pairs/ --depth-kind metres -o depth.csv
                                                     depth from colour against measured depth";

/// Score methods on your images or on synthetic scenes.
///
/// Means have a variance and a 95 % bootstrap interval over images. Figures do not depend on the number of threads.
/// An image that fails is listed in the report; the run goes on, and the exit code is 1.
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
