//! Threads that take item after item, until none is left, too many failed or the run is stopped.

use std::num::NonZeroUsize;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;

use super::{Budget, Reservation, RunOptions, Stopped, Summary};

/// How one item ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// It is done.
    Done,
    /// A run before this one had done it.
    Skipped,
    /// It failed.
    Failed,
    /// It was dropped because the run was stopped.
    Left,
}

#[derive(Default)]
struct Progress {
    next: AtomicUsize,
    done: AtomicUsize,
    skipped: AtomicUsize,
    failed: AtomicUsize,
    has_ended: AtomicBool,
}

/// The right to keep a core busy: a run has as many as it has threads.
#[derive(Debug)]
pub struct Permit<'a>(Option<Reservation<'a>>);

impl Permit<'_> {
    /// What is left of the item is waiting for a disk: another item may begin.
    pub fn release(&mut self) {
        self.0 = None;
    }
}

/// The work on one item, which holds a permit until it releases it or ends.
type Work<'a, T> = dyn Fn(&T, &mut Permit<'_>) -> Ending + Sync + 'a;

impl RunOptions {
    /// Does `work` on every item, on threads of the run's own.
    pub fn each<T: Sync>(&self, items: &[T], work: &Work<'_, T>) -> Summary {
        let cores = || thread::available_parallelism().map_or(1, NonZeroUsize::get);
        let threads = self.threads.map_or_else(cores, NonZeroUsize::get);
        let (progress, permits) = (Progress::default(), Budget::new(threads as u64));
        // Threads of its own: one that waits for memory in a pool could be given work that waits for it. One more than
        // there are permits, for the item that waits for the disk.
        thread::scope(|scope| {
            let work = || self.work_on(items, &permits, &progress, work);
            let wanted = 0..threads.saturating_add(1).min(items.len());
            // Where the system gives no more threads, those that there are do the work, or this one.
            let started = wanted.map_while(|_| thread::Builder::new().spawn_scoped(scope, work).ok());
            if started.count() == 0 {
                work();
            }
        });
        let Progress { done, skipped, failed, .. } = progress;
        let [done, skipped, failed] = [done, skipped, failed].map(AtomicUsize::into_inner);
        let tried = done.saturating_add(skipped).saturating_add(failed);
        Summary { done, skipped, failed, left: items.len().saturating_sub(tried) }
    }

    /// Does `work` on every item; the results are in the order of the items.
    ///
    /// # Errors
    ///
    /// [`Stopped`] when the run was stopped before all items were done.
    pub fn map<T: Sync, R: Send + Sync>(
        &self,
        items: &[T],
        work: impl Fn(&T) -> R + Sync,
    ) -> Result<Vec<R>, Stopped> {
        let slots: Vec<(&T, OnceLock<R>)> = items.iter().map(|item| (item, OnceLock::new())).collect();
        let every = Self { max_failures: None, ..self.clone() };
        every.each(&slots, &|(item, slot), _| {
            let _ = slot.set(work(item));
            Ending::Done
        });
        slots.into_iter().map(|(_, slot)| slot.into_inner().ok_or(Stopped)).collect()
    }

    /// Does `work`, which may fail, on every item; results keep the order of the items. No item begins after one
    /// has failed.
    ///
    /// # Errors
    ///
    /// The error of the first item that failed, by the order of the items, or [`Stopped`] when the run was stopped before
    /// all were done.
    pub fn try_map<T: Sync, R: Send + Sync, E: Send + Sync + From<Stopped>>(
        &self,
        items: &[T],
        work: impl Fn(&T) -> Result<R, E> + Sync,
    ) -> Result<Vec<R>, E> {
        let slots: Vec<(&T, OnceLock<Result<R, E>>)> =
            items.iter().map(|item| (item, OnceLock::new())).collect();
        let until_one_fails = Self { max_failures: Some(0), ..self.clone() };
        until_one_fails.each(&slots, &|(item, slot), _| {
            let result = work(item);
            let ending = if result.is_ok() { Ending::Done } else { Ending::Failed };
            let _ = slot.set(result);
            ending
        });
        // Items begin in their order: before one that failed there is none that was not tried.
        slots.into_iter().map(|(_, slot)| slot.into_inner().unwrap_or_else(|| Err(Stopped.into()))).collect()
    }

