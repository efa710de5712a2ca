//! The medium between the camera and the splats: air, or a water.
//!
//! A splat's own colour c at distance d along the line of sight is seen as `c e^(-β_D d) + B∞ (1 - e^(-β_B d))`, and
//! what no splat hides is seen as B∞. This is done **splat by splat, before composing**, as WaterSplatting does, and
//! not on the composed image by its composed depth, as SeaSplat does: at the edge of a near thing before a far one
//! the composed depth is a distance at which nothing stands. For the veil both are one integral: composing
//! `B∞ (1 - e^(-β_B d))` front to back with the open water behind is what the light scattered in before each splat adds up
//! to. And the rasteriser need not know of water at all.

use aquafuse::waterbody::{Attenuation, AttenuationError, VeilingLight, Waterbody};

use crate::scalar::Scalar;

/// The medium between the camera and the splats.
#[derive(Clone, Debug, PartialEq)]
pub enum Medium<T> {
    /// Air: colours are seen unchanged, on black.
    Air,
    /// A water that is being learned.
    Learned(Water<T>),
    /// A water that is known.
    Known {
        /// The water, encoded.
        water: Waterbody,
        /// Units of its z in one unit of the scene.
        per_unit: f32,
    },
}

/// A water in its training parameters, which are unbounded.
#[derive(Clone, Debug, PartialEq)]
pub struct Water<T> {
    /// The logit of B∞, the logarithm of β_B, the logarithm of β_D (both per unit of the scene), three channels each.
    pub raw: [T; PARAMETERS],
}

/// Parameters of a learned water.
pub const PARAMETERS: usize = 9;

/// B∞ is kept off 0 and 1 when it is given, where its logit has no end.
const EDGE: f64 = 1e-3;
/// β is kept off 0, where its logarithm has no end.
const LEAST_BETA: f64 = 1e-4;

impl<T: Scalar> Water<T> {
    /// A water of this B∞, β_B and β_D.
    pub fn new(veil: [f64; 3], backscatter: [f64; 3], attenuation: [f64; 3]) -> Self {
        let logit = |v: f64| (v / (1.0 - v)).ln();
        let raw = |i: usize| match i / 3 {
            0 => logit(veil[i].clamp(EDGE, 1.0 - EDGE)),
            1 => backscatter[i - 3].max(LEAST_BETA).ln(),
            _ => attenuation[i - 6].max(LEAST_BETA).ln(),
        };
        Self { raw: std::array::from_fn(|i| T::of(raw(i))) }
    }

    /// B∞.
    pub fn veil(&self) -> [T; 3] {
        std::array::from_fn(|c| self.raw[c].sigmoid())
    }

    /// β_B, per unit of the scene.
    pub fn backscatter(&self) -> [T; 3] {
        std::array::from_fn(|c| self.raw[3 + c].exp())
    }

    /// β_D, per unit of the scene.
    pub fn attenuation(&self) -> [T; 3] {
        std::array::from_fn(|c| self.raw[6 + c].exp())
    }

    /// A colour seen at a distance, with this water removed, in [0, 1].
    pub fn taken_out(&self, seen: [T; 3], distance: T) -> [T; 3] {
        let (veil, growth, fading) = (self.veil(), self.backscatter(), self.attenuation());
        std::array::from_fn(|c| {
            let backscatter = veil[c] * (T::ONE - (-growth[c] * distance).exp());
            let clear = (seen[c] - backscatter) * (fading[c] * distance).exp();
            clear.at_least(T::ZERO).at_most(T::ONE)
        })
    }

    /// The same water as a [`Waterbody`], per unit of the scene.
    ///
    /// # Errors
    ///
    /// [`AttenuationError`] when training ended in a number that is not finite.
    pub fn body(&self) -> Result<Waterbody, AttenuationError> {
        let [r, g, b] = self.attenuation().map(|beta| Attenuation::constant(beta.get() as f32));
        Ok(Waterbody {
            veiling_light: VeilingLight::new(self.veil().map(|v| v.get() as f32)),
            backscatter_coefficient: self.backscatter().map(|v| v.get() as f32),
            attenuation: [r?, g?, b?],
        })
    }
}

/// What the medium does to a colour at one distance, ready to be used.
#[derive(Clone, Debug)]
pub(crate) struct Layer<T> {
    veil: [T; 3],
    backscatter: [T; 3],
    attenuation: [T; 3],
}

/// A medium as projection needs it.
#[derive(Clone, Debug)]
pub(crate) enum Between<T> {
    Air,
    Learned(Layer<T>),
    Known { water: Waterbody, per_unit: f32 },
}

impl<T: Scalar> Medium<T> {
    /// The colour where there is no splat.
    pub fn background(&self) -> [T; 3] {
        match self {
            Self::Air => [T::ZERO; 3],
            Self::Learned(water) => water.veil(),
            Self::Known { water, .. } => water.veiling_light.rgb().map(|v| T::of(f64::from(v))),
        }
    }

    pub(crate) fn between(&self) -> Between<T> {
        match self {
            Self::Air => Between::Air,
            Self::Learned(water) => Between::Learned(Layer {
                veil: water.veil(),
                backscatter: water.backscatter(),
                attenuation: water.attenuation(),
            }),
            Self::Known { water, per_unit } => Between::Known { water: *water, per_unit: *per_unit },
        }
    }

