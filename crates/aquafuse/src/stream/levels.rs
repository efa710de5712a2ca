//! Levels of a sequence.

use super::steady::mixed;
use crate::levels::Levels;

/// The mean of the levels of the frames so far.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SteadyLevels {
    mean: Option<Levels>,
    /// Frames so far.
    age: usize,
}

impl SteadyLevels {
    /// Takes the levels of a frame that is so many times `brighter` than the last one, with a memory of so many frames.
    ///
    /// Black and white go with the exposure. What no frame decides, such as the strength, is that of this frame.
    pub(super) fn follow(&mut self, frame: Levels, brighter: f32, frames: usize) -> Levels {
        self.age = self.age.saturating_add(1);
        let rate = 1.0 / self.age.min(frames) as f32;
        let mean = self.mean.map_or(frame, |mean| {
            let of_channels =
                |from: [f32; 3], to: [f32; 3]| std::array::from_fn(|c| mixed(from[c], to[c], rate));
            let (black, gain) = match brighter {
                1.0 => (mean.black, mean.gain),
                _ => (mean.black.map(|black| brighter * black), mean.gain.map(|gain| gain / brighter)),
            };
            Levels {
                black: of_channels(black, frame.black),
                gain: of_channels(gain, frame.gain),
                exponent: of_channels(mean.exponent, frame.exponent),
                red_from_green: mixed(mean.red_from_green, frame.red_from_green, rate),
                ..frame
            }
        });
        self.mean = Some(mean);
        mean
    }
}
