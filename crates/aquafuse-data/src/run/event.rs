//! What a run reports as it goes.

use crate::files::FileError;

/// One step of a run, reported to its caller: `I` is an item, `R` the outcome of an item, `E` the error of an item.
///
/// Events arrive from several threads, in the order in which items end. No output depends on that order.
#[derive(Debug)]
#[non_exhaustive]
pub enum Event<'a, I: ?Sized, R = (), E = FileError> {
    /// The run begins.
    Started {
        /// Items in it.
        total: usize,
    },
    /// An earlier run has made the item.
    Skipped {
        /// The item.
        item: &'a I,
    },
    /// The item is done.
    Done {
        /// The item.
        item: &'a I,
        /// Its outcome.
        result: R,
    },
    /// The item failed, or a part of it; the others go on.
    Failed {
        /// The item.
        item: &'a I,
        /// Why.
        error: E,
    },
}

/// Whoever listens to a run; it is called from several threads.
pub type Listener<'a, I, R = (), E = FileError> = &'a (dyn Fn(Event<'_, I, R, E>) + Sync);
