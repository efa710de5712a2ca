//! Plain code compiled for AVX2.

#![allow(unsafe_code, reason = "the call that needs AVX2")]

use super::Avx2;

/// Calls `work` where the compiler may use AVX2.
#[inline(always)]
pub(super) fn call<R>(_: Avx2, work: impl FnOnce() -> R) -> R {
    // SAFETY: the first argument proves that the processor has AVX2.
    unsafe { inside(work) }
}

#[target_feature(enable = "avx2")]
fn inside<R>(work: impl FnOnce() -> R) -> R {
    work()
}
