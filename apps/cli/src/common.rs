//! What every command takes.

use clap::Args;

use crate::reading::Reading;

/// Where the help lists what every command takes.
pub(crate) const HEADING: &str = "Common options";

#[derive(Args)]
pub(crate) struct Common {
    /// Work on this many threads [default: one a core]. No output depends on it.
    #[arg(long, global = true, help_heading = HEADING, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=512))]
    pub(crate) threads: Option<u16>,
    #[command(flatten)]
    pub(crate) reading: Reading,
    /// Say nothing but errors and what was asked for.
    #[arg(long, global = true, help_heading = HEADING)]
    pub(crate) quiet: bool,
}
