//! Sections of `docs/results.md` that `aquafuse evaluate` prints.

use std::path::Path;

use anyhow::Result;
use xtask::shell::{command, output, say};

use crate::pages::{RESULTS, real_images, show_section};

/// Writes a section with what `aquafuse evaluate` prints.
pub(crate) fn write(aquafuse: &Path, section: &str, arguments: &[&str]) -> Result<()> {
    let evaluate = command(aquafuse, &[&["evaluate"], arguments].concat());
    show_section(RESULTS, section, &output(evaluate)?)
}

/// `lab published`: real images scored, beside what the paper prints, what others make of them, and before and after
/// enhancement.
pub(crate) fn published() -> Result<()> {
    let scenes = format!("{}/scenes", real_images()?);
    let aquafuse = crate::programs::aquafuse()?;
    say("Fusing real images, each with eight others (minutes)");
    let fusion =
        ["fusion", "--contents", &scenes, "--references", &scenes, "--group-by", "prefix", "--pairs", "8"];
    write(&aquafuse, "published", &[&fusion[..], &["--as-published"]].concat())?;
    write(&aquafuse, "methods", &[&fusion[..], &["--rivals"]].concat())?;
    write(&aquafuse, "enhancement", &["enhancement", &scenes])
}
