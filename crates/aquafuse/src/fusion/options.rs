//! The choices fusion leaves to its user.

/// Which part of the backscatter is exchanged.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
#[non_exhaustive]
pub enum Model {
    /// The paper's equations to the letter: a veil over the middle distance, nothing at the camera nor in open water.
    Aquafuse,
    /// The whole backscatter: open water takes the reference's colour, as in the paper's figures. The default.
    #[default]
    Physical,
    /// The whole backscatter, and the light on near things: most of the hue of the reference's light, half of its brightness. A water
    /// that is known per metre also decides how thick it is.
    Relight,
    /// The whole water: backscatter, and how the scene's own light fades. Strongest and most fragile: it
    /// needs β_D of both waters and a depth whose 0 is at the camera, so measured rather than from colour.
    Exchange,
}

impl Model {
    /// All models, in the order of the documentation.
    pub const ALL: &'static [Self] = &[Self::Aquafuse, Self::Physical, Self::Relight, Self::Exchange];

    /// The name used on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Aquafuse => "aquafuse",
            Self::Physical => "physical",
            Self::Relight => "relight",
            Self::Exchange => "exchange",
        }
    }

    /// Whether it adds the same to all pixels of one depth and channel; the others also scale them.
    pub fn is_shift(self) -> bool {
        match self {
            Self::Aquafuse | Self::Physical => true,
            Self::Relight | Self::Exchange => false,
        }
    }

    /// Whether it takes F from [`DepthFactors`](crate::waterbody::DepthFactors) where there are some.
    pub(crate) fn reads_depth_factors(self) -> bool {
        match self {
            Self::Physical | Self::Relight => true,
            Self::Aquafuse | Self::Exchange => false,
        }
    }
}

crate::names::named!(Model, "fusion model");

/// How to fuse.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Options {
    /// Which part of the backscatter is exchanged.
    pub model: Model,
    /// Incidence θ: 0° fuses most, 90° not at all.
    pub incidence: Incidence,
    /// Gain α on the reference's veiling light.
    pub gain: Gain,
    /// Bound on how often [`Model::Exchange`] strengthens what has faded more in the content's water than it
    /// would in the reference's, >= 1; less counts as 1. What is noise there, and what is wrong in a faint
    /// channel, grows with the rest.
    ///
    /// Default: 2. With depth from colour (Eq. 3), 8 made .09 of the true change on truth scenes and 2 made .28;
    /// with depth given and the water estimated, both made .77. With everything known 8, the bound of
    /// restoration, comes nearer to the truth in thick water.
    pub max_gain: f32,
}

impl Options {
    /// The defaults of a model: α = 1, and θ = 45° for [`Model::Aquafuse`] (the middle of the 30-60° the
    /// paper finds natural), 0° for the others (the whole exchange).
    pub fn for_model(model: Model) -> Self {
        let degrees = match model {
            Model::Aquafuse => 45.0,
            Model::Physical | Model::Relight | Model::Exchange => 0.0,
        };
        Self { model, incidence: Incidence { degrees }, gain: Gain::default(), max_gain: 2.0 }
    }

    /// What comes near the paper's published scores: [`Model::Aquafuse`], θ = 45°, α = 1.5.
    ///
    /// Our fit, not the authors' settings. Depth by Eq. 3 and
    /// [`Smoothing::Bilateral`](crate::smooth::Smoothing::Bilateral) belong to it.
    pub fn as_published() -> Self {
        Self { gain: Gain(1.5), ..Self::for_model(Model::Aquafuse) }
    }

    /// The same with another incidence θ.
    #[must_use]
    pub fn with_incidence(self, incidence: Incidence) -> Self {
        Self { incidence, ..self }
    }

    /// The same with another gain α.
    #[must_use]
    pub fn with_gain(self, gain: Gain) -> Self {
        Self { gain, ..self }
    }

    /// The same with another bound on the gain of the direct signal.
    #[must_use]
    pub fn with_max_gain(self, max_gain: f32) -> Self {
        Self { max_gain, ..self }
    }
}

impl Default for Options {
    fn default() -> Self {
        Self::for_model(Model::default())
    }
}

/// A number that is no incidence, or no gain.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OptionError {
    /// θ outside `[0, 90]`.
    #[error("incidence θ is {degrees}°, but must be from 0° (most fusion) to 90° (none)")]
    Incidence {
        /// Degrees found.
        degrees: f32,
    },
    /// α negative or not finite.
    #[error("gain α is {gain}, but must be a finite number, 0 or more")]
    Gain {
        /// Gain found.
        gain: f32,
    },
}

/// Angle θ of the light to the surface normal, in `[0°, 90°]`; its cosine scales the fusion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Incidence {
    degrees: f32,
}

impl Incidence {
    /// An angle in degrees.
    ///
    /// # Errors
    ///
    /// [`OptionError::Incidence`] outside `[0, 90]`.
    pub fn from_degrees(degrees: f32) -> Result<Self, OptionError> {
        if (0.0..=90.0).contains(&degrees) {
            Ok(Self { degrees })
        } else {
            Err(OptionError::Incidence { degrees })
        }
    }

    /// The angle in degrees.
    pub fn degrees(self) -> f32 {
        self.degrees
    }

    /// cos θ, exactly 1 at 0° and exactly 0 at 90°.
    pub fn cosine(self) -> f32 {
        // The sine of the complement: the cosine of a rounded right angle would not be 0.
        (90.0 - f64::from(self.degrees)).to_radians().sin() as f32
    }
}

/// Gain α on the reference's veiling light, >= 0. The paper gives no value; 1 takes it as it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gain(f32);

impl Gain {
    /// A gain.
    ///
    /// # Errors
    ///
    /// [`OptionError::Gain`] when it is negative or not finite.
    pub fn new(gain: f32) -> Result<Self, OptionError> {
        if gain.is_finite() && gain >= 0.0 { Ok(Self(gain)) } else { Err(OptionError::Gain { gain }) }
    }

    /// The number.
    pub fn get(self) -> f32 {
        self.0
    }
}

impl Default for Gain {
    fn default() -> Self {
        Self(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cosine_is_exact_at_both_ends() {
        let cosine = |degrees| Incidence::from_degrees(degrees).unwrap().cosine();
        assert_eq!((cosine(0.0), cosine(90.0)), (1.0, 0.0));
        assert!((cosine(60.0) - 0.5).abs() < 1e-7);
    }

    #[test]
    fn angles_and_gains_outside_their_range_are_refused() {
        for degrees in [-1.0, 90.1, f32::NAN] {
            assert!(Incidence::from_degrees(degrees).is_err());
        }
        for gain in [-0.1, f32::INFINITY, f32::NAN] {
            assert!(Gain::new(gain).is_err());
        }
    }
}
