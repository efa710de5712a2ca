//! What is wrong with annotations.

use std::fmt;

/// An annotation, or a picture it speaks of, is not as it should be.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// The file within the data set, with a line or what else tells the place in it.
    pub place: String,
    /// What is wrong, in words.
    pub cause: String,
    /// The picture it is about; none where there is no such picture, or it is not in the data set.
    pub sample: Option<String>,
}

impl Fault {
    pub(super) fn new(place: impl Into<String>, cause: impl Into<String>) -> Self {
        Self { place: place.into(), cause: cause.into(), sample: None }
    }

    /// The fault as one of a sample.
    pub(super) fn of(self, key: &str) -> Self {
        Self { sample: Some(key.to_owned()), ..self }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.cause)
    }
}
