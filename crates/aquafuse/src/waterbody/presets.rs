//! Waters from published tables: Jerlov's oceanic types I to III and coastal types 1C to 9C.
//!
//! The tables give spectra: absorption a(λ), scattering b(λ) and the diffuse attenuation K_d(λ) of the light from
//! above. A waterbody has colours. What lies between is the image formation model at every wavelength, summed over
//! the response S of each channel of a camera:
//!
//! | what | at one wavelength |
//! |---|---|
//! | white facing the camera at z = 0, D below the surface | `E = daylight · e^(-K_d D)`, exposed as [`White`] says |
//! | beam attenuation, which both curves run on | `c = a + b` |
//! | direct signal of reflectance ρ | `ρ E e^(-c z)` |
//! | open water, seen level | `V = k E b_b/(a + b_b)`, k the veil factor of the [`Conditions`] |
//! | backscatter | `V (1 - e^(-c z))` |
//!
//! Open water is not `E b/c`: most of b goes nearly straight on, and what is scattered out of the line of sight is
//! made up for by what is scattered into it. Counted as not scattered, it leaves b_b above and a + b_b below, which
//! is the colour of the sea from above, too (Gordon et al. 1975). The contrast of things fades with all of c
//! (Duntley 1963).
//!
//! A sum of many exponentials is no exponential, and encoding bends it once more. [`Preset::derive`] fits β_B and
//! β_D(z) and reports how far they are off: in linear light by less than .002; encoded, the backscatter by up to .16 of
//! B∞, close to the camera, where encoding rises too steeply for one exponential, and a grey as seen by up to .11
//! (all presets, to 20 m below the surface, ranges of 3 to 50 m). Where that matters, work in linear light.
//! β_D falls with z: the light that goes first leaves the light that stays.
//!
//! # What the tables do not contain
//!
//! a and b were measured for IB to 5C; for I, IA, 7C and 9C they were found from K_d. In 7C and 9C one sees less
//! than two metres. What a real sea of a type looks like varies with sun, bottom and camera by far more than the
//! fits are off; [`Preset::assumptions`] gives every number with its source.

mod assumptions;
mod camera;
mod conditions;
mod fit;
mod sea;
mod spectral;
mod tables;

pub use assumptions::{Assumptions, Constant, Spectrum};
pub use camera::Camera;
pub use conditions::{Conditions, ConditionsError, White};
pub use sea::sea;

use super::{Estimate, VeilingLight, Waterbody};
use crate::image::{Encoded, Encoding};

/// A type of water after Jerlov.
///
/// # Examples
///
/// ```
/// use aquafuse::waterbody::{Waterbody, presets::{Conditions, Preset}};
///
/// let ocean: Waterbody = Preset::I.water(&Conditions::default());
/// let [r, g, b] = ocean.veiling_light.rgb();
/// assert!(r < g && g < b);
/// assert_eq!("jerlov-1C".parse::<Preset>().ok(), Some(Preset::Coastal1C));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Preset {
    /// The clearest ocean.
    I,
    /// Clear ocean.
    IA,
    /// Clear ocean, with particles.
    IB,
    /// Ocean.
    II,
    /// The most turbid ocean.
    III,
    /// The clearest coast.
    Coastal1C,
    /// Coast.
    Coastal3C,
    /// Turbid coast.
    Coastal5C,
    /// More turbid coast.
    Coastal7C,
    /// The most turbid coast.
    Coastal9C,
}

/// A preset's water and how closely it follows the sums over the spectrum.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(bound = ""))]
#[non_exhaustive]
pub struct Derived<E: Encoding = Encoded> {
    /// The water; coefficients per metre.
    pub water: Waterbody<E>,
    /// A white diffuser facing the camera at z = 0, in encoding `E`: the light on the scene.
    ///
    /// In linear light an image taken in air, times this, is the clear image as lit down there.
    pub white: [f32; 3],
    /// The greatest errors over the distances fitted.
    pub residual: Residual,
}

/// How far fitted curves are off at worst, per channel, as values of the encoding in `[0, 1]`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Residual {
    /// Of the backscatter B(z).
    pub backscatter: [f32; 3],
    /// Of the direct signal of a grey of 18 %.
    pub direct: [f32; 3],
    /// Of such a grey as seen, direct signal and backscatter together.
    pub seen: [f32; 3],
}

