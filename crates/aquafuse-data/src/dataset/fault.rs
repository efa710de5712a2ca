//! Faults of annotations.

use std::collections::BTreeSet;
use std::fmt;

use crate::files::one_line;

/// Most letters of a cause, which may quote foreign strings of any length.
const MOST_LETTERS: usize = 300;

/// A fault of an annotation, or of an image that it names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// The file within the dataset, with the line or position in it.
    pub place: String,
    /// The cause, in words.
    pub cause: String,
    /// The image it is about; `None` if the dataset has no such image.
    pub sample: Option<String>,
}

impl Fault {
    pub(super) fn new(place: impl Into<String>, cause: impl Into<String>) -> Self {
        Self { place: one_line(&place.into()), cause: one_line(&short(cause.into())), sample: None }
    }

    /// The fault as one of a sample.
    pub(super) fn of(self, key: &str) -> Self {
        Self { sample: Some(key.to_owned()), ..self }
    }
}

/// A string that can be printed, cut if it is long.
fn short(mut text: String) -> String {
    if let Some((end, _)) = text.char_indices().nth(MOST_LETTERS) {
        text.truncate(end);
        text.push('…');
    }
    text
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.cause)
    }
}

/// The faults of the annotations of a dataset. Only the first ones are kept in words, because a file of some megabytes
/// can have millions of faults; all are counted.
#[derive(Clone, Debug, Default)]
pub struct Faults {
    first: Vec<Fault>,
    count: usize,
    samples: BTreeSet<String>,
}

impl Faults {
    /// Faults that are kept in words.
    pub const KEPT: usize = 100;

    pub(super) fn add(&mut self, fault: Fault) {
        self.count = self.count.saturating_add(1);
        if let Some(key) = fault.sample.as_ref().filter(|key| !self.samples.contains(*key)) {
            self.samples.insert(key.clone());
        }
        if self.first.len() < Self::KEPT {
            self.first.push(fault);
        }
    }

    /// The first faults, in the order in which they were found; at most [`Faults::KEPT`].
    pub fn first(&self) -> &[Fault] {
        &self.first
    }

    /// The number of all faults.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Whether there are no faults.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Whether a fault is about the image of this key.
    pub fn concern(&self, key: &str) -> bool {
        self.samples.contains(key)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_are_counted_and_the_first_are_kept_in_words() {
        let mut faults = Faults::default();
        for number in 0..Faults::KEPT + 5 {
            faults.add(Fault::new(format!("a.txt:{number}"), "ä".repeat(1_000)).of(&format!("{number}.jpg")));
        }
        assert_eq!((faults.first().len(), faults.count()), (Faults::KEPT, Faults::KEPT + 5));
        assert!(faults.concern("0.jpg") && faults.concern("104.jpg") && !faults.concern("105.jpg"));
        assert_eq!(faults.first()[7].cause, format!("{}…", "ä".repeat(MOST_LETTERS)));
    }
}
