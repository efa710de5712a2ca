//! Eq. 3 in the form in which the laws hold for every choice of its three parameters.

use crate::depth::Eq3;

/// Least and largest μ2 and μ4. At -20 a term is over within a fifth of the range, at 5 it begins in the last
/// fifth: beyond, the data of a few colours decide, and the curve is a step.
pub(super) const STEEPEST: [f64; 2] = [-20.0, 5.0];
/// Nearer to 0 a term is a line and its two coefficients grow without bound, cancelling each other: fitted to
/// the labels of a linear regressor, |μ1| would reach 1e6. Here it stays below 20.1.
const STRAIGHTEST: f64 = 0.05;

/// `d = w g_μ2(R) + (1 - w) h_μ4(M)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Terms {
    /// w, in `[0, 1]`.
    pub(super) weight_of_red: f64,
    /// μ2 and μ4.
    pub(super) exponents: [f64; 2],
}

/// An exponent within the bounds.
pub(super) fn bounded(exponent: f64) -> f64 {
    let exponent = exponent.clamp(STEEPEST[0], STEEPEST[1]);
    match exponent.abs() < STRAIGHTEST {
        true if exponent > 0.0 => STRAIGHTEST,
        true => -STRAIGHTEST,
        false => exponent,
    }
}

impl Terms {
    /// The coefficients of Eq. 3.
    pub(super) fn eq3(&self) -> Eq3 {
        let ([mu2, mu4], w) = (self.exponents, self.weight_of_red);
        let mu1 = w / (1.0 - mu2.exp());
        let mu3 = -(1.0 - w) / (1.0 - mu4.exp());
        // Depth is 0 where R = 1 and M = 0.
        Eq3 { mu: [-mu1 * mu2.exp() - mu3, mu1, mu2, mu3, mu4] }
    }
}

/// One term at 257 even places, read between them by a line.
pub(super) struct Table([f32; 257]);

impl Table {
    /// g: 1 at 0, 0 at 1.
    pub(super) fn falling(exponent: f64) -> Self {
        let end = exponent.exp();
        Self(std::array::from_fn(|i| (((exponent * i as f64 / 256.0).exp() - end) / (1.0 - end)) as f32))
    }

    /// h: 0 at 0, 1 at 1.
    pub(super) fn rising(exponent: f64) -> Self {
        let falling = Self::falling(exponent);
        Self(falling.0.map(|value| 1.0 - value))
    }

    #[inline]
    pub(super) fn at(&self, value: f32) -> f32 {
        let place = value * 256.0;
        let before = (place as usize).min(255);
        let (low, high) = (self.0[before], self.0[before + 1]);
        low + (high - low) * (place - before as f32)
    }
}
