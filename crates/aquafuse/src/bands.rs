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
    values > FEW_VALUES && rayon::current_num_threads() > 1
}
