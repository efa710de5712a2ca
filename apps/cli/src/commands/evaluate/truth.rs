//! `aquafuse evaluate truth`: the share of the true change that each method achieves.

use aquafuse::truth::{LitWaters, Site};
use aquafuse_data::evaluate::{Listener, Truth};
use clap::{Args, ValueEnum};

use crate::args::common::Common;
use crate::args::evaluation::ReportArguments;
use crate::failure::Failure;

const HELP: &str = "\
Share of the true change: 1 is the truth, 0 the content, below 0 farther from the truth than the
content. Truth A is the scene with only the veiling light exchanged, truth B the scene with the
whole water exchanged, truth C (--lit) the scene in the other water and its light. `z` is the depth, true or estimated from colour.

Examples:
  aquafuse evaluate truth -o truth.html
  aquafuse evaluate truth --exchanges 12             a first look, in seconds
  aquafuse evaluate truth --linear -o linear.md
  aquafuse evaluate truth --lit -o lit.md
  aquafuse evaluate truth --lit=sea -o lit_sea.md    waters by number, and JPEG
  aquafuse evaluate truth --places wall -o wall.md   places that nothing was fitted to";

/// Score how much of the true change each method achieves, on synthetic scenes.
///
/// Scores all models with true and estimated depth and water, and colour transfer. Needs no images: the scenes
/// are numbered and the same on every machine.
#[derive(Args)]
#[command(after_help = HELP)]
pub(crate) struct TruthArguments {
    /// Number of exchanges, each a content and a reference in another water.
    #[arg(long, value_name = "N", default_value_t = 120, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    exchanges: u32,
    /// Which family of places: constants of the estimators were chosen on reefs, and the network learned from reefs and harbours; walls
    /// and open water had no part in either.
    #[arg(long, value_enum, default_value_t = Places::Harbour)]
    places: Places,
    /// Take scenes that are lit by their own water, as a camera exposes and balances them (truth C). WATERS: the types of Jerlov,
    /// or waters drawn as `sea:NUMBER` is, stored as JPEG.
    #[arg(long, value_name = "WATERS", value_enum, num_args = 0..=1, default_missing_value = "jerlov", require_equals = true)]
    lit: Option<Lit>,
    /// Form scenes, estimate and fuse in linear light.
    #[arg(long)]
    linear: bool,
    /// Random seed of the bootstrap.
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
    #[command(flatten)]
    report: ReportArguments,
}

/// Families of places.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Places {
    /// Sand, rocks, corals, grass and fish.
    Reef,
    /// Mud, concrete, piles and pipes.
    Harbour,
    /// A steep wall with an overhang, lit from above.
    Wall,
    /// A school of fish and divers in black, without a floor.
    OpenWater,
}

impl Places {
    fn site(self) -> Site {
        match self {
            Self::Reef => Site::Reef,
            Self::Harbour => Site::Harbour,
            Self::Wall => Site::Wall,
            Self::OpenWater => Site::OpenWater,
        }
    }
}

/// Which waters scenes are lit by.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Lit {
    /// The ten types of Jerlov.
    Jerlov,
    /// Waters drawn as `sea:NUMBER` is, stored as JPEG.
    Sea,
}

impl Lit {
    fn waters(self) -> LitWaters {
        match self {
            Self::Jerlov => LitWaters::Jerlov,
            Self::Sea => LitWaters::Sea,
        }
    }
}

impl TruthArguments {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        self.report.check()?;
        let truth = Truth {
            exchanges: self.exchanges as usize,
            places: self.places.site(),
            lit: self.lit.map(Lit::waters),
            linear: self.linear,
            seed: self.seed,
            run_options: common.run_options(),
        };
        self.report.run(common, |listener: Listener<'_>| truth.run(listener), |_| {})
    }
}
