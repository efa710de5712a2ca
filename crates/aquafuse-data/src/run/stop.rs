//! The flag by which whoever started a run stops it.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::files::FileError;

/// Stops a run from another thread: a window that was closed, Ctrl-C in a notebook.
///
/// Clones share one flag. Every stage of a run asks it: no further item begins, and an item in work is dropped before
/// its output takes its name, so that every file that is there is whole. Evaluations and `pairs::gather` finish the items in
/// work.
///
/// # Examples
///
/// ```
/// use aquafuse_data::run::{RunOptions, Stop};
///
/// let stop = Stop::default();
/// let options = RunOptions { stop: stop.clone(), ..RunOptions::default() };
/// stop.stop();
/// assert!(options.stop.is_stopped());
/// ```
#[derive(Clone, Debug, Default)]
pub struct Stop(Arc<AtomicBool>);

/// The run was stopped before this was done.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the run was stopped; repeat the command to continue")]
pub struct Stopped;

impl Stop {
    /// Asks the run to stop.
    pub fn stop(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether the run was asked to stop.
    pub fn is_stopped(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// An error once the run was asked to stop: for `?` between the stages of an item whose output is `path`.
    ///
    /// # Errors
    ///
    /// [`FileError::Stopped`] once [`stop`](Self::stop) was called.
    pub fn check(&self, path: &Path) -> Result<(), FileError> {
        if self.is_stopped() { Err(FileError::Stopped { path: path.to_owned() }) } else { Ok(()) }
    }
}
