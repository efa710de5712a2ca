//! A decoder that panics has a bug of its own, but it must not take a run of images with it.

use std::cell::Cell;
use std::panic::AssertUnwindSafe;

thread_local! {
    static GUARDED: Cell<bool> = const { Cell::new(false) };
}

/// Runs a decoder; none when it panicked.
pub(crate) fn catch_panic<R>(decoder: impl FnOnce() -> R) -> Option<R> {
    let was = GUARDED.replace(true);
    // Whatever the decoder was at work on is dropped with it: nothing half-made is seen again.
    let result = std::panic::catch_unwind(AssertUnwindSafe(decoder)).ok();
    GUARDED.set(was);
    result
}

/// Makes this thread one of a decoder's own: its panics end in [`catch_panic`] on the thread that waits for it.
#[cfg(feature = "onnx")]
pub(crate) fn guard_this_thread() {
    GUARDED.set(true);
}

/// From now on, decoders that panic no longer print so themselves: the error of their file says it.
///
/// For programs, once, before work begins; it changes the panic hook of the process.
pub fn silence_decoder_panics() {
    let others = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        if !GUARDED.get() {
            others(panic);
        }
    }));
}
