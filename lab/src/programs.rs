//! The programs that are measured, built as they are released.

use std::path::PathBuf;

use anyhow::{Context, Result};
use xtask::shell::{cargo, run, say, target};

const BUILD: [&str; 5] = ["build", "--release", "--quiet", "--locked", "--package"];

/// The command.
pub(crate) fn aquafuse() -> Result<PathBuf> {
    say("Building the command");
    run(cargo(&[&BUILD[..], &["aquafuse-cli"]].concat()))?;
    Ok(target().join("release/aquafuse"))
}

/// An example of one of the crates.
pub(crate) fn example(package: &str, name: &str) -> Result<PathBuf> {
    say(&format!("Building the example {name}"));
    run(cargo(&[&BUILD[..], &[package, "--example", name]].concat()))?;
    Ok(target().join("release/examples").join(name))
}

/// This program, for what is measured in a process of its own.
pub(crate) fn lab() -> Result<PathBuf> {
    std::env::current_exe().context("the system does not say where this program is")
}
