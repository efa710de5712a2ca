//! The same water per another unit of depth.

use super::{Attenuation, AttenuationError, Waterbody};
use crate::depth::RelativeScale;
use crate::image::Encoding;

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
