//! Chance keyed on names: what is drawn for an image does not depend on the others, nor on who draws it.

/// SplitMix64 from a seed and names.
#[derive(Clone, Debug)]
pub(crate) struct Chance(u64);

/// Of FNV-1a.
const BASIS: u64 = 0xcbf2_9ce4_8422_2325;
const PRIME: u64 = 0x0000_0100_0000_01b3;

impl Chance {
    /// The same numbers for the same seed and the same names in their order.
    pub(crate) fn keyed(seed: u64, names: &[&str]) -> Self {
        let absorb = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(PRIME);
        // No name holds a zero byte, so that `a, b` is not `ab`.
        let hash = names.iter().fold(BASIS, |hash, name| absorb(name.bytes().fold(hash, absorb), 0));
        let mut chance = Self(hash ^ seed.wrapping_mul(0x9E37_79B9_7F4A_7C15));
        // Once round, so that neighbouring seeds have nothing in common.
        chance.0 = chance.number();
        chance
    }

    /// Any number.
    pub(crate) fn number(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut x = self.0;
        x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        x ^ (x >> 31)
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
