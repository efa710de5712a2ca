//! What trains splats.

use std::path::{Path, PathBuf};

use aquafuse_scene::capture::{Capture, Shown};
use aquafuse_scene::train::Options;

use crate::commands::scene::splats_file::Trained;
use crate::failure::Failure;

/// A scene to train on.
pub(super) struct Task<'a> {
    /// All of it.
    pub(super) taken: &'a Capture,
    /// The images that are not held back.
    pub(super) trained_on: &'a [&'a Shown],
    pub(super) options: Options,
    pub(super) sh_degree: u8,
    pub(super) learns_water: bool,
    /// FILE.ply, not written yet.
    pub(super) output: &'a Path,
    /// Begin again, whatever a run before has left.
    pub(super) overwrite: bool,
    pub(super) quiet: bool,
}

impl Task<'_> {
    /// The output's name with more behind it: what an engine keeps while it is at work.
    pub(super) fn beside(&self, more: &str) -> PathBuf {
        let mut name = self.output.as_os_str().to_owned();
        name.push(more);
        name.into()
    }
}

/// A way to train.
pub(super) trait Engine {
    /// Trains to the end.
    fn train(&self, task: &Task<'_>) -> Result<Trained, Failure>;

    /// Takes away what it has kept, once the output is written.
    fn clear(&self, task: &Task<'_>);
}
