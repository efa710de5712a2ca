//! Which vector instructions this processor has; asked once, and never part of a result.
//!
//! For the other crates of this workspace alone: no part of the API, and it may change in any release.
//!
//! A fast path is a module of its own (`avx2.rs`, `neon.rs`) beside the plain one, takes the proof that its
//! instructions are there, and gives the same bits. Where the compiler makes vectors of plain code by itself,
//! [`widest`] has it do so for the best instructions too.

#[cfg(all(feature = "simd", target_arch = "x86_64"))]
mod avx2;
#[cfg(all(feature = "simd", target_arch = "x86_64"))]
mod avx512;

/// The fastest instructions there are for the kernels of this crate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Level {
    /// What every processor of the target has.
    #[cfg_attr(
        all(feature = "simd", target_arch = "aarch64"),
        allow(dead_code, reason = "every such processor has NEON")
    )]
    Plain,
    /// x86-64 with AVX2.
    #[cfg(all(feature = "simd", target_arch = "x86_64"))]
    Avx2(Avx2),
    /// 64-bit Arm; part of the architecture.
    #[cfg(all(feature = "simd", target_arch = "aarch64"))]
    Neon,
}

/// The proof that AVX2 is there: only a processor that was asked makes one.
#[cfg(all(feature = "simd", target_arch = "x86_64"))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Avx2(());

#[cfg(all(feature = "simd", target_arch = "x86_64"))]
impl Avx2 {
    fn detected() -> Option<Self> {
        // The standard library asks once a process and remembers.
        is_x86_feature_detected!("avx2").then_some(Self(()))
    }
}

/// The proof that AVX-512 is there, with instructions for bytes and for shorter vectors.
#[cfg(all(feature = "simd", target_arch = "x86_64"))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Avx512(());

#[cfg(all(feature = "simd", target_arch = "x86_64"))]
impl Avx512 {
    fn detected() -> Option<Self> {
        let has = is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512bw")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl");
        has.then_some(Self(()))
    }
}

impl Level {
    /// The best of this processor.
    pub(crate) fn best() -> Self {
        #[cfg(test)]
        if let Some(level) = forced::level() {
            return level;
        }
        #[cfg(all(feature = "simd", target_arch = "x86_64"))]
        if let Some(proof) = Avx2::detected() {
            return Self::Avx2(proof);
        }
        #[cfg(all(feature = "simd", target_arch = "aarch64"))]
        return Self::Neon;
        #[cfg(not(all(feature = "simd", target_arch = "aarch64")))]
        Self::Plain
    }

    /// All of this processor; a test compares them.
    #[cfg(test)]
    pub(crate) fn all() -> Vec<Self> {
        let mut levels = vec![Self::Plain, Self::best()];
        levels.dedup();
        levels
    }

    /// Does `work` with no better instructions than these on this thread: for whole functions, which ask for the
    /// best themselves.
    #[cfg(test)]
    pub(crate) fn force<R>(self, work: impl FnOnce() -> R) -> R {
        forced::with(self, work)
    }
}

/// Plain code that the compiler makes vectors of.
///
/// A trait and no closure, because its one method can be `#[inline(always)]`, as all that it calls must be: what the
/// compiler does not inline, it does not compile once more.
pub trait Work {
    /// What comes of it.
    type Output;

    /// Does it; `#[inline(always)]` in every implementation.
    fn run(self) -> Self::Output;
}

/// Does `work`, compiled once more for the vectors of this processor. It is the same code, and arithmetic is never
/// rearranged for the sake of vectors, so that no bit changes.
#[inline]
pub fn widest<W: Work>(work: W) -> W::Output {
    // No kernel is written for these vectors; what the compiler makes of plain code is twice as fast in them.
    #[cfg(all(feature = "simd", target_arch = "x86_64"))]
    if let Some(proof) = Avx512::detected() {
        return avx512::run(proof, work);
    }
    widest_by(Level::best(), work)
}

/// [`widest`] for the vectors of `level`.
#[inline]
pub(crate) fn widest_by<W: Work>(level: Level, work: W) -> W::Output {
    match level {
        #[cfg(all(feature = "simd", target_arch = "x86_64"))]
        Level::Avx2(proof) => avx2::run(proof, work),
        _ => work.run(),
    }
}

/// Rounding for vectors, which have no instruction for `as`.
pub(crate) trait Whole {
    /// The nearest whole number, in its lowest 16 bits; of numbers from 0 to 65535, and 0 of what is none.
    fn whole_bits(self) -> u32;
}

impl Whole for f32 {
    #[inline(always)]
    fn whole_bits(self) -> u32 {
        // A float from 2^23 on is whole, and its last bits are what is above 2^23.
        (self + 8_388_608.0).to_bits()
    }
}

#[cfg(test)]
mod forced {
    use super::Level;
    use std::cell::Cell;

    thread_local!(static FORCED: Cell<Option<Level>> = const { Cell::new(None) });

    pub(super) fn level() -> Option<Level> {
        FORCED.get()
    }

    pub(super) fn with<R>(level: Level, work: impl FnOnce() -> R) -> R {
        let before = FORCED.replace(Some(level));
        let result = work();
        FORCED.set(before);
        result
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sum whose bits show whether it was rearranged, or a product and a sum were made one operation.
    struct Sum<'a>(&'a [f32]);

    impl Work for Sum<'_> {
        type Output = [u32; 16];

        #[inline(always)]
        fn run(self) -> [u32; 16] {
            let mut sums = [0.1_f32; 16];
            for some in self.0.as_chunks::<16>().0 {
                for k in 0..16 {
                    sums[k] += some[k] * 1.1 / (0.3 + some[k]);
                }
            }
            sums.map(f32::to_bits)
        }
    }

    #[test]
    fn the_widest_vectors_change_no_bit() {
        let numbers: Vec<f32> = (0..1600_u16).map(|i| (f32::from(i) * 0.37).fract()).collect();
        let plain = Sum(&numbers).run();
        assert_eq!(widest(Sum(&numbers)), plain);
        for level in Level::all() {
            assert_eq!(widest_by(level, Sum(&numbers)), plain, "{level:?}");
        }
    }
}
