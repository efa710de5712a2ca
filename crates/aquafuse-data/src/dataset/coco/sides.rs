//! The numbers of a box: four are kept, however many there are.

use std::fmt;

use serde::de::{Deserialize, Deserializer, SeqAccess, Visitor};

/// A box: left, top, width, height, if there are four numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Sides {
    pub(super) first: [f64; 4],
    /// How many numbers there are.
    pub(super) count: usize,
}

impl<'de> Deserialize<'de> for Sides {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Numbers;
        impl<'de> Visitor<'de> for Numbers {
            type Value = Sides;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a list of numbers")
            }

            fn visit_seq<S: SeqAccess<'de>>(self, mut list: S) -> Result<Sides, S::Error> {
                let mut sides = Sides::default();
                while let Some(number) = list.next_element()? {
                    if let Some(side) = sides.first.get_mut(sides.count) {
                        *side = number;
                    }
                    sides.count = sides.count.saturating_add(1);
                }
                Ok(sides)
            }
        }
        from.deserialize_seq(Numbers)
    }
}
