//! The differences of settings, in words.

use serde_json::Value;

/// Differences that are named.
const NAMED: usize = 4;
/// Settings of many numbers, which would say nothing one by one.
const WHOLE: [&str; 2] = ["water", "reference"];

/// Where two settings differ, in words: names with the value that was and the one that is asked for.
pub(crate) fn differences(was: &Value, is: &Value) -> String {
    let mut found = Vec::new();
    compare("", was, is, &mut found);
    let more = match found.len().saturating_sub(NAMED) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    found.truncate(NAMED);
    found.join(", ") + &more
}

fn compare(name: &str, was: &Value, is: &Value, found: &mut Vec<String>) {
    match (was, is) {
        _ if was == is => {}
        _ if was.is_object() && WHOLE.contains(&name.rsplit('.').next().unwrap_or_default()) => {
            found.push(format!("{name} is another one"));
        }
        (Value::Object(was), Value::Object(is)) => {
            let mut names: Vec<&String> = was.keys().chain(is.keys()).collect();
            names.sort();
            names.dedup();
            for inner in names {
                let value = |of: &serde_json::Map<String, Value>| of.get(inner).cloned().unwrap_or_default();
                let full = if name.is_empty() { inner.clone() } else { format!("{name}.{inner}") };
                compare(&full, &value(was), &value(is), found);
            }
        }
        _ => found.push(format!("{name} was {}, is {}", short(was), short(is))),
    }
}

/// A value as text, not longer than fits into a message.
fn short(value: &Value) -> String {
    const MOST: usize = 40;
    let text = value.to_string();
    match text.char_indices().nth(MOST) {
        Some((at, _)) => format!("{}...", text.get(..at).unwrap_or_default()),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn what_differs_is_named_with_both_values() {
        let was = json!({"a": 1, "b": {"c": "x", "d": [1, 2]}, "e": true});
        let is = json!({"a": 1, "b": {"c": "y", "d": [1, 2]}, "f": 2});
        assert_eq!(differences(&was, &is), "b.c was \"x\", is \"y\", e was true, is null, f was null, is 2");
        assert_eq!(differences(&was, &was), "");
        let waters = [1, 2].map(|beta| json!({"use": {"water": {"beta": beta, "veil": [beta, 0]}}}));
        assert_eq!(differences(&waters[0], &waters[1]), "use.water is another one");
        let long = differences(&json!({"w": vec![0; 99]}), &json!({"w": 1}));
        assert!(long.len() < 80 && long.contains("..."), "{long}");
    }
}
