//! A JSON object as it stands: its names in their order, its values as texts.

use std::fmt;

use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};
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
