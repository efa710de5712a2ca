//! Work on many images by several threads within one budget of memory, in an order that nothing depends on.

use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use crate::image_file::ReadOptions;

/// How an evaluation runs; no figure depends on it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Conduct {
    /// Images in work at once; none: one a core.
    pub threads: Option<NonZeroUsize>,
    /// How to read images.
    pub reading: ReadOptions,
}

/// What a running evaluation says.
#[derive(Debug)]
#[non_exhaustive]
pub enum Message<'a> {
    /// It begins with so many steps.
    Started {
        /// Steps.
        total: usize,
    },
    /// A step has ended, well or not.
    Done {
        /// What it was about.
        name: &'a str,
    },
    /// Something failed; the rest goes on. The step it belongs to ends by itself.
    Failed(&'a super::Failed),
}

/// Whoever listens to an evaluation.
pub type Listener<'a> = &'a (dyn Fn(Message<'_>) + Sync);

impl Conduct {
    /// Does `work` on each item; the results stand in the order of the items.
    pub(crate) fn each<I: Sync, R: Send>(&self, items: &[I], work: impl Fn(&I) -> R + Sync) -> Vec<R> {
        let cores = || thread::available_parallelism().map_or(1, NonZeroUsize::get);
        let threads = self.threads.map_or_else(cores, NonZeroUsize::get).min(items.len());
        let next = AtomicUsize::new(0);
        let take = || {
            let mut done = Vec::new();
            loop {
                let place = next.fetch_add(1, Ordering::Relaxed);
                let Some(item) = items.get(place) else { return done };
                done.push((place, work(item)));
            }
        };
        // Threads of its own: one that waits for memory in a pool could be given work that waits for it.
        let mut done: Vec<(usize, R)> = thread::scope(|scope| {
            let crew: Vec<_> = (0..threads).map(|_| scope.spawn(take)).collect();
            let result = |hand: thread::ScopedJoinHandle<'_, _>| {
                hand.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
            };
            crew.into_iter().flat_map(result).collect()
        });
        done.sort_by_key(|(place, _)| *place);
        done.into_iter().map(|(_, result)| result).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_stand_in_the_order_of_the_items_whoever_did_them() {
        let items: Vec<usize> = (0..500).collect();
        for threads in [1, 3, 16] {
            let conduct = Conduct { threads: NonZeroUsize::new(threads), ..Conduct::default() };
            assert_eq!(
                conduct.each(&items, |item| item * item),
                items.iter().map(|item| item * item).collect::<Vec<_>>()
            );
        }
        assert!(Conduct::default().each(&[] as &[u8], |item| *item).is_empty());
    }
}
