//! Work on an image in bands of rows: they stay in the cache, and threads share them out.
//!
//! What a band holds depends on the image alone, never on the number of threads.

/// Rows of a band. Even, since the median takes rows in pairs; each band computes six rows of depth twice.
pub(crate) const ROWS: usize = 64;
/// Images smaller than this are done before another thread has woken up.
#[cfg(feature = "threads")]
const FEW_VALUES: usize = 1 << 17;

/// Calls `work` with the number of the first row and the values of each band, and adds up what it returns.
///
/// The sum must not depend on its order.
pub(crate) fn sum<T: Send, S: Default + Send>(
    values: &mut [T],
    per_row: usize,
    work: impl Fn(usize, &mut [T]) -> S + Sync,
    add: impl Fn(S, S) -> S + Send + Sync,
) -> S {
    let band = ROWS * per_row;
    #[cfg(feature = "threads")]
    if pays(values.len()) {
        use rayon::prelude::*;
        let bands = values.par_chunks_mut(band).enumerate();
        return bands.map(|(index, band)| work(index * ROWS, band)).reduce(S::default, add);
    }
    let bands = values.chunks_mut(band).enumerate();
    bands.map(|(index, band)| work(index * ROWS, band)).fold(S::default(), add)
}

/// [`sum`] for work that returns nothing.
pub(crate) fn for_each<T: Send>(values: &mut [T], per_row: usize, work: impl Fn(usize, &mut [T]) + Sync) {
    sum(values, per_row, work, |(), ()| ());
}

/// [`for_each`] for two values a place.
pub(crate) fn for_each_two<A: Send, B: Send>(
    a: &mut [A],
    b: &mut [B],
    per_row: usize,
    work: impl Fn(usize, &mut [A], &mut [B]) + Sync,
) {
    let band = ROWS * per_row;
    #[cfg(feature = "threads")]
    if pays(a.len()) {
        use rayon::prelude::*;
        let bands = a.par_chunks_mut(band).zip(b.par_chunks_mut(band)).enumerate();
        return bands.for_each(|(index, (a, b))| work(index * ROWS, a, b));
    }
    for (index, (a, b)) in a.chunks_mut(band).zip(b.chunks_mut(band)).enumerate() {
        work(index * ROWS, a, b);
    }
}

/// Does two things to so many values, side by side if that pays.
pub(crate) fn both<A: Send, B: Send>(
    values: usize,
    a: impl FnOnce() -> A + Send,
    b: impl FnOnce() -> B + Send,
) -> (A, B) {
    #[cfg(feature = "threads")]
    if pays(values) {
        return rayon::join(a, b);
    }
    let _ = values;
    (a(), b())
}

/// Whether there are threads, and enough values to wake them for.
#[cfg(feature = "threads")]
fn pays(values: usize) -> bool {
    values > FEW_VALUES && has_threads()
}

/// Whether other threads may be woken.
#[cfg(feature = "threads")]
pub(crate) fn has_threads() -> bool {
    !IS_ALONE.get() && rayon::current_num_threads() > 1
}

#[cfg(feature = "threads")]
thread_local! {
    static IS_ALONE: std::cell::Cell<bool> = const { std::cell::Cell::new(false) };
}

/// Does work on the calling thread alone: within it, this crate neither starts nor wakes another one. No bit changes.
///
/// For programs that have threads of their own for many images, and for processes that were forked: those have none of
/// the threads of their parent, and work that is handed to such a pool never comes back.
///
/// # Examples
///
/// ```
/// use aquafuse::{Fuser, image::Image};
///
/// let image = Image::<u8>::from_raw(2, 1, vec![90, 100, 110, 20, 100, 120])?;
/// let fused = aquafuse::on_this_thread(|| Fuser::new(&image)?.fuse(&image))?;
/// assert_eq!(fused.image.size(), (2, 1));
/// # Ok::<(), aquafuse::image::ImageError>(())
/// ```
pub fn on_this_thread<R>(work: impl FnOnce() -> R) -> R {
    #[cfg(feature = "threads")]
    let _before = Before(IS_ALONE.replace(true));
    work()
}

/// Puts the flag back, also if the work panics.
#[cfg(feature = "threads")]
struct Before(bool);

#[cfg(feature = "threads")]
impl Drop for Before {
    fn drop(&mut self) {
        IS_ALONE.set(self.0);
    }
}

#[cfg(test)]
#[cfg(feature = "threads")]
mod tests {
    use super::*;
    use std::collections::HashSet;
    use std::sync::Mutex;
    use std::thread::{ThreadId, current};

    /// The threads that bands of many values are worked on by.
    fn workers() -> HashSet<ThreadId> {
        let seen = Mutex::new(HashSet::new());
        for_each(&mut vec![0_u8; 8 * FEW_VALUES], 64, |_, _| {
            seen.lock().unwrap().insert(current().id());
        });
        both(2 * FEW_VALUES, || seen.lock().unwrap().insert(current().id()), || ());
        seen.into_inner().unwrap()
    }

    #[test]
    fn work_on_this_thread_wakes_no_other_one_and_afterwards_others_may_work_again() {
        assert_eq!(on_this_thread(workers), HashSet::from([current().id()]));
        assert!(std::panic::catch_unwind(|| on_this_thread(|| panic!("within"))).is_err());
        assert!(!IS_ALONE.get());
    }
}
