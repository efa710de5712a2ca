//! A water that is known rather than estimated.

use super::{Estimate, Intervals, Quality, VeilingLightSource, Waterbody};
use crate::image::Encoding;

impl<E: Encoding> Estimate<E> {
    /// A water that is known, from tables for example: its intervals have no width, and nothing speaks against it.
    ///
    /// # Examples
    ///
    /// ```
    /// use aquafuse::waterbody::{Estimate, Waterbody, presets::{Conditions, Preset}};
    ///
    /// let ocean: Waterbody = Preset::I.water(&Conditions::default());
    /// let given = Estimate::given(ocean);
    /// assert_eq!(given.intervals.veiling_light[2], [ocean.veiling_light.rgb()[2]; 2]);
    /// ```
    pub fn given(water: Waterbody<E>) -> Self {
        Self {
            intervals: Intervals {
                veiling_light: water.veiling_light.rgb().map(|value| [value; 2]),
                backscatter_coefficient: water.backscatter_coefficient.map(|value| [value; 2]),
            },
            water,
            veiling_light_source: VeilingLightSource::Given,
            veiling_light_share: 0.0,
            depth_model: None,
            depth_factors: None,
            near_colour: None,
            quality: Quality::default(),
        }
    }
}
