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
        let metres = scale.metres_at_one();
        let rescale = |curve: &Attenuation| {
            Attenuation::new(curve.mu().map(|mu| mu * metres), scale.relative(curve.held_beyond()))
        };
        let [red, green, blue] = self.attenuation.each_ref().map(rescale);
        Ok(Self {
            veiling_light: self.veiling_light,
            backscatter_coefficient: self.backscatter_coefficient.map(|beta| beta * metres),
            attenuation: [red?, green?, blue?],
        })
    }
}
