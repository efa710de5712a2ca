//! The depth factor F as a table, for depth that is read off colours.

/// Places of a table at most: one a bin of the estimator.
pub(super) const KNOTS: usize = 32;

/// Depth factor F' of things by depth, where no single exponential follows it: between knots it is a straight line, before
/// the first one that from 1 at z = 0, and beyond the last it stays. It never rises with z.
///
/// Depth from colour says what is farther, not how much farther. [`estimate`](super::estimate) therefore takes from the darkest
/// things of each depth how much backscatter there can be at most; β_B stays the summary. How much of a pixel is no thing but
/// open water is its [`WaterShare`](super::WaterShare) w: `F = (1 - w) F'`.
/// [`Model::Physical`](crate::fusion::Model::Physical) and [`Model::Relight`](crate::fusion::Model::Relight) read it.
///
/// # Examples
///
/// ```
/// use aquafuse::waterbody::DepthFactors;
///
/// let half = DepthFactors::from_knots(&[(0.5, [0.6, 0.8, 0.7]), (1.0, [0.0; 3])]).expect("z rises, F is in [0, 1]");
/// assert_eq!(half.at(0.0), [1.0; 3]);
/// assert_eq!(half.at(0.5), [0.6, 0.8, 0.7]);
/// assert!((half.at(0.75)[1] - 0.4).abs() < 1e-6);
/// assert_eq!(half.at(9.0), [0.0; 3]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthFactors {
    /// Rising; the last knot fills what is left.
    z: [f32; KNOTS],
    factors: [[f32; 3]; KNOTS],
}

impl DepthFactors {
    /// The table through these knots `(z, F)`; none unless there are 1 to 32 of them, z is above 0 and rises, and F lies in
    /// `[0, 1]` and nowhere rises.
    pub fn from_knots(knots: &[(f32, [f32; 3])]) -> Option<Self> {
        let &(last, factor) = knots.last()?;
        let rises = knots.windows(2).all(|pair| pair[0].0 < pair[1].0);
        let falls = knots.windows(2).all(|pair| (0..3).all(|c| pair[1].1[c] <= pair[0].1[c]));
        let are_factors =
            knots.iter().flat_map(|(_, factor)| factor).all(|factor| (0.0..=1.0).contains(factor));
        if knots.len() > KNOTS || !rises || !falls || !are_factors || knots[0].0 <= 0.0 || !last.is_finite() {
            return None;
        }
        let mut table = Self { z: [last; KNOTS], factors: [factor; KNOTS] };
        for (i, &(z, factor)) in knots.iter().enumerate() {
            (table.z[i], table.factors[i]) = (z, factor);
        }
        Some(table)
    }

    /// F of red, green and blue at one distance.
    pub fn at(&self, z: f32) -> [f32; 3] {
        self.before(self.z.partition_point(|&knot| knot < z), z)
    }

    /// The same at one distance after another, none nearer than the one before: knots are passed once.
    pub(crate) fn rising(&self) -> impl FnMut(f32) -> [f32; 3] {
        let mut after = 0;
        move |z| {
            after += self.z[after..].iter().take_while(|&&knot| knot < z).count();
            self.before(after, z)
        }
    }

    /// F at a distance that lies before this knot and not before the last one.
    fn before(&self, after: usize, z: f32) -> [f32; 3] {
        let (from, before) = match after.checked_sub(1) {
            Some(i) => (self.z[i], self.factors[i]),
            None => (0.0, [1.0; 3]),
        };
        let (Some(&to), Some(factors)) = (self.z.get(after), self.factors.get(after)) else { return before };
        let share = (z - from) / (to - from);
        // Equal knots, and the last of a stretch, to the bit: it must not rise by a rounding.
        std::array::from_fn(|c| (before[c] + share * (factors[c] - before[c])).max(factors[c].min(before[c])))
    }

    /// The same with only this share of what is missing to 1.
    pub(crate) fn faded(mut self, share: f32) -> Self {
        let factors = self.factors.as_flattened_mut();
        factors.iter_mut().for_each(|factor| *factor = 1.0 - share * (1.0 - *factor));
        self
    }

    /// Red is nowhere less than the lesser of green and blue; whether it was anywhere.
    pub(crate) fn hold_red(&mut self) -> bool {
        let mut held = false;
        for [red, green, blue] in &mut self.factors {
            let least = green.min(*blue);
            held |= *red < least;
            *red = red.max(least);
        }
        held
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_rising_depths_and_factors_are_a_table() {
        let refused: [&[(f32, [f32; 3])]; 7] = [
            &[(0.5, [0.5; 3]), (0.6, [0.4, 0.6, 0.4])],
            &[],
            &[(0.0, [0.5; 3])],
            &[(0.5, [0.5; 3]), (0.5, [0.4; 3])],
            &[(0.5, [0.5, 1.1, 0.5])],
            &[(0.5, [0.5, f32::NAN, 0.5])],
            &[(f32::INFINITY, [0.5; 3])],
        ];
        for knots in refused {
            assert_eq!(DepthFactors::from_knots(knots), None, "{knots:?}");
        }
        let many: Vec<_> = (1..=KNOTS + 1).map(|i| (i as f32, [0.5; 3])).collect();
        assert_eq!(DepthFactors::from_knots(&many), None);
        assert!(DepthFactors::from_knots(&many[1..]).is_some());
    }

    #[test]
    fn red_is_held_to_the_others() {
        let mut table = DepthFactors::from_knots(&[(0.5, [0.3, 0.8, 0.7]), (1.0, [0.1, 0.2, 0.4])]).unwrap();
        assert!(table.hold_red());
        assert_eq!((table.at(0.5), table.at(1.0)), ([0.7, 0.8, 0.7], [0.2, 0.2, 0.4]));
        assert!(!table.hold_red());
    }
}
