//! A content and a reference in another water, with the truth of what fusing them should give.

use super::{Case, Trials, place_of};
use crate::formation::form;
use crate::image::{Encoding, Image};
use crate::waterbody::Waterbody;

/// Numbers of scenes, far enough from the first ones for estimates to be tried on others.
const CONTENTS: usize = 1000;
const REFERENCES: usize = 3000;

/// Veils that differ by less in every channel (encoded) are one water to the eye: nothing is to be exchanged.
const ANOTHER_WATER: f32 = 0.2;

/// A content, and a reference in another water.
#[derive(Clone, Debug)]
pub struct Exchange<E: Encoding> {
    /// The place that is to be seen in another water.
    pub content: Case<E>,
    /// Another place, in that water.
    pub reference: Case<E>,
    /// Truth A, the content with nothing exchanged but B∞, and truth B, the content wholly in the other water.
    pub truths: [Image<f32, E>; 2],
}

impl<E: Encoding> Exchange<E> {
    pub(super) fn new(trials: &Trials, number: usize) -> Self {
        let content: Case<E> = trials.case(CONTENTS + number);
        let mut other = REFERENCES + number;
        let reference = loop {
            // The content's own place would hand its histogram to the rivals.
            let elsewhere = place_of(other) != place_of(CONTENTS + number);
            let reference = trials.case(other);
            if elsewhere && differ(&content.water, &reference.water) >= ANOTHER_WATER {
                break reference;
            }
            // The next place that looks the same way.
            other += 2;
        };
        let veil = Waterbody { veiling_light: reference.water.veiling_light, ..content.water };
        let truth = |water| form(&content.clear, &content.depth, water).expect("made in one size");
        let truths = [truth(&veil), truth(&reference.water)];
        Self { content, reference, truths }
    }

    /// Whether open water is in view in both.
    pub fn open(&self) -> bool {
        self.content.open && self.reference.open
    }
}

/// The largest difference of two veils in any channel, encoded.
fn differ<E: Encoding>(a: &Waterbody<E>, b: &Waterbody<E>) -> f32 {
    let [a, b] = [a, b].map(|water| water.veiling_light.rgb().map(E::to_encoded));
    (0..3).map(|c| (a[c] - b[c]).abs()).fold(0.0, f32::max)
}
