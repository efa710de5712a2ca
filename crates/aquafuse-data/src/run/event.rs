//! What a run reports as it goes.

use crate::files::FileError;

/// One step of a run, reported to whoever started it: `I` is an item, `R` what is known of one that is done, `E` why
/// one failed.
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
    /// A run before this one has made the item.
    Skipped {
        /// The item.
        item: &'a I,
    },
    /// The item is done.
    Done {
        /// The item.
        item: &'a I,
        /// What is known of it.
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