    fn work_on<T>(&self, items: &[T], permits: &Budget, progress: &Progress, work: &Work<'_, T>) {
        loop {
            let mut permit = Permit(Some(permits.reserve(1)));
            if progress.has_ended.load(Ordering::Relaxed) || self.stop.is_stopped() {
                return;
            }
            let Some(item) = items.get(progress.next.fetch_add(1, Ordering::Relaxed)) else { return };
            // Counted before the permit is given back: what failed stops the next one.
            match work(item, &mut permit) {
                Ending::Done => progress.done.fetch_add(1, Ordering::Relaxed),
                Ending::Skipped => progress.skipped.fetch_add(1, Ordering::Relaxed),
                Ending::Failed => {
                    let before = progress.failed.fetch_add(1, Ordering::Relaxed);
                    if self.max_failures.is_some_and(|max| before >= max) {
                        progress.has_ended.store(true, Ordering::Relaxed);
                    }
                    before
                }
                Ending::Left => 0,
            };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Barrier;

    fn one() -> RunOptions {
        RunOptions { threads: NonZeroUsize::new(1), max_failures: Some(0), ..RunOptions::default() }
    }

    #[test]
    fn while_one_item_waits_for_the_disk_another_is_worked_on() {
        let both = Barrier::new(2);
        let summary = one().each(&[true, false], &|&waits, permit| {
            if waits {
                permit.release();
            }
            both.wait();
            Ending::Done
        });
        assert_eq!(summary.done, 2);
    }

    #[test]
    fn no_more_work_at_once_than_was_asked_for_and_none_begins_after_a_failure() {
        let (busy, most) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let summary = one().each(&[0, 1, 2, 3], &|&item, _| {
            most.fetch_max(busy.fetch_add(1, Ordering::SeqCst) + 1, Ordering::SeqCst);
            thread::yield_now();
            busy.fetch_sub(1, Ordering::SeqCst);
            if item == 1 { Ending::Failed } else { Ending::Done }
        });
        assert_eq!(most.into_inner(), 1);
        assert_eq!((summary.done, summary.failed, summary.left), (1, 1, 2));
    }

    #[test]
    fn results_stand_in_the_order_of_the_items_whoever_did_them() {
        let items: Vec<usize> = (0..500).collect();
        for threads in [1, 3, 16] {
            let options = RunOptions { threads: NonZeroUsize::new(threads), ..RunOptions::default() };
            let squares = items.iter().map(|item| item * item).collect();
            assert_eq!(options.map(&items, |item| item * item), Ok(squares));
        }
        assert_eq!(RunOptions::default().map(&[] as &[u8], |item| *item), Ok(Vec::new()));
    }

    #[test]
    fn the_first_failure_by_the_order_of_the_items_is_the_error() {
        #[derive(Debug, PartialEq)]
        struct Fault(Option<usize>);
        impl From<Stopped> for Fault {
            fn from(_: Stopped) -> Self {
                Self(None)
            }
        }
        let items: Vec<usize> = (0..200).collect();
        for threads in [1, 3, 16] {
            let options = RunOptions { threads: NonZeroUsize::new(threads), ..RunOptions::default() };
            let fault = |bad: fn(usize) -> bool| {
                options.try_map(&items, |&item| if bad(item) { Err(Fault(Some(item))) } else { Ok(item) })
            };
            assert_eq!(fault(|_| false), Ok(items.clone()));
            assert_eq!(fault(|item| item >= 70), Err(Fault(Some(70))));
            options.stop.stop();
            assert_eq!(fault(|_| true), Err(Fault(None)));
        }
    }

    #[test]
    fn a_run_that_is_stopped_begins_no_further_item_and_counts_the_rest_as_left() {
        let options = one();
        let summary = options.each(&[0, 1, 2, 3], &|&item, _| {
            if item == 1 {
                options.stop.stop();
                return Ending::Left;
            }
            Ending::Done
        });
        assert_eq!((summary.done, summary.failed, summary.left), (1, 0, 3));
        assert_eq!(options.map(&[1], |item| *item), Err(Stopped));
    }
}
