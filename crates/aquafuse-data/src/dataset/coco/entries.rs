//! JSON as it stands: the fields of an object, the items of a list, each shown as text and none kept; of the numbers of a box
//! four are kept. A list of millions of items of two bytes would take tenfold in memory.

use std::fmt;
use std::io::{self, Write};

use serde::de::{Deserialize, DeserializeSeed, Deserializer, Error as _, MapAccess, SeqAccess, Visitor};
use serde_json::value::RawValue;

use crate::files::one_line;

/// Whoever is shown the fields of an object; what fails there ends it.
type SeeField<'s, 'de> = &'s mut dyn FnMut(&str, &'de RawValue) -> io::Result<()>;
/// Whoever is shown the items of a list, with their numbers from 0.
type SeeItem<'s, 'de> = &'s mut dyn FnMut(usize, &'de RawValue) -> io::Result<()>;

/// Shows each field of the object in `text`.
pub(super) fn fields<'de>(text: &'de str, see: SeeField<'_, 'de>) -> io::Result<()> {
    let mut failed = None;
    let seen = shown(text, Fields(&mut |name, value| keep(see(name, value), &mut failed)));
    failed.map_or(seen, Err)
}

/// Shows each item of the list in `text`.
pub(crate) fn items<'de>(text: &'de str, see: SeeItem<'_, 'de>) -> io::Result<()> {
    let mut failed = None;
    let seen = shown(text, Items(&mut |number, item| keep(see(number, item), &mut failed)));
    failed.map_or(seen, Err)
}

/// Writes the object in `text` with some of its values exchanged; a name that it does not have is not added.
pub(crate) fn write_with(
    text: &str,
    out: &mut dyn Write,
    exchanged: &mut dyn FnMut(&str, &RawValue, &mut dyn Write) -> io::Result<bool>,
) -> io::Result<()> {
    let mut between = "{";
    fields(text, &mut |name, value| {
        write!(out, "{between}{}: ", serde_json::to_string(name)?)?;
        between = ", ";
        match exchanged(name, value, out)? {
            true => Ok(()),
            false => out.write_all(value.get().as_bytes()),
        }
    })?;
    out.write_all(if between == "{" { b"{}" } else { b"}" })
}

/// Keeps an error aside, for the reader of JSON would make a text of it.
fn keep(result: io::Result<()>, failed: &mut Option<io::Error>) -> bool {
    match result {
        Ok(()) => true,
        Err(error) => {
            *failed = Some(error);
            false
        }
    }
}

fn shown<'de>(text: &'de str, seed: impl DeserializeSeed<'de, Value = ()>) -> io::Result<()> {
    let mut reader = serde_json::Deserializer::from_str(text);
    let read = seed.deserialize(&mut reader).and_then(|()| reader.end());
    read.map_err(|error| io::Error::new(io::ErrorKind::InvalidData, one_line(&error.to_string())))
}

struct Fields<'s, 'de>(&'s mut dyn FnMut(&str, &'de RawValue) -> bool);
struct Items<'s, 'de>(&'s mut dyn FnMut(usize, &'de RawValue) -> bool);

impl<'de> DeserializeSeed<'de> for Fields<'_, 'de> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, from: D) -> Result<(), D::Error> {
        from.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for Fields<'_, 'de> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object")
    }

    fn visit_map<M: MapAccess<'de>>(self, mut map: M) -> Result<(), M::Error> {
        while let Some((name, value)) = map.next_entry::<String, _>()? {
            if !(self.0)(&name, value) {
                return Err(M::Error::custom("it was left"));
            }
        }
        Ok(())
    }
}

impl<'de> DeserializeSeed<'de> for Items<'_, 'de> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, from: D) -> Result<(), D::Error> {
        from.deserialize_seq(self)
    }
}

impl<'de> Visitor<'de> for Items<'_, 'de> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list")
    }

    fn visit_seq<S: SeqAccess<'de>>(self, mut list: S) -> Result<(), S::Error> {
        let mut number = 0_usize;
        while let Some(item) = list.next_element()? {
            if !(self.0)(number, item) {
                return Err(S::Error::custom("it was left"));
            }
            number = number.saturating_add(1);
        }
        Ok(())
    }
}

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
