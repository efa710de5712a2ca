//! One process at a time works in a folder.

use std::fs::{File, TryLockError};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// A process that was killed holds its locks until the system has cleared it away.
const ENDING: Duration = Duration::from_secs(1);
const BETWEEN: Duration = Duration::from_millis(10);

/// Locks a file until it is closed; false where another process has it, and has it still when one that is ending would be
/// gone. On a file system without locks nobody else is known of.
pub(crate) fn lock(file: &File) -> bool {
    let began = Instant::now();
    loop {
        match file.try_lock() {
            Err(TryLockError::WouldBlock) if began.elapsed() < ENDING => sleep(BETWEEN),
            tried => return !matches!(tried, Err(TryLockError::WouldBlock)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lock_that_is_given_back_in_time_is_waited_for_and_one_that_is_kept_is_not() {
        let file = tempfile::NamedTempFile::new().unwrap();
        let other = || File::open(file.path()).unwrap();
        let held = other();
        assert!(lock(&held));
        assert!(!lock(&other()));
        std::thread::scope(|scope| {
            let waiting = scope.spawn(|| lock(&other()));
            sleep(2 * BETWEEN);
            drop(held);
            assert!(waiting.join().unwrap());
        });
    }
}
