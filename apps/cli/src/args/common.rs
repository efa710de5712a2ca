//! Options of every command.

use std::num::NonZeroUsize;

use aquafuse::scene_area::Border;
use aquafuse::waterbody::WaterMap;
use aquafuse_data::pipeline::PixelEncoding;
use aquafuse_data::run::RunOptions;
use clap::Args;

use crate::args::reading::Reading;

/// The heading of these options in the help.
pub(crate) const HEADING: &str = "Common options";

#[derive(Clone, Args)]
pub(crate) struct Common {
    /// Number of threads [default: one per core]. Outputs do not depend on it.
    #[arg(long, global = true, help_heading = HEADING, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=512))]
    pub(crate) threads: Option<u16>,
    #[command(flatten)]
    pub(crate) reading: Reading,
    /// Print only errors and the requested result.
    #[arg(long, global = true, help_heading = HEADING)]
    pub(crate) quiet: bool,
    /// Print details: which images the counts are about, and what work was done.
    #[arg(short, long, global = true, help_heading = HEADING, conflicts_with = "quiet")]
    pub(crate) verbose: bool,
}

impl Common {
    /// The same, with images cut to their scene.
    pub(crate) fn with_border(mut self, border: Border) -> Self {
        self.reading.border = border;
        self
    }

    /// The same, with another map of open water.
    pub(crate) fn with_water_map(mut self, water_map: WaterMap) -> Self {
        self.reading.water_map = water_map;
        self
    }

    /// How a run of the library works, as these options say.
    pub(crate) fn run_options(&self) -> RunOptions {
        RunOptions {
            threads: self.threads.and_then(|threads| NonZeroUsize::new(threads.into())),
            reading: self.reading.options(),
            ..RunOptions::default()
        }
    }
}

/// The encoding that `--linear` asks for.
pub(crate) fn encoding(linear: bool) -> PixelEncoding {
    if linear { PixelEncoding::Linear } else { PixelEncoding::Encoded }
}
