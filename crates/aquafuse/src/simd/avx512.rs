//! Plain code compiled for AVX-512.

#![allow(unsafe_code, reason = "the call that needs AVX-512")]

use super::{Avx512, Work};

/// Does `work` where the compiler may use AVX-512.
#[inline]
pub(super) fn run<W: Work>(_: Avx512, work: W) -> W::Output {
    // SAFETY: the first argument proves that the processor has these instructions.
    unsafe { inside(work) }
}

#[target_feature(enable = "avx2,avx512f,avx512bw,avx512dq,avx512vl")]
fn inside<W: Work>(work: W) -> W::Output {
    work.run()
}
