//! A decoder that panics has a bug of its own, but it must not take a run of images with it.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};

thread_local! {
    static BEHIND: Cell<bool> = const { Cell::new(false) };
}

/// Runs a decoder; none when it panicked.
pub(crate) fn behind<R>(decoder: impl FnOnce() -> R) -> Option<R> {
    let was = BEHIND.replace(true);
    // Whatever the decoder was at work on is dropped with it: nothing half-made is seen again.
    let result = catch_unwind(AssertUnwindSafe(decoder)).ok();
    BEHIND.set(was);
    result
}

/// From now on, decoders that panic no longer print so themselves: the error of their file says it.
///
/// For programs, once, before work begins; it changes the panic hook of the process.
pub fn hush_decoders() {
    let others = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        if !BEHIND.get() {
            others(panic);
        }
    }));
}