    /// The same medium in a scene whose unit is so many metres, > 0: a known water is then per metre. A learned water, which
    /// is per unit, and air stay as they are.
    #[must_use]
    pub fn with_metres_per_unit(self, metres: f32) -> Self {
        match self {
            Self::Known { water, .. } => Self::Known { water, per_unit: metres },
            other => other,
        }
    }

    /// Turns a gradient of [`Self::background`] into one of the water's parameters.
    pub(crate) fn background_back(&self, gradient: [T; 3], sums: &mut [T; PARAMETERS]) {
        if let Self::Learned(water) = self {
            for (c, veil) in water.veil().into_iter().enumerate() {
                sums[c] += gradient[c] * veil * (T::ONE - veil);
            }
        }
    }
}

impl<T: Scalar> Between<T> {
    /// A colour as seen through it.
    #[inline]
    pub(crate) fn through(&self, colour: [T; 3], distance: T) -> [T; 3] {
        match self {
            Self::Air => colour,
            Self::Learned(layer) => std::array::from_fn(|c| {
                let left = (-layer.attenuation[c] * distance).exp();
                let veiled = T::ONE - (-layer.backscatter[c] * distance).exp();
                colour[c] * left + layer.veil[c] * veiled
            }),
            Self::Known { water, per_unit } => {
                let z = distance.get() as f32 * per_unit;
                let (left, veil) = (water.illumination(z), water.backscatter(z));
                std::array::from_fn(|c| colour[c] * T::of(f64::from(left[c])) + T::of(f64::from(veil[c])))
            }
        }
    }

    /// Turns the gradient of what is seen into that of colour and distance, and adds that of the water to `sums`.
    ///
    /// A known water is only looked through: nothing is trained in it, and its gradient is not asked for.
    #[inline]
    pub(crate) fn back(
        &self,
        colour: [T; 3],
        distance: T,
        gradient: [T; 3],
        sums: &mut [T; PARAMETERS],
    ) -> ([T; 3], T) {
        let Self::Learned(layer) = self else { return (gradient, T::ZERO) };
        let mut of_distance = T::ZERO;
        let of_colour = std::array::from_fn(|c| {
            let (fading, growth, veil) = (layer.attenuation[c], layer.backscatter[c], layer.veil[c]);
            let left = (-fading * distance).exp();
            let clear = (-growth * distance).exp();
            let of_left = gradient[c] * colour[c] * left;
            let of_clear = gradient[c] * veil * clear;
            sums[c] += gradient[c] * (T::ONE - clear) * veil * (T::ONE - veil);
            sums[3 + c] += of_clear * growth * distance;
            sums[6 + c] += -of_left * fading * distance;
            of_distance += of_clear * growth - of_left * fading;
            gradient[c] * left
        });
        (of_colour, of_distance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use aquafuse::truth::waters;

    #[test]
    fn a_learned_water_and_the_same_water_known_look_alike() {
        for named in waters() {
            let body = named.water;
            let rgb = body.veiling_light.rgb().map(f64::from);
            let betas = body.backscatter_coefficient.map(f64::from);
            let fading = body.attenuation.each_ref().map(|curve| f64::from(curve.coefficient(0.0)));
            let learned = Water::<f64>::new(rgb, betas, fading);
            let again = learned.body().unwrap();
            let [learned, known, back] = [
                Medium::Learned(learned),
                Medium::Known { water: body, per_unit: 2.0 },
                Medium::Known { water: again, per_unit: 1.0 },
            ]
            .map(|medium| medium.between());
            for distance in [0.0, 0.7, 3.0, 20.0] {
                let colour = [0.9, 0.4, 0.1];
                let seen = learned.through(colour, distance);
                for other in [known.through(colour, 0.5 * distance), back.through(colour, distance)] {
                    assert!(seen.iter().zip(other).all(|(a, b)| (a - b).abs() < 1e-5), "{seen:?} {other:?}");
                }
            }
        }
    }

    #[test]
    fn a_scene_in_centimetres_looks_like_one_in_metres() {
        let water = waters()[0].water;
        let metric = Medium::<f64>::Known { water, per_unit: 1.0 };
        let in_centimetres = metric.clone().with_metres_per_unit(0.01);
        let colour = [0.8, 0.5, 0.2];
        let near = metric.between().through(colour, 2.5);
        let again = in_centimetres.between().through(colour, 250.0);
        assert!(near.iter().zip(again).all(|(a, b)| (a - b).abs() < 1e-6), "{near:?} {again:?}");
        assert_ne!(near, in_centimetres.between().through(colour, 2.5));
    }

    #[test]
    fn a_water_that_is_taken_out_comes_back() {
        let water = Water::<f64>::new([0.1, 0.4, 0.5], [0.3, 0.2, 0.15], [0.5, 0.2, 0.1]);
        let colour = [0.8, 0.5, 0.2];
        let seen = Medium::Learned(water.clone()).between().through(colour, 3.0);
        let clear = water.taken_out(seen, 3.0);
        assert!(clear.iter().zip(colour).all(|(a, b)| (a - b).abs() < 1e-12), "{clear:?}");
    }

    #[test]
    fn water_is_nothing_at_the_camera_and_all_there_is_far_away() {
        let medium = Medium::Learned(Water::<f64>::new([0.1, 0.4, 0.5], [0.3; 3], [0.5; 3]));
        assert_eq!(medium.between().through([0.9, 0.5, 0.2], 0.0), [0.9, 0.5, 0.2]);
        let far = medium.between().through([0.9, 0.5, 0.2], 200.0);
        assert!(far.iter().zip(medium.background()).all(|(a, b)| (a - b).abs() < 1e-12));
    }
}
