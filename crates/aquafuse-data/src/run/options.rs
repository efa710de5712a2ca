//! How a run works, whatever it makes.

use std::num::NonZeroUsize;

use super::{Budget, Stop};
use crate::image_file::ReadOptions;

/// How a run works. But for [`ReadOptions::lenient`] and [`ReadOptions::border`], no output depends on it.
#[derive(Clone, Debug, Default)]
pub struct RunOptions {
    /// Items in work at once, beside those that wait for the disk. `None`: one per core.
    pub threads: Option<NonZeroUsize>,
    /// Stop once more items than this have failed. `None`: never.
    pub max_failures: Option<usize>,
    /// How images are read, and how much memory all of them share.
    pub reading: ReadOptions,
    /// Stops the run from another thread.
    pub stop: Stop,
}

impl RunOptions {
    /// The memory that all items in work share.
    pub fn budget(&self) -> Budget {
        Budget::new(self.reading.max_memory)
    }
}

/// How a run ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Summary {
    /// Items that this run made.
    pub done: usize,
    /// Items that a run before it had made.
    pub skipped: usize,
    /// Items that failed.
    pub failed: usize,
    /// Items that were not tried, because too many had failed or the run was stopped.
    pub left: usize,
}
