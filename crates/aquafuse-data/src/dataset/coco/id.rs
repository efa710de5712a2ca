//! Ids: whole numbers, with a point or without, or strings.

use std::fmt;

use serde_json::value::RawValue;

/// An id. 7 and 7.0 are one; 7 and "7" are two.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Id<'a> {
    Number(i64),
    /// A string, as it stands.
    Text(&'a str),
}

impl<'a> Id<'a> {
    /// The id that a value is; why it is none otherwise.
    pub(crate) fn of(raw: &'a RawValue) -> Result<Self, String> {
        let said = raw.get();
        if said.starts_with('"') {
            return Ok(Self::Text(said));
        }
        if let Ok(number) = said.parse() {
            return Ok(Self::Number(number));
        }
        let short: String = said.chars().take(20).collect();
        let must = |what: String| Err(format!("the id is {short}, but must be {what}"));
        match said.parse::<f64>() {
            Ok(number) if number.fract() == 0.0 => match whole(number) {
                Some(number) => Ok(Self::Number(number)),
                None => must(format!("from {} to {}", i64::MIN, i64::MAX)),
            },
            _ => must("a whole number or a string".to_owned()),
        }
    }

    /// A number that is not less than this one's; of a string that is none, 0.
    pub(crate) fn number(&self) -> i64 {
        match self {
            Self::Number(number) => *number,
            Self::Text(text) => text.trim_matches('"').parse().unwrap_or(0),
        }
    }

    /// Another id of the same kind, as it is written.
    pub(crate) fn another(&self, number: i64) -> String {
        match self {
            Self::Number(_) => number.to_string(),
            Self::Text(_) => format!("\"{number}\""),
        }
    }
}

/// A float as a whole number, where every smaller one is exact too.
fn whole(number: f64) -> Option<i64> {
    const EXACT: f64 = 9_007_199_254_740_992.0;
    (number.abs() <= EXACT).then(|| format!("{number:.0}").parse().ok())?
}

impl fmt::Display for Id<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => number.fmt(f),
            Self::Text(text) => f.write_str(text),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_numbers_or_strings() {
        let raw = |text: &str| RawValue::from_string(text.to_owned()).unwrap();
        assert_eq!(Id::of(&raw("7")), Id::of(&raw("7.0")));
        assert_eq!(Id::of(&raw("1e3")), Ok(Id::Number(1_000)));
        let text = raw("\"7\"");
        let text = Id::of(&text).unwrap();
        assert_ne!(Ok(text), Id::of(&raw("7")));
        assert_eq!((text.number(), text.another(8)), (7, "\"8\"".to_owned()));
        assert!(
            Id::of(&raw("9223372036854775808")).unwrap_err().contains("must be from -9223372036854775808 to")
        );
        for wrong in ["7.5", "null", "[7]", "true"] {
            assert!(Id::of(&raw(wrong)).unwrap_err().contains("a whole number or a string"), "{wrong}");
        }
    }
}
