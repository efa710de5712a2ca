//! JSON objects as they stand: names in their order, values as texts; and lists in them, entry by entry.

use std::fmt;

use serde::de::{Deserialize, DeserializeSeed, Deserializer, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde_json::value::RawValue;

/// The entries of an object.
pub(super) struct Entries<'a>(Vec<(String, &'a RawValue)>);

impl<'de> Deserialize<'de> for Entries<'de> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Object;
        impl<'de> Visitor<'de> for Object {
            type Value = Entries<'de>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an object")
            }

            fn visit_map<M: MapAccess<'de>>(self, mut map: M) -> Result<Self::Value, M::Error> {
                let mut entries = Vec::new();
                while let Some(entry) = map.next_entry()? {
                    entries.push(entry);
                }
                Ok(Entries(entries))
            }
        }
        deserializer.deserialize_map(Object)
    }
}

impl Entries<'_> {
    /// The object with some of its values exchanged, as text; a name that it does not have is not added.
    pub(super) fn with(&self, exchanged: &[(&str, &str)]) -> String {
        let entry = |(name, value): &(String, &RawValue)| {
            let other = exchanged.iter().find(|(exchanged, _)| exchanged == name);
            let name = serde_json::to_string(name).expect("a text is JSON");
            format!("{name}: {}", other.map_or(value.get(), |(_, value)| value))
        };
        format!("{{{}}}", self.0.iter().map(entry).collect::<Vec<_>>().join(", "))
    }
}

/// Shows each entry of a list of the object in `text`, with its number, from 0. None is kept: a list of millions of
/// entries of two bytes would take tenfold in memory.
pub(super) fn each<'de>(
    text: &'de str,
    list: &'static str,
    see: &mut dyn FnMut(usize, &'de RawValue),
) -> Result<(), serde_json::Error> {
    let mut reader = serde_json::Deserializer::from_str(text);
    Wanted { list, see }.deserialize(&mut reader)?;
    reader.end()
}

/// The object with the list that is wanted.
struct Wanted<'s, 'de> {
    list: &'static str,
    see: &'s mut dyn FnMut(usize, &'de RawValue),
}

impl<'de> DeserializeSeed<'de> for Wanted<'_, 'de> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for Wanted<'_, 'de> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "an object with the list `{}`", self.list)
    }

    fn visit_map<M: MapAccess<'de>>(self, mut map: M) -> Result<(), M::Error> {
        while let Some(name) = map.next_key::<String>()? {
            if name == self.list {
                map.next_value_seed(List(&mut *self.see))?;
            } else {
                map.next_value::<IgnoredAny>()?;
            }
        }
        Ok(())
    }
}

/// The list itself.
struct List<'s, 'de>(&'s mut dyn FnMut(usize, &'de RawValue));

impl<'de> DeserializeSeed<'de> for List<'_, 'de> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_seq(self)
    }
}

impl<'de> Visitor<'de> for List<'_, 'de> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list")
    }

    fn visit_seq<S: SeqAccess<'de>>(self, mut entries: S) -> Result<(), S::Error> {
        let mut number = 0_usize;
        while let Some(entry) = entries.next_element()? {
            (self.0)(number, entry);
            number = number.saturating_add(1);
        }
        Ok(())
    }
}
