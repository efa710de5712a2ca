//! The two-term exponential of the paper.

use super::tables::Tables;

/// Eq. 3 of the AquaFuse paper, `d = μ0 + μ1 e^(μ2 R) + μ3 e^(μ4 M)` with `M = max(G, B)`.
///
/// `R` and `M` are **encoded** values in `[0, 1]`: the coefficients belong to them.
///
/// The paper prints no μ. [`Eq3::OURS`], the default, has d(R = 1, M = 0) = 0 and d(0, 1) = 1, nothing clips
/// between, and depth falls with R and rises with M.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eq3 {
    /// μ0 to μ4, in the paper's order.
    pub mu: [f64; 5],
}

/// Coefficients that make no depth.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Eq3Error {
    /// A coefficient is no number, or a term larger than the tables hold.
    #[error("its terms reach {largest}; they must be numbers, at most {most}")]
    TooLarge {
        /// The largest term over the colour range.
        largest: f64,
        /// The most there may be.
        most: f64,
    },
    /// Depth would rise with R or fall with M.
    #[error("depth must not rise with red nor fall with max(G, B): μ1 μ2 <= 0 and μ3 μ4 >= 0")]
    Unlawful,
}

/// Terms up to this size, 64 times the range of depth, add up without overflow in fixed point.
const LARGEST_TERM: f64 = 64.0;

impl Default for Eq3 {
    fn default() -> Self {
        Self::OURS
    }
}

impl Eq3 {
    /// Our coefficients: round numbers for μ2 and μ4, and the others such that depth spans `[0, 1]`.
    ///
    /// `aquafuse fit PAIRS -o MODEL.toml --depth-kind metres --target order` on seven pairs of FLSea (Randall and
    /// Treibitz 2023) gives 0.540017, 0.528906, -6.56, -0.540766, -2.06, and orders those pairs no better (mean
    /// Spearman by place .81, ours .80).
    pub const OURS: Self = Self { mu: [0.556_495, 0.518_993, -6.0, -0.557_781, -2.0] };

    /// A model of these coefficients, μ0 to μ4.
    ///
    /// # Errors
    ///
    /// [`Eq3Error`] when depth would rise with R or fall with M, or a term is no number or too large.
    ///
    /// # Examples
    ///
    /// ```
    /// use aquafuse::depth::Eq3;
    ///
    /// assert_eq!(Eq3::new(Eq3::OURS.mu), Ok(Eq3::OURS));
    /// assert!(Eq3::new([0.5, -0.5, -6.0, -0.5, -2.0]).is_err());
    /// ```
    pub fn new(mu: [f64; 5]) -> Result<Self, Eq3Error> {
        let [mu0, mu1, mu2, mu3, mu4] = mu;
        let terms = [mu0, mu1, mu3, mu0 + mu1 * mu2.exp(), mu3 * mu4.exp()];
        let largest =
            terms.iter().fold(0.0, |most: f64, term| if term.abs() <= most { most } else { term.abs() });
        // A NaN is not within the bound either.
        if !(largest <= LARGEST_TERM && mu.iter().all(|mu| mu.is_finite())) {
            return Err(Eq3Error::TooLarge { largest, most: LARGEST_TERM });
        }
        if mu1 * mu2 > 0.0 || mu3 * mu4 < 0.0 {
            return Err(Eq3Error::Unlawful);
        }
        Ok(Self { mu })
    }

    /// Depth of one colour before clipping, by the equation as it stands.
    pub fn depth(&self, red: f64, max_green_blue: f64) -> f64 {
        let [mu0, mu1, mu2, mu3, mu4] = self.mu;
        mu0 + mu1 * (mu2 * red).exp() + mu3 * (mu4 * max_green_blue).exp()
    }

    pub(super) fn tables(&self) -> Tables {
        let [mu0, mu1, mu2, mu3, mu4] = self.mu;
        Tables::of_terms(|red| mu0 + mu1 * (mu2 * red).exp(), |max| mu3 * (mu4 * max).exp())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_two_ends_of_the_colour_range_are_the_two_ends_of_depth() {
        assert!(Eq3::OURS.depth(1.0, 0.0).abs() < 1e-6);
        assert!((Eq3::OURS.depth(0.0, 1.0) - 1.0).abs() < 1e-6);
        let tables = Eq3::OURS.tables();
        assert_eq!((tables.level(255, 0), tables.level(0, 255)), (0, 255));
    }

    #[test]
    fn coefficients_that_make_no_depth_are_refused() {
        let with = |i: usize, value: f64| {
            let mut mu = Eq3::OURS.mu;
            mu[i] = value;
            Eq3::new(mu)
        };
        assert!((0..5).all(|i| matches!(with(i, f64::NAN), Err(Eq3Error::TooLarge { .. }))));
        assert!((0..5).all(|i| matches!(with(i, f64::INFINITY), Err(Eq3Error::TooLarge { .. }))));
        assert!(matches!(with(1, 1e6), Err(Eq3Error::TooLarge { .. })));
        assert_eq!((with(1, -0.5), with(4, 2.0)), (Err(Eq3Error::Unlawful), Err(Eq3Error::Unlawful)));
    }

    #[test]
    fn the_tables_equal_the_equation_rounded() {
        let tables = Eq3::OURS.tables();
        for (red, max) in (0..=255_u8).flat_map(|red| (0..=255_u8).map(move |max| (red, max))) {
            let exact = 255.0 * Eq3::OURS.depth(f64::from(red) / 255.0, f64::from(max) / 255.0);
            let off_the_half = (exact - exact.floor() - 0.5).abs() > 1e-4;
            assert!(!off_the_half || f64::from(tables.level(red, max)) == exact.clamp(0.0, 255.0).round());
        }
    }
}
