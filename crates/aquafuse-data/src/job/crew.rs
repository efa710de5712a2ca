//! Threads that take item after item, until there is none left or too many failed.

use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;

use super::Summary;

/// How one item ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    Done,
    /// It was done before.
    Kept,
    Failed,
}

/// How many work at once, and how much failure they bear.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Crew {
    /// None: one a core.
    pub(crate) threads: Option<NonZeroUsize>,
    /// None: any number.
    pub(crate) most_failures: Option<usize>,
}

#[derive(Default)]
struct Progress {
    next: AtomicUsize,
    done: AtomicUsize,
    kept: AtomicUsize,
    failed: AtomicUsize,
    stopped: AtomicBool,
}

impl Crew {
    /// Does what is to be done with every item.
    pub(crate) fn each<T: Sync>(&self, items: &[T], work: &(dyn Fn(&T) -> Outcome + Sync)) -> Summary {
        let cores = || thread::available_parallelism().map_or(1, NonZeroUsize::get);
        let threads = self.threads.map_or_else(cores, NonZeroUsize::get);
        let progress = Progress::default();
        // Threads of its own: one that waits for memory in a pool could be given work that waits for it.
        thread::scope(|scope| {
            for _ in 0..threads.min(items.len()) {
                scope.spawn(|| self.take_turns(items, &progress, work));
            }
        });
        let Progress { done, kept, failed, .. } = progress;
        let [done, kept, failed] = [done, kept, failed].map(AtomicUsize::into_inner);
        let tried = done.saturating_add(kept).saturating_add(failed);
        Summary { done, kept, failed, left: items.len().saturating_sub(tried) }
    }

    fn take_turns<T>(&self, items: &[T], progress: &Progress, work: &(dyn Fn(&T) -> Outcome + Sync)) {
        while let Some(item) = items.get(progress.next.fetch_add(1, Ordering::Relaxed)) {
            if progress.stopped.load(Ordering::Relaxed) {
                return;
            }
            match work(item) {
                Outcome::Done => progress.done.fetch_add(1, Ordering::Relaxed),
                Outcome::Kept => progress.kept.fetch_add(1, Ordering::Relaxed),
                Outcome::Failed => {
                    let before = progress.failed.fetch_add(1, Ordering::Relaxed);
                    if self.most_failures.is_some_and(|most| before >= most) {
                        progress.stopped.store(true, Ordering::Relaxed);
                    }
                    before
                }
            };
        }
    }
}
