//! What speaks against a fit.

use std::fmt;

use super::terms::{STEEPEST, Terms};

/// A reason not to trust a fit. Displays as a sentence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Doubt {
    /// One term has no weight: depth depends on red alone (`red`), or not at all on it.
    OneTerm {
        /// Whether the term that is left is the one in red.
        red: bool,
    },
    /// A term is as good as a line, so that its two coefficients are large and nearly cancel: the labels
    /// look like those of a linear model of colour, not like measurements.
    Straight {
        /// Whether it is the term in red.
        red: bool,
    },
    /// A term is as steep as it may be: a step that distinguishes only the darkest or the brightest colours.
    Steep {
        /// Whether it is the term in red.
        red: bool,
    },
    /// In these many images depth falls as the model rises.
    Backwards {
        /// Images.
        images: usize,
    },
}

/// Below this exponent a term departs from a line by less than 4 % of its range.
const NEARLY_STRAIGHT: f64 = 0.3;
/// Less weight than this is none.
const NO_WEIGHT: f64 = 0.01;

impl Doubt {
    pub(super) fn about(terms: &Terms, rank_scores: &[f64]) -> Vec<Self> {
        let weights = [terms.weight_of_red, 1.0 - terms.weight_of_red];
        let mut doubts = Vec::new();
        for (term, red) in [true, false].into_iter().enumerate() {
            let exponent = terms.exponents[term];
            if weights[term] < NO_WEIGHT {
                doubts.push(Self::OneTerm { red: !red });
            } else if exponent.abs() < NEARLY_STRAIGHT {
                doubts.push(Self::Straight { red });
            } else if STEEPEST.contains(&exponent) {
                doubts.push(Self::Steep { red });
            }
        }
        let images = rank_scores.iter().filter(|&&score| score < 0.0).count();
        if images > 0 {
            doubts.push(Self::Backwards { images });
        }
        doubts
    }
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let term = |red: bool| if red { "the term in red" } else { "the term in max(G, B)" };
        match *self {
            Self::OneTerm { red } => write!(f, "{} alone carries the depth", term(red)),
            Self::Straight { red } => write!(
                f,
                "{} is nearly a line: are the labels those of a linear model of colour, and not measured?",
                term(red)
            ),
            Self::Steep { red } => {
                write!(f, "{} is a step: it hardly distinguishes any colours", term(red))
            }
            Self::Backwards { images } => {
                write!(f, "in {images} images depth falls where the model rises: are their labels inverted?")
            }
        }
    }
}
