//! Chance keyed on names: what is drawn for an image does not depend on the others, nor on who draws it.

use aquafuse::random::{FNV_BASIS, GOLDEN, fnv, split_mix};

/// SplitMix64 from a seed and names.
#[derive(Clone, Debug)]
pub(crate) struct Chance(u64);

impl Chance {
    /// The same numbers for the same seed and the same names in their order.
    pub(crate) fn keyed(seed: u64, names: &[&str]) -> Self {
        // No name holds a zero byte, so that `a, b` is not `ab`.
        let hash = names.iter().fold(FNV_BASIS, |hash, name| fnv(name.bytes().fold(hash, fnv), 0_u8));
        let mut chance = Self(hash ^ seed.wrapping_mul(GOLDEN));
        // Once round, so that neighbouring seeds have nothing in common.
        chance.0 = chance.number();
        chance
    }

    /// Any number.
    pub(crate) fn number(&mut self) -> u64 {
        split_mix(&mut self.0)
    }

    /// One of `things`, each as likely.
    pub(crate) fn pick<'a, T>(&mut self, things: &'a [T]) -> Option<&'a T> {
        let at = self.number().checked_rem(things.len() as u64)?;
        things.get(usize::try_from(at).ok()?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seed_and_names_decide_and_nothing_else() {
        let first = |seed, names: &[&str]| Chance::keyed(seed, names).number();
        assert_eq!(first(7, &["a", "b"]), first(7, &["a", "b"]));
        let others =
            [first(8, &["a", "b"]), first(7, &["b", "a"]), first(7, &["ab"]), first(7, &["a", "b", ""])];
        assert!(others.iter().all(|&other| other != first(7, &["a", "b"])));
    }

    #[test]
    fn each_thing_is_picked_about_as_often() {
        let mut chance = Chance::keyed(1, &[]);
        let mut counts = [0_u32; 5];
        (0..10_000).for_each(|_| counts[*chance.pick(&[0_usize, 1, 2, 3, 4]).unwrap()] += 1);
        assert!(counts.iter().all(|count| (1800..2200).contains(count)), "{counts:?}");
        assert_eq!(chance.pick::<u8>(&[]), None);
    }
}
