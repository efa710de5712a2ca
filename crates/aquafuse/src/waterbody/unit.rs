//! The same water per another unit of depth.

use super::{Attenuation, AttenuationError, Waterbody};
use crate::depth::RelativeScale;
use crate::image::Encoding;

/// Contrast at which a thing is no longer seen.
const LEFT: f32 = 0.02;
/// Distances between which the visibility is looked for, and how often their range is halved.
const FARTHEST: [f32; 2] = [1e-5, 1e5];
const HALVINGS: usize = 40;

impl<E: Encoding> Waterbody<E> {
    /// This water, given per metre, per unit of relative depth.
    ///
    /// With m metres at relative depth 1 every coefficient grows m-fold, `β' = β m`, the decays of β_D too, and the
    /// distance beyond which it is held shrinks as much. At one place backscatter and illumination stay the same.
    ///
    /// # Errors
    ///
    /// [`AttenuationError`] when a coefficient is so large that the product is no number.
    ///
    /// # Examples
    ///
    /// ```
    /// use aquafuse::depth::RelativeScale;
    /// use aquafuse::waterbody::{Waterbody, presets::{Conditions, Preset}};
    ///
    /// let metric: Waterbody = Preset::II.water(&Conditions::default());
    /// let relative = metric.per_relative(RelativeScale::new(8.0)?)?;
    /// // 4 m is half way to 8 m.
    /// assert!((metric.backscatter(4.0)[2] - relative.backscatter(0.5)[2]).abs() < 1e-6);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn per_relative(&self, scale: RelativeScale) -> Result<Self, AttenuationError> {
        self.per(scale.metres_at_one())
    }

    /// This water, given per unit of relative depth, per metre; undoes [`per_relative`](Self::per_relative).
    ///
    /// # Errors
    ///
    /// [`AttenuationError`] when a coefficient is so large that the quotient is no number.
    pub fn per_metre(&self, scale: RelativeScale) -> Result<Self, AttenuationError> {
        self.per(scale.metres_at_one().recip())
    }

    /// How far one sees: the distance at which 2 % of a thing's contrast is left in the clearest channel, in units of z
    /// (H. Koschmieder, "Theorie der horizontalen Sichtweite", 1924). `None` where one sees farther than 100,000 units.
    ///
    /// # Examples
    ///
    /// ```
    /// use aquafuse::waterbody::{Waterbody, presets::{Conditions, Preset}};
    ///
    /// let see = |preset: Preset| -> Option<f32> {
    ///     let water: Waterbody = preset.water(&Conditions::default());
    ///     water.visibility()
    /// };
    /// assert!(see(Preset::I).unwrap() > 5.0 * see(Preset::Coastal5C).unwrap());
    /// ```
    pub fn visibility(&self) -> Option<f32> {
        let is_hidden = |z: f32| self.illumination(z).iter().all(|left| *left <= LEFT);
        let [mut near, mut far] = FARTHEST;
        if !is_hidden(far) {
            return None;
        }
        for _ in 0..HALVINGS {
            // Distances in steps of equal ratio.
            let middle = (near * far).sqrt();
            if is_hidden(middle) { far = middle } else { near = middle }
        }
        Some(far)
    }

    /// The water of the same colours in which one sees so far: every coefficient is multiplied by one factor.
    ///
    /// # Errors
    ///
    /// [`AttenuationError`] when a coefficient is no number then; also when the water has no [`visibility`](Self::visibility).
    ///
    /// # Examples
    ///
    /// ```
    /// use aquafuse::waterbody::{Waterbody, presets::{Conditions, Preset}};
    ///
    /// let harbour: Waterbody = Preset::Coastal5C.water(&Conditions::default()).with_visibility(2.0)?;
    /// assert!((harbour.visibility().unwrap() - 2.0).abs() < 1e-3);
    /// # Ok::<(), aquafuse::waterbody::AttenuationError>(())
    /// ```
    pub fn with_visibility(&self, distance: f32) -> Result<Self, AttenuationError> {
        self.per(self.visibility().unwrap_or(f32::INFINITY) / distance)
    }

    /// The same per a unit that is so many times as long.
    fn per(&self, times: f32) -> Result<Self, AttenuationError> {
        let rescale = |curve: &Attenuation| {
            Attenuation::new(curve.mu().map(|mu| mu * times), curve.held_beyond() / times)
        };
        let [red, green, blue] = self.attenuation.each_ref().map(rescale);
        Ok(Self {
            veiling_light: self.veiling_light,
            backscatter_coefficient: self.backscatter_coefficient.map(|beta| beta * times),
            attenuation: [red?, green?, blue?],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::truth::waters;

    #[test]
    fn in_clear_water_one_sees_a_known_distance() {
        let curve = Attenuation::constant(0.5).unwrap();
        let water: Waterbody = Waterbody { attenuation: [curve; 3], ..waters()[0].water };
        let seen = water.visibility().unwrap();
        assert!((seen - 50.0_f32.ln() / 0.5).abs() < 1e-3, "{seen}");
        let nearer = water.with_visibility(seen / 4.0).unwrap();
        for c in 0..3 {
            assert!((nearer.illumination(1.0)[c] - water.illumination(4.0)[c]).abs() < 1e-5);
            assert!((nearer.backscatter(1.0)[c] - water.backscatter(4.0)[c]).abs() < 1e-5);
        }
    }

    #[test]
    fn where_nothing_fades_there_is_no_visibility() {
        let curve = Attenuation::constant(0.0).unwrap();
        let water: Waterbody = Waterbody { attenuation: [curve; 3], ..waters()[0].water };
        assert_eq!(water.visibility(), None);
        assert!(water.with_visibility(3.0).is_err());
    }

    #[test]
    fn per_metre_undoes_per_relative() {
        let scale = RelativeScale::new(8.0).unwrap();
        let metric = waters()[0].water;
        let back = metric.per_relative(scale).unwrap().per_metre(scale).unwrap();
        for z in [0.5, 3.0, 20.0] {
            for c in 0..3 {
                assert!((metric.illumination(z)[c] - back.illumination(z)[c]).abs() < 1e-5);
                assert!((metric.backscatter(z)[c] - back.backscatter(z)[c]).abs() < 1e-5);
            }
        }
    }
}
