//! Veiling lights that are weighed where no open water shows one.

use super::posterior::Bell;
use crate::image::Encoding;

/// Factors on what was read, as logarithms: with depth from colour, whose far end need not be far, and with given depth.
const NARROW: [f32; 9] = [-0.30, -0.20, -0.12, -0.06, 0.0, 0.08, 0.16, 0.27, 0.40];
const WIDE: [f32; 17] =
    [-1.0, -0.9, -0.8, -0.7, -0.6, -0.5, -0.4, -0.3, -0.2, -0.1, 0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6];
/// Deviation of ln B∞ about what was read, with depth from colour.
const DEVIATION: f32 = 0.15;

/// What is read of things at the far end, seen through no water (encoded): its mean and deviation; and what is off besides.
const THING: Bell = Bell { mean: 0.4, deviation: 0.15 };
const BESIDES: f32 = 0.02;
/// ln B∞ (encoded) of waters, before looking.
const WATERS: [Bell; 3] = [
    Bell { mean: -1.90, deviation: 0.7 },
    Bell { mean: -1.05, deviation: 0.4 },
    Bell { mean: -0.80, deviation: 0.4 },
];
/// ln of a veil is not distinguished below this (encoded).
const FAINTEST: f32 = 0.01;

/// Which veiling lights are tried, and what speaks for each.
#[derive(Clone, Copy, Debug)]
pub(super) enum Veils {
    /// Open water showed it.
    Seen,
    /// It is about what was read at the far end.
    AboutAsRead,
    /// The far end shows `B∞ (1 - F) + thing · F`: as much of the things there as the optical depth lets through.
    BehindThings { channel: usize },
}

impl Veils {
    /// Factors that are tried on what was read, as logarithms.
    pub(super) fn ln_factors(self) -> &'static [f32] {
        match self {
            Self::Seen => &[0.0],
            Self::AboutAsRead => &NARROW,
            Self::BehindThings { .. } => &WIDE,
        }
    }

    /// What speaks against the veiling light `read` times e^`ln_factor`, with `left` of a thing's own light at the far end.
    pub(super) fn cost<E: Encoding>(self, read: f32, ln_factor: f32, left: f32) -> f32 {
        match self {
            Self::Seen => 0.0,
            Self::AboutAsRead => Bell { mean: 0.0, deviation: DEVIATION }.cost(ln_factor),
            Self::BehindThings { channel } => {
                let veil = (read * ln_factor.exp()).min(1.0);
                let shown = E::to_encoded(veil * (1.0 - left) + E::from_encoded(THING.mean) * left);
                let far = Bell { mean: shown, deviation: THING.deviation * left + BESIDES };
                let ln_veil = E::to_encoded(veil).max(FAINTEST).ln();
                far.cost(E::to_encoded(read)) + far.deviation.ln() + WATERS[channel].cost(ln_veil)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Encoded;

    fn likeliest(veils: Veils, read: f32, left: f32) -> f32 {
        let cost = |ln: f32| veils.cost::<Encoded>(read, ln, left);
        let least = veils.ln_factors().iter().copied().min_by(|a, b| cost(*a).total_cmp(&cost(*b)));
        read * least.unwrap().exp()
    }

    #[test]
    fn far_away_nothing_but_the_veil_is_seen() {
        for read in [0.2, 0.5, 0.8] {
            let found = likeliest(Veils::BehindThings { channel: 1 }, read, 1e-3);
            assert!((found / read - 1.0).abs() < 0.11, "{found} for {read}");
        }
    }

    #[test]
    fn nearer_things_are_taken_off_what_was_read() {
        // A veil of .3 in front of a thing of .4, and of sand.
        let red = Veils::BehindThings { channel: 0 };
        assert!(likeliest(red, 0.3 * 0.6 + 0.4 * 0.4, 0.4) < 0.34);
        assert!(likeliest(red, 0.3 * 0.6 + 0.6 * 0.4, 0.4) < 0.3 * 0.6 + 0.6 * 0.4);
    }
}
