//! `lab truth`: how right the estimates are on scenes whose truth is known, and how much of the true change is made.

mod coarse_depth;
mod estimates;

use anyhow::Result;
use xtask::shell::say;

use crate::evaluate;
use crate::pages::{RESULTS, show_section};

pub(crate) fn run() -> Result<()> {
    let aquafuse = crate::programs::aquafuse()?;
    say("Trying estimates and fusion on truth scenes (about three minutes)");
    show_section(RESULTS, "estimates", &estimates::table()?)?;
    evaluate::write(&aquafuse, "truth", &["truth"])?;
    evaluate::write(&aquafuse, "truth-wall", &["truth", "--places", "wall"])?;
    evaluate::write(&aquafuse, "truth-open-water", &["truth", "--places", "open-water"])?;
    evaluate::write(&aquafuse, "truth-linear", &["truth", "--linear"])?;
    evaluate::write(&aquafuse, "truth-lit", &["truth", "--lit"])?;
    evaluate::write(&aquafuse, "truth-lit-sea", &["truth", "--lit=sea"])?;
    coarse_depth()
}

/// How good depth must be, alone.
pub(crate) fn coarse_depth() -> Result<()> {
    say("Making true depth worse, as a network's is (some minutes)");
    show_section(RESULTS, "coarse-depth", &coarse_depth::table()?)
}
