//! What is wrong with annotations.

use std::collections::BTreeSet;
use std::fmt;

/// Letters of a cause; it may hold texts of others, of any length.
const MOST_LETTERS: usize = 300;

/// An annotation, or an image it speaks of, is not as it should be.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// The file within the dataset, with a line or what else tells the place in it.
    pub place: String,
    /// What is wrong, in words.
    pub cause: String,
    /// The image it is about; none where there is no such image, or it is not in the dataset.
    pub sample: Option<String>,
}

impl Fault {
    pub(super) fn new(place: impl Into<String>, cause: impl Into<String>) -> Self {
        Self { place: place.into(), cause: short(cause.into()), sample: None }
    }

    /// The fault as one of a sample.
    pub(super) fn of(self, key: &str) -> Self {
        Self { sample: Some(key.to_owned()), ..self }
    }
}

/// A text that can be printed, be it cut.
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

/// What is wrong with the annotations of a dataset: the first faults in words, all of them counted, for a file of
/// some megabytes can be wrong in millions of places.
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

    /// The first ones, in the order in which they were found; at most [`Faults::KEPT`].
    pub fn first(&self) -> &[Fault] {
        &self.first
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Whether one is about the image of this key.
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
