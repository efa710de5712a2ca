//! Threads that take item after item, until there is none left or too many failed.

use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;

use super::Summary;
use crate::run::{Budget, Reservation};

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

/// The right to keep a core busy: there are as many as threads were asked for.
pub(crate) struct Turn<'a>(Option<Reservation<'a>>);

impl Turn<'_> {
    /// What is left of the item is waiting for a disk: another item may begin.
    pub(crate) fn end(&mut self) {
        self.0 = None;
    }
}

/// What is done with an item, as long as it is its turn.
type Work<'a, T> = dyn Fn(&T, &mut Turn<'_>) -> Outcome + Sync + 'a;

impl Crew {
    /// Does what is to be done with every item.
    pub(crate) fn each<T: Sync>(&self, items: &[T], work: &Work<'_, T>) -> Summary {
        let cores = || thread::available_parallelism().map_or(1, NonZeroUsize::get);
        let threads = self.threads.map_or_else(cores, NonZeroUsize::get);
        let (progress, turns) = (Progress::default(), Budget::new(threads as u64));
        // Threads of its own: one that waits for memory in a pool could be given work that waits for it. One more than
        // there are turns, for the item that waits for the disk.
        thread::scope(|scope| {
            for _ in 0..threads.saturating_add(1).min(items.len()) {
                scope.spawn(|| self.take_turns(items, &turns, &progress, work));
            }
        });
        let Progress { done, kept, failed, .. } = progress;
        let [done, kept, failed] = [done, kept, failed].map(AtomicUsize::into_inner);
        let tried = done.saturating_add(kept).saturating_add(failed);
        Summary { done, kept, failed, left: items.len().saturating_sub(tried) }
    }

    fn take_turns<T>(&self, items: &[T], turns: &Budget, progress: &Progress, work: &Work<'_, T>) {
        loop {
            let mut turn = Turn(Some(turns.reserve(1)));
            if progress.stopped.load(Ordering::Relaxed) {
                return;
            }
            let Some(item) = items.get(progress.next.fetch_add(1, Ordering::Relaxed)) else { return };
            // Counted before the turn is over: what failed stops the next one.
            match work(item, &mut turn) {
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

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Barrier;

    const ONE: Crew = Crew { threads: NonZeroUsize::new(1), most_failures: Some(0) };

    #[test]
    fn while_one_item_waits_for_the_disk_another_is_worked_on() {
        let both = Barrier::new(2);
        let summary = ONE.each(&[true, false], &|&waits, turn| {
            if waits {
                turn.end();
            }
            both.wait();
            Outcome::Done
        });
        assert_eq!(summary.done, 2);
    }

    #[test]
    fn no_more_work_at_once_than_was_asked_for_and_none_begins_after_a_failure() {
        let (busy, most) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let summary = ONE.each(&[0, 1, 2, 3], &|&item, _| {
            most.fetch_max(busy.fetch_add(1, Ordering::SeqCst) + 1, Ordering::SeqCst);
            thread::yield_now();
            busy.fetch_sub(1, Ordering::SeqCst);
            if item == 1 { Outcome::Failed } else { Outcome::Done }
        });
        assert_eq!(most.into_inner(), 1);
        assert_eq!((summary.done, summary.failed, summary.left), (1, 1, 2));
    }
}
