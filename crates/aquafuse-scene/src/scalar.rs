//! The two kinds of numbers a scene is computed in: `f32` to work, `f64` to prove gradients.

use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// `f32` or `f64`.
///
/// Everything from projection to loss is written once for both: the code that trains in `f32` is the code whose gradients
/// are compared with finite differences in `f64`.
pub trait Scalar:
    Copy
    + Debug
    + Default
    + PartialOrd
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + AddAssign
    + Div<Output = Self>
    + Mul<Output = Self>
    + MulAssign
    + Neg<Output = Self>
    + Sub<Output = Self>
    + SubAssign
{
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;

    /// The nearest value to a number.
    fn of(value: f64) -> Self;

    /// The value as a number.
    fn get(self) -> f64;

    /// e to the power of it.
    fn exp(self) -> Self;

    /// Its square root.
    fn sqrt(self) -> Self;

    /// e^x for x <= 0, in arithmetic that the compiler makes vectors of: `f32` within (4 + |x|) 1e-7 of the true value,
    /// relatively, down to e^-87, and not less below; `f64` exact.
    fn falloff(self) -> Self;

    /// The larger one.
    #[inline(always)]
    fn at_least(self, other: Self) -> Self {
        if self > other { self } else { other }
    }

    /// The smaller one.
    #[inline(always)]
    fn at_most(self, other: Self) -> Self {
        if self < other { self } else { other }
    }

    /// Its distance from 0.
    #[inline(always)]
    fn magnitude(self) -> Self {
        if self < Self::ZERO { -self } else { self }
    }

    /// 1 / (1 + e^-x).
    #[inline]
    fn sigmoid(self) -> Self {
        Self::ONE / (Self::ONE + (-self).exp())
    }
}

impl Scalar for f32 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;

    #[inline(always)]
    fn of(value: f64) -> Self {
        value as f32
    }

    #[inline(always)]
    fn get(self) -> f64 {
        f64::from(self)
    }

    #[inline]
    fn exp(self) -> Self {
        f32::exp(self)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        f32::sqrt(self)
    }

    #[inline(always)]
    fn falloff(self) -> Self {
        // Adding 1.5 · 2^23 rounds to a whole number and leaves it in the low bits.
        const SHIFT: f32 = 12_582_912.0;
        const LEAST: f32 = -126.0;
        let binary = self * std::f32::consts::LOG2_E;
        let binary = if binary > LEAST { binary } else { LEAST };
        let shifted = binary + SHIFT;
        let rest = binary - (shifted - SHIFT);
        // 2^rest on [-1/2, 1/2]: 1 + rest q(rest), q through (2^r - 1) / r at the five Chebyshev nodes; 2e-7 off at most.
        // Summed in pairs, which wait less for one another.
        let [a, b, c, d, e] =
            [std::f32::consts::LN_2, 0.240_223_5, 0.055_503_81, 0.009_666_368, 0.001_338_13];
        let square = rest * rest;
        let power = 1.0 + rest * ((a + b * rest) + square * ((c + d * rest) + e * square));
        let whole = shifted.to_bits().wrapping_sub(SHIFT.to_bits());
        power * f32::from_bits(whole.wrapping_add(127) << 23)
    }
}

impl Scalar for f64 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;

    #[inline(always)]
    fn of(value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn get(self) -> f64 {
        self
    }

    #[inline]
    fn exp(self) -> Self {
        f64::exp(self)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }

    #[inline(always)]
    fn falloff(self) -> Self {
        f64::exp(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_falloff_is_the_exponential() {
        for step in 0..8700_u16 {
            let x = -0.01 * f64::from(step);
            let (found, true_value) = (f32::of(x).falloff().get(), f32::of(x).get().exp());
            assert!((found / true_value - 1.0).abs() < 1e-7 * (4.0 - x), "{x}: {found} {true_value}");
        }
        assert_eq!(0.0_f32.falloff(), 1.0);
        assert!((-1e9_f32).falloff() < 1e-37);
    }
}
