//! Work that is given up after a while.

use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::thread;
use std::time::Duration;

use crate::files::{catch_panic, guard_this_thread};

/// Networks within networks are read level by level, each on the stack.
const STACK: usize = 8 << 20;

/// Why work has no result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Lost {
    /// It took longer than it was given.
    TooSlow,
    Panicked,
    NoThread,
}

/// The result of work that ends within `limit`. What takes longer goes on, on a thread of its own, until it ends or the program
/// does: its library has no way to stop it, and the result is dropped.
pub(super) fn in_time<R: Send + 'static>(
    limit: Duration,
    work: impl FnOnce() -> R + Send + 'static,
) -> Result<R, Lost> {
    let (send, ended) = sync_channel(1);
    let on_thread = move || {
        guard_this_thread();
        // Nobody listens any more where it took too long.
        let _ = send.send(catch_panic(work));
    };
    thread::Builder::new().stack_size(STACK).spawn(on_thread).map_err(|_| Lost::NoThread)?;
    let ended = ended.recv_timeout(limit).map_err(|lost| match lost {
        RecvTimeoutError::Timeout => Lost::TooSlow,
        RecvTimeoutError::Disconnected => Lost::Panicked,
    });
    ended?.ok_or(Lost::Panicked)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_that_is_done_is_returned_and_work_that_never_ends_is_not_waited_for() {
        assert_eq!(in_time(Duration::from_secs(600), || 7), Ok(7));
        let (_held, never) = sync_channel::<u8>(1);
        assert_eq!(in_time(Duration::from_millis(10), move || never.recv()), Err(Lost::TooSlow));
    }

    #[test]
    fn a_panic_is_no_result() {
        let panics = || -> u8 { panic!("as a reader does") };
        assert_eq!(in_time(Duration::from_secs(600), panics), Err(Lost::Panicked));
    }
}
