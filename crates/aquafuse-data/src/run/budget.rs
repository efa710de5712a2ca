//! One memory budget for all images processed at once.

use std::sync::{Condvar, Mutex, PoisonError};

use crate::files::{FileError, is_memory};
use crate::image_file::{Format, Opened};

/// Memory that a run may take for its images, shared by its threads.
///
/// Each image reserves what it needs, as far as its header shows, before it is decoded; where too little is
/// free it waits for others to be done.
///
/// # Examples
///
/// ```
/// use aquafuse_data::run::Budget;
///
/// let budget = Budget::new(100 << 20);
/// let room = budget.reserve(60 << 20);
/// assert_eq!(budget.free(), 40 << 20);
/// drop(room);
/// assert_eq!(budget.free(), 100 << 20);
/// ```
#[derive(Debug)]
pub struct Budget {
    most: u64,
    free: Mutex<u64>,
    given_back: Condvar,
}

/// A part of a [`Budget`], given back when dropped.
#[derive(Debug)]
pub struct Reservation<'a> {
    budget: &'a Budget,
    bytes: u64,
}

impl Budget {
    /// A budget of so many bytes.
    pub fn new(bytes: u64) -> Self {
        Self { most: bytes, free: Mutex::new(bytes), given_back: Condvar::new() }
    }

    /// All of it, in bytes.
    pub fn most(&self) -> u64 {
        self.most
    }

    /// What is not reserved, in bytes.
    pub fn free(&self) -> u64 {
        *self.free.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes `bytes` of the budget, waiting until they are free. More than all of it counts as all of it.
    pub fn reserve(&self, bytes: u64) -> Reservation<'_> {
        let bytes = bytes.min(self.most);
        let mut free = self.free.lock().unwrap_or_else(PoisonError::into_inner);
        let left = loop {
            match free.checked_sub(bytes) {
                Some(left) => break left,
                None => free = self.given_back.wait(free).unwrap_or_else(PoisonError::into_inner),
            }
        };
        *free = left;
        Reservation { budget: self, bytes }
    }

    /// Takes what an image needs until it is written in a format, with `beside` bytes for what is read with it. A thread that
    /// holds a part of the budget already would wait for itself.
    pub(crate) fn reserve_for(
        &self,
        opened: &Opened,
        format: Format,
        beside: u64,
    ) -> Result<Reservation<'_>, FileError> {
        let bytes = opened.memory_until_written(format, beside)?;
        let no_memory = || FileError::NoMemory { path: opened.path().to_owned(), bytes };
        self.reserve_if_there(bytes).ok_or_else(no_memory)
    }

    /// As [`reserve`](Self::reserve), if the system has that much memory, which is less than the budget where it is limited.
    /// What others have reserved counts as taken, for they may not have allocated it yet. `None` once nobody has
    /// anything to give back.
    fn reserve_if_there(&self, bytes: u64) -> Option<Reservation<'_>> {
        let bytes = bytes.min(self.most);
        let mut free = self.free.lock().unwrap_or_else(PoisonError::into_inner);
        loop {
            let taken = self.most.saturating_sub(*free);
            match free.checked_sub(bytes) {
                Some(left) if is_memory(bytes.saturating_add(taken)) => {
                    *free = left;
                    return Some(Reservation { budget: self, bytes });
                }
                Some(_) if taken == 0 => return None,
                _ => free = self.given_back.wait(free).unwrap_or_else(PoisonError::into_inner),
            }
        }
    }
}

impl Drop for Reservation<'_> {
    fn drop(&mut self) {
        let mut free = self.budget.free.lock().unwrap_or_else(PoisonError::into_inner);
        *free = free.saturating_add(self.bytes);
        drop(free);
        self.budget.given_back.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicU64, Ordering};

    #[test]
    fn threads_never_hold_more_than_the_budget() {
        let budget = Budget::new(100);
        let (held, most) = (AtomicU64::new(0), AtomicU64::new(0));
        std::thread::scope(|scope| {
            for thread in 0..8 {
                let (budget, held, most) = (&budget, &held, &most);
                scope.spawn(move || {
                    for i in 0..200 {
                        let bytes = 1 + (37 * i + 11 * thread) % 70;
                        let _room = budget.reserve(bytes);
                        most.fetch_max(held.fetch_add(bytes, Ordering::SeqCst) + bytes, Ordering::SeqCst);
                        held.fetch_sub(bytes, Ordering::SeqCst);
                    }
                });
            }
        });
        assert!(most.into_inner() <= 100);
        assert_eq!(budget.free(), 100);
    }

    #[test]
    fn what_the_system_has_not_is_refused_once_nobody_else_has_a_part_of_it() {
        let budget = Budget::new(u64::MAX);
        assert!(budget.reserve_if_there(u64::MAX / 4).is_none());
        let first = budget.reserve_if_there(1 << 20).unwrap();
        std::thread::scope(|scope| {
            let refused = scope.spawn(|| budget.reserve_if_there(u64::MAX / 4).is_none());
            drop(first);
            assert!(refused.join().unwrap());
        });
    }

    #[test]
    fn an_image_larger_than_the_budget_gets_all_of_it_and_does_not_wait_for_ever() {
        let budget = Budget::new(10);
        let room = budget.reserve(u64::MAX);
        assert_eq!(budget.free(), 0);
        drop(room);
    }
}
