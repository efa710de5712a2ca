//! How many classes a dataset of YOLO has.

use super::super::tree::Tree;
use super::split;
use crate::files::FileError;

/// Whether a text of YAML says what classes there are.
pub(super) fn are_named(text: &str) -> bool {
    text.lines().any(|line| line.starts_with("names:") || line.starts_with("nc:"))
}

/// The number of classes, if a file at the top says it: the most that one says.
pub(super) fn count<'a>(
    tree: &Tree,
    paths: impl Iterator<Item = &'a &'a String>,
) -> Result<Option<usize>, FileError> {
    let mut most = None;
    for path in paths.filter(|path| split(path).0.is_empty()) {
        let Some(text) = tree.read(path)? else { continue };
        let found = match path.rsplit_once('.') {
            Some((_, "yaml" | "yml")) => of_config(&text),
            Some((_, "txt" | "names" | "labels")) => {
                Some(text.lines().filter(|line| !line.trim().is_empty()).count())
            }
            _ => None,
        };
        most = most.max(found.filter(|count| *count > 0));
    }
    Ok(most)
}

/// The number of classes of a configuration: what it says, or what it names in one of the common ways.
pub(super) fn of_config(text: &str) -> Option<usize> {
    let after = |word: &str| text.lines().find_map(|line| line.strip_prefix(word));
    let plain = |line: &str| line.split('#').next().unwrap_or_default().trim().to_owned();
    if let Some(number) = after("nc:") {
        return plain(number).parse().ok();
    }
    let named = plain(after("names:")?);
    if let Some(list) = named.strip_prefix('[') {
        let list = list.strip_suffix(']')?;
        return (!list.contains(['"', '\'']))
            .then(|| list.split(',').filter(|name| !name.trim().is_empty()).count());
    }
    let below = text.lines().skip_while(|line| !line.starts_with("names:")).skip(1);
    let items = below.map(plain).take_while(|line| !line.is_empty());
    // A list, or numbers with names.
    let places = items.zip(0_usize..).map_while(|(line, place)| match line.split_once(':') {
        _ if line.starts_with("- ") => Some(place),
        Some((number, _)) => number.parse().ok(),
        None => None,
    });
    Some(places.max()?.saturating_add(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_configuration_may_say_the_number_of_classes() {
        assert_eq!(of_config("train: images\nnc: 3  # fish\nnames: [a, b, c]"), Some(3));
        assert_eq!(of_config("names: [a, b, c]"), Some(3));
        assert_eq!(of_config("names: ['a, b', c]"), None);
        assert_eq!(of_config("names:\n- a\n- b\ntrain: x"), Some(2));
        assert_eq!(of_config("names:\n  0: a\n  7: b # last\n\n"), Some(8));
        assert_eq!(of_config("names:\n"), None);
    }
}
