//! What a pixel shows is either a thing, which lets no light through, or open water, which holds no splat.
//!
//! Colours alone do not say so. A surface that lets a twentieth of the light through looks the same before B∞, because its
//! splats take the colour that is missing; and a splat in open water is invisible if its colour seen through the water is
//! B∞. Both show once the water is removed or exchanged: surfaces are darker than they are, and open water is full of fog.
//! So the transmittance of each pixel has a small loss of its own.

use crate::medium::Medium;
use crate::train::loss::Target;

/// A pixel is open water if no channel of the image differs more from B∞: two steps of 255. With five, turbid water would hide
/// things that can still be seen.
pub(super) const OPEN: f32 = 0.008;
/// Surfaces are closed where less than this is let through: more is an edge, or water that is not uniform.
const SURFACE: f32 = 1.0 / 3.0;

/// What the loss of the transmittance T asks for at this step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Push {
    /// The weight of the loss, a mean over pixels.
    pub(super) weight: f32,
    /// Whether surfaces are closed too: only once the water is known.
    pub(super) closes: bool,
}

impl Push {
    /// The gradient of the loss by T, pixel by pixel: of `1 - T` in open water, and of `T (1 - T)²` elsewhere, which is least
    /// at 0 and at 1 and highest at a third.
    pub(super) fn gradient(
        self,
        target: &Target<f32>,
        medium: &Medium<f32>,
        transmittance: &[f32],
    ) -> Vec<f32> {
        let each = self.weight / transmittance.len().max(1) as f32;
        let veil = match medium {
            Medium::Air => None,
            water => Some(water.background()),
        };
        let by = |(i, &t): (usize, &f32)| match veil {
            Some(veil) if target.is_near(i, veil, OPEN) => -each,
            _ if self.closes => each * (1.0 - t) * (1.0 - t / SURFACE),
            _ => 0.0,
        };
        transmittance.iter().enumerate().map(by).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::medium::Water;

    #[test]
    fn open_water_is_emptied_and_surfaces_are_closed() {
        let veil = [0.1, 0.4, 0.5];
        let medium = Medium::Learned(Water::new(veil.map(f64::from), [0.2; 3], [0.3; 3]));
        let target = Target::new(4, 1, &[veil, [0.3, 0.4, 0.5], [0.3, 0.4, 0.5], [0.105, 0.395, 0.505]]);
        let transmittance = [0.5, 0.1, 0.6, 0.0];
        let push = Push { weight: 1.0, closes: true };
        let found = push.gradient(&target, &medium, &transmittance);
        // A step goes against the gradient.
        assert!(found[0] < 0.0 && found[1] > 0.0 && found[2] < 0.0 && found[3] < 0.0, "{found:?}");
        let early = Push { closes: false, ..push }.gradient(&target, &medium, &transmittance);
        assert!(early[0] < 0.0 && early[1..3] == [0.0; 2], "{early:?}");
        // In air nothing is open water, however dark.
        let dark = Target::new(1, 1, &[[0.0; 3]]);
        assert!(push.gradient(&dark, &Medium::Air, &[0.1])[0] > 0.0);
    }
}
