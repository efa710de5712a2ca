//! `lab readings`: what each way to read the paper does to the scores, on scenes whose truth is known.
//!
//! The exchanges are made as those of `aquafuse evaluate truth`, of the same places in other waters.

mod reading;
mod scores;
mod tables;

use anyhow::{Result, bail};
use xtask::shell::say;

use crate::pages::show_section;
use tables::TABLES;

/// The page of how the paper is read.
const METHOD: &str = "docs/method.md";

/// Writes all tables, or the one of this name.
pub(crate) fn run(only: Option<&str>) -> Result<()> {
    if let Some(only) = only.filter(|only| TABLES.iter().all(|(name, _)| name != only)) {
        bail!("there is no table {only}; there are {}", TABLES.map(|(name, _)| name).join(", "));
    }
    say("Reading the paper each way, on truth scenes (two minutes)");
    let exchanges = tables::exchanges();
    for (name, table) in TABLES.into_iter().filter(|(name, _)| only.is_none_or(|only| *name == only)) {
        show_section(METHOD, name, &table(&exchanges)?)?;
    }
    Ok(())
}
