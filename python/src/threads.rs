//! How many threads one call uses, also in processes that were forked.
//!
//! A forked process has none of the threads of its parent, so a pool of the parent would never answer. Each pool
//! therefore belongs to one process, and a process that was forked starts with one thread.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::id;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};
use std::sync::{Arc, RwLock};

use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::error::Fault;

/// The process that imported the module.
static HOME: AtomicU32 = AtomicU32::new(0);
/// The number that was asked for in the lower half, the process that asked in the upper one.
static CHOSEN: AtomicU64 = AtomicU64::new(0);
static POOL: RwLock<Option<Pool>> = RwLock::new(None);
/// More would be a slip of the keyboard.
pub(crate) const MOST: usize = 512;

#[derive(Clone)]
struct Pool {
    process: u32,
    threads: usize,
    pool: Arc<ThreadPool>,
}

pub(crate) fn remember_process() {
    HOME.store(id(), Ordering::Relaxed);
}

/// Whether this process was forked from the one that imported the module.
pub(crate) fn is_forked() -> bool {
    HOME.load(Ordering::Relaxed) != id()
}

/// The number of threads that one call uses in this process.
#[pyfunction]
pub(crate) fn get_threads() -> usize {
    let chosen = CHOSEN.load(Ordering::Relaxed);
    if chosen >> 32 == u64::from(id()) {
        return (chosen & u64::from(u32::MAX)) as usize;
    }
    if is_forked() { 1 } else { std::thread::available_parallelism().map_or(1, usize::from) }
}

/// Sets the number of threads that one call uses in this process.
#[pyfunction]
pub(crate) fn set_threads(threads: i64) -> Result<(), Fault> {
    let number = usize::try_from(threads).ok().filter(|threads| (1..=MOST).contains(threads));
    let number = number.ok_or_else(|| Fault::argument(format!("{threads} threads: give 1 to {MOST}")))?;
    CHOSEN.store(u64::from(id()) << 32 | number as u64, Ordering::Relaxed);
    Ok(())
}

/// Does work without the GIL, on the threads of this process. A panic is an error.
pub(crate) fn work<R: Send>(
    py: Python<'_>,
    work: impl FnOnce() -> Result<R, Fault> + Send,
) -> Result<R, Fault> {
    py.detach(|| {
        install(get_threads(), || {
            catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|cause| Err(Fault::panic(&*cause)))
        })
    })
}

/// Does work on so many threads.
pub(crate) fn install<R: Send>(threads: usize, work: impl FnOnce() -> R + Send) -> R {
    match pool(threads) {
        Some(pool) => pool.install(work),
        None => aquafuse::on_this_thread(work),
    }
}

/// Panics within work, for the test that a panic becomes an exception.
#[pyfunction]
pub(crate) fn panic(py: Python<'_>, message: &str) -> Result<(), Fault> {
    work(py, || panic!("{message}"))
}

/// The pool of this process; `None` for one thread, and where the system gives no more.
fn pool(threads: usize) -> Option<Arc<ThreadPool>> {
    if threads == 1 {
        return None;
    }
    let process = id();
    let is_ours = |pool: &&Pool| pool.process == process && pool.threads == threads;
    // Never waits: whoever held the lock when this process was forked does not exist here.
    if let Some(pool) = POOL.try_read().ok()?.as_ref().filter(is_ours) {
        return Some(pool.pool.clone());
    }
    let new = Arc::new(ThreadPoolBuilder::new().num_threads(threads).build().ok()?);
    let mut held = POOL.try_write().ok()?;
    let old = held.replace(Pool { process, threads, pool: new.clone() });
    // The threads of a pool of another process do not exist here, and nobody can end them.
    if let Some(old) = old.filter(|old| old.process != process) {
        std::mem::forget(old);
    }
    Some(new)
}
