//! Plain code compiled for AVX2.

#![allow(unsafe_code, reason = "the call that needs AVX2")]

use super::{Avx2, Work};

/// Does `work` where the compiler may use AVX2.
#[inline]
pub(super) fn run<W: Work>(_: Avx2, work: W) -> W::Output {
    // SAFETY: the first argument proves that the processor has AVX2.
    unsafe { inside(work) }
}

#[target_feature(enable = "avx2")]
fn inside<W: Work>(work: W) -> W::Output {
    work.run()
}
