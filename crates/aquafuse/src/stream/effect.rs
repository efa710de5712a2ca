//! What a water does at a distance, and a table of it.

use super::steady::mixed;

/// What a water does at one distance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct WaterEffect {
    /// F, the share of the veiling light that is not there yet.
    pub(crate) factor: [f32; 3],
    /// What the direct signal is multiplied by: to undo the water, or for another light.
    pub(crate) gain: [f32; 3],
    /// F in the water that an image is fused into, where that is another thickness of its own.
    pub(crate) after: [f32; 3],
}

/// Places of a table: one for each level of depth.
const PLACES: usize = 256;

/// What a water does by distance, at even distances from 0; between two of them on a straight line.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct EffectTable {
    /// The last distance; what is farther is as there.
    reach: f32,
    places: Vec<WaterEffect>,
}

impl EffectTable {
    /// A table up to a distance.
    pub(super) fn new(reach: f32, effect: impl Fn(f32) -> WaterEffect) -> Self {
        let mut table = Self { reach, places: vec![WaterEffect::default(); PLACES] };
        table.fill(effect);
        table
    }

    /// The same distances with another water.
    pub(super) fn fill(&mut self, effect: impl Fn(f32) -> WaterEffect) {
        for (place, entry) in self.places.iter_mut().enumerate() {
            *entry = effect(self.reach * (place as f32 / (PLACES - 1) as f32));
        }
    }

    /// Goes these shares of the way to another table of the same distances: that of F channel by channel, and that of the gain.
    pub(super) fn approach(&mut self, other: &Self, of_factor: [f32; 3], of_gain: f32) {
        for (own, other) in self.places.iter_mut().zip(&other.places) {
            for c in 0..3 {
                own.factor[c] = mixed(own.factor[c], other.factor[c], of_factor[c]);
                own.gain[c] = mixed(own.gain[c], other.gain[c], of_gain);
                own.after[c] = mixed(own.after[c], other.after[c], of_factor[c]);
            }
        }
    }

    /// What the water does at a distance.
    pub(crate) fn at(&self, z: f32) -> WaterEffect {
        let last = (PLACES - 1) as f32;
        // `max` also takes a NaN to the near side.
        let place = (z / self.reach * last).max(0.0).min(last);
        let before = (place as usize).min(PLACES - 2);
        let [from, to] = [self.places[before], self.places[before + 1]];
        let t = place - before as f32;
        let between = |from: [f32; 3], to: [f32; 3]| std::array::from_fn(|c| from[c] + t * (to[c] - from[c]));
        WaterEffect {
            factor: between(from.factor, to.factor),
            gain: between(from.gain, to.gain),
            after: between(from.after, to.after),
        }
    }
}