/// What near things show (encoded) of a white that is lit alike: about half, as in most images.
const NEAR_OF_WHITE: f32 = 0.5;

impl Preset {
    /// All types: the ocean from clear to turbid, then the coast.
    pub const ALL: &'static [Self] = &[
        Self::I,
        Self::IA,
        Self::IB,
        Self::II,
        Self::III,
        Self::Coastal1C,
        Self::Coastal3C,
        Self::Coastal5C,
        Self::Coastal7C,
        Self::Coastal9C,
    ];

    /// The name on the command line and in files: `jerlov-` and the type.
    pub fn name(self) -> &'static str {
        match self {
            Self::I => "jerlov-I",
            Self::IA => "jerlov-IA",
            Self::IB => "jerlov-IB",
            Self::II => "jerlov-II",
            Self::III => "jerlov-III",
            Self::Coastal1C => "jerlov-1C",
            Self::Coastal3C => "jerlov-3C",
            Self::Coastal5C => "jerlov-5C",
            Self::Coastal7C => "jerlov-7C",
            Self::Coastal9C => "jerlov-9C",
        }
    }

    /// The water as a camera sees it; coefficients per metre.
    ///
    /// For a depth map without metres see [`Waterbody::per_relative`].
    pub fn water<E: Encoding>(self, conditions: &Conditions) -> Waterbody<E> {
        self.derive(conditions).water
    }

    /// The water as an estimate without doubts, with the colour of near things in its light.
    pub fn estimate<E: Encoding>(self, conditions: &Conditions) -> Estimate<E> {
        let Derived { water, white, .. } = self.derive(conditions);
        let near = white.map(|white| E::from_encoded(NEAR_OF_WHITE * E::to_encoded(white)));
        Estimate { near_colour: Some(near), ..Estimate::given(water) }
    }

    /// The water as a camera sees it, and how closely the fitted coefficients follow the spectrum.
    ///
    /// B∞ is exact. β_B is the least-squares fit of `B∞ (1 - e^(-β_B z))` to the backscatter B in encoding `E`;
    /// β_D(z) that of `e^(-β_D z)` to what is left of a grey of 18 %, U - B as an estimator reads it off an image.
    /// Both on 64 even distances to the range of the conditions, or to where e^-6 is left of the clearest light.
    /// In linear light U - B does not depend on the water before the grey; encoded, it does: light adds up, its
    /// encoding does not.
    ///
    /// # Examples
    ///
    /// ```
    /// use aquafuse::image::Linear;
    /// use aquafuse::waterbody::presets::{Conditions, Preset};
    ///
    /// let derived = Preset::II.derive::<Linear>(&Conditions::default());
    /// assert!(derived.residual.seen.iter().all(|&off| off < 0.01));
    /// // The farther, the less each metre takes: what was easily taken is gone.
    /// let red = &derived.water.attenuation[0];
    /// assert!(red.coefficient(5.0) < red.coefficient(0.0));
    /// ```
    pub fn derive<E: Encoding>(self, conditions: &Conditions) -> Derived<E> {
        let fitted = spectral::channels(self.spectra(), conditions)
            .map(|channel| fit::fit::<E>(&channel, conditions.range_m()));
        let off = |which: usize| fitted.map(|channel| channel.off[which] as f32);
        Derived {
            water: Waterbody {
                veiling_light: VeilingLight::new(fitted.map(|channel| channel.veil as f32)),
                backscatter_coefficient: fitted.map(|channel| channel.backscatter as f32),
                attenuation: fitted.map(|channel| channel.attenuation),
            },
            white: fitted.map(|channel| channel.white as f32),
            residual: Residual { backscatter: off(0), direct: off(1), seen: off(2) },
        }
    }

    /// All that [`water`](Self::water) rests on, with the source beside each number.
    pub fn assumptions(self, conditions: &Conditions) -> Assumptions {
        assumptions::of(self, conditions)
    }

    fn spectra(self) -> tables::Spectra {
        tables::of(self as usize)
    }
}

crate::names::named!(Preset, "water preset", str::eq_ignore_ascii_case);
