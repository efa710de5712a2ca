//! The two-term exponential of the paper: depth from red and the stronger of green and blue.

use super::{DepthMap, median};
use crate::image::{Image, Sample};

/// Eq. 3 of the AquaFuse paper, `d = μ0 + μ1 e^(μ2 R) + μ3 e^(μ4 M)` with `M = max(G, B)`.
///
/// `R` and `M` are **encoded** values in `[0, 1]`, read to 8 bits: the coefficients belong to them. The
/// result is clipped to `[0, 1]` and has 256 levels; 0 is near.
///
/// The paper prints no μ. [`Eq3::default`] holds ours: d(R = 1, M = 0) = 0 and d(0, 1) = 1, nothing
/// clips between, and depth falls with R and rises with M. It fails where red is dead (everything looks far),
/// on red things far away, and on green or blue things near by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eq3 {
    /// μ0 to μ4, in the paper's order.
    pub mu: [f64; 5],
}

impl Default for Eq3 {
    fn default() -> Self {
        Self { mu: [0.556_495, 0.518_993, -6.0, -0.557_781, -2.0] }
    }
}

/// Fractional bits of the level tables: the sum of two entries keeps the rounding of one exact sum.
const FRACTION: u32 = 16;

impl Eq3 {
    /// Depth of one colour before clipping, by the equation as it stands.
    pub fn depth(&self, red: f64, max_green_blue: f64) -> f64 {
        let [mu0, mu1, mu2, mu3, mu4] = self.mu;
        mu0 + mu1 * (mu2 * red).exp() + mu3 * (mu4 * max_green_blue).exp()
    }

    /// Depth of a picture: the equation at each pixel, then the paper's 7x7 median.
    pub fn estimate<T: Sample>(&self, image: &Image<T>) -> DepthMap {
        let (width, height) = image.size();
        let levels = median::median_7x7(width, height, &self.levels(image));
        DepthMap::from_levels(width, height, levels).expect("one level a pixel")
    }

    /// Depth of a picture pixel by pixel, before the median.
    pub fn estimate_unfiltered<T: Sample>(&self, image: &Image<T>) -> DepthMap {
        let (width, height) = image.size();
        DepthMap::from_levels(width, height, self.levels(image)).expect("one level a pixel")
    }

    /// The equation is a sum of a term in R and a term in M: two tables of 256 and no exponential a pixel.
    fn levels<T: Sample>(&self, image: &Image<T>) -> Vec<u8> {
        let [mu0, mu1, mu2, mu3, mu4] = self.mu;
        let entry = |term: f64| (term * 255.0 * f64::from(1 << FRACTION)).round() as i32;
        let table = |term: &dyn Fn(f64) -> f64| -> [i32; 256] {
            std::array::from_fn(|byte| entry(term(byte as f64 / 255.0)))
        };
        let of_red = table(&|red| mu0 + mu1 * (mu2 * red).exp());
        let of_max = table(&|max| mu3 * (mu4 * max).exp());
        let half = 1 << (FRACTION - 1);
        let level = |&[r, g, b]: &[T; 3]| {
            let max = g.to_byte().max(b.to_byte());
            let sum = of_red[usize::from(r.to_byte())].saturating_add(of_max[usize::from(max)]);
            (sum.saturating_add(half) >> FRACTION).clamp(0, 255) as u8
        };
        image.pixels().iter().map(level).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn levels_of(pixels: &[[u8; 3]]) -> Vec<u8> {
        let image = Image::<u8>::from_raw(pixels.len(), 1, pixels.concat()).unwrap();
        Eq3::default().levels(&image)
    }

    #[test]
    fn the_two_ends_of_the_colour_range_are_the_two_ends_of_depth() {
        let eq3 = Eq3::default();
        assert!(eq3.depth(1.0, 0.0).abs() < 1e-6);
        assert!((eq3.depth(0.0, 1.0) - 1.0).abs() < 1e-6);
        assert_eq!(levels_of(&[[255, 0, 0], [0, 255, 0], [0, 0, 255]]), [0, 255, 255]);
    }

    #[test]
    fn the_tables_equal_the_equation_rounded() {
        let eq3 = Eq3::default();
        for red in 0..=255_u8 {
            let row: Vec<[u8; 3]> = (0..=255).map(|m| [red, m, m / 2]).collect();
            for (m, level) in levels_of(&row).into_iter().enumerate() {
                let exact = 255.0 * eq3.depth(f64::from(red) / 255.0, m as f64 / 255.0);
                let off_the_half = (exact - exact.floor() - 0.5).abs() > 1e-4;
                assert!(!off_the_half || f64::from(level) == exact.clamp(0.0, 255.0).round());
            }
        }
    }

    proptest! {
        #[test]
        fn depth_never_rises_with_red(r in 0..255_u8, g: u8, b: u8) {
            let levels = levels_of(&[[r, g, b], [r + 1, g, b]]);
            prop_assert!(levels[0] >= levels[1]);
        }

        #[test]
        fn depth_never_falls_with_green_or_blue(r: u8, g in 0..255_u8, b in 0..255_u8) {
            let levels = levels_of(&[[r, g, b], [r, g + 1, b], [r, g, b + 1]]);
            prop_assert!(levels[0] <= levels[1] && levels[0] <= levels[2]);
        }

        #[test]
        fn green_and_blue_are_interchangeable(r: u8, g: u8, b: u8) {
            let levels = levels_of(&[[r, g, b], [r, b, g]]);
            prop_assert_eq!(levels[0], levels[1]);
        }
    }
}
