//! Encoded or linear: a type in the core, a value from here on.

use std::fmt;
use std::str::FromStr;

use aquafuse::depth::{DepthKind, DepthModel, RelativeScale};
use aquafuse::image::{Encoded, Encoding, Linear};
use aquafuse::waterbody::presets::{Conditions, Preset};
use aquafuse::waterbody::{self, AttenuationError, Estimate, Intervals, Quality, VeilingLightSource};

/// Which values of an image the physics works on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PixelEncoding {
    /// The encoded (sRGB) values that cameras write, as in the paper.
    #[default]
    Encoded,
    /// Linear light.
    Linear,
}

impl PixelEncoding {
    /// Both.
    pub const ALL: &'static [Self] = &[Self::Encoded, Self::Linear];

    /// The name in files and reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Encoded => "encoded",
            Self::Linear => "linear",
        }
    }

    /// Bytes a pixel that work in this encoding takes beside the image.
    pub(crate) fn bytes_a_pixel(self) -> u64 {
        match self {
            Self::Encoded => 0,
            // The light, the same encoded, and the samples.
            Self::Linear => 3 * (4 + 4 + 4),
        }
    }
}

impl fmt::Display for PixelEncoding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A name that is neither `encoded` nor `linear`.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no encoding {0:?}: give encoded or linear")]
pub struct UnknownEncoding(String);

impl FromStr for PixelEncoding {
    type Err = UnknownEncoding;

    fn from_str(name: &str) -> Result<Self, UnknownEncoding> {
        let named = Self::ALL.iter().find(|encoding| encoding.name() == name);
        named.copied().ok_or_else(|| UnknownEncoding(name.to_owned()))
    }
}

/// An estimated or known waterbody, in the encoding that it belongs to.
///
/// Waters of the two encodings are different numbers and cannot be combined: an operation of one on an analysis of the other is
/// an error.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "both variants are of one size")]
pub enum WaterEstimate {
    /// Of encoded values.
    Encoded(Estimate<Encoded>),
    /// Of linear light.
    Linear(Estimate<Linear>),
}

impl From<Estimate<Encoded>> for WaterEstimate {
    fn from(estimate: Estimate<Encoded>) -> Self {
        Self::Encoded(estimate)
    }
}

impl From<Estimate<Linear>> for WaterEstimate {
    fn from(estimate: Estimate<Linear>) -> Self {
        Self::Linear(estimate)
    }
}

/// Evaluates an expression with the estimate inside, whatever its encoding.
macro_rules! with_estimate {
    ($water:expr, $estimate:ident => $value:expr) => {
        match $water {
            $crate::pipeline::WaterEstimate::Encoded($estimate) => $value,
            $crate::pipeline::WaterEstimate::Linear($estimate) => $value,
        }
    };
}
pub(crate) use with_estimate;

impl WaterEstimate {
    /// The water of a preset, per metre, which has no doubts.
    pub fn preset(preset: Preset, conditions: &Conditions, encoding: PixelEncoding) -> Self {
        match encoding {
            PixelEncoding::Encoded => Self::Encoded(preset.estimate(conditions)),
            PixelEncoding::Linear => Self::Linear(preset.estimate(conditions)),
        }
    }

    /// One water from several estimates of one encoding ([`waterbody::pool`]); `None` for no estimate, or for two
    /// encodings.
    pub fn pool(estimates: &[Self]) -> Option<Self> {
        fn all<E: Space>(estimates: &[WaterEstimate]) -> Option<WaterEstimate> {
            let same: Vec<Estimate<E>> = estimates.iter().map(E::estimate).collect::<Option<Vec<_>>>()?;
            waterbody::pool(&same).map(E::wrap)
        }
        match estimates.first()? {
            Self::Encoded(_) => all::<Encoded>(estimates),
            Self::Linear(_) => all::<Linear>(estimates),
        }
    }

    /// The encoding that the numbers belong to.
    pub fn encoding(&self) -> PixelEncoding {
        match self {
            Self::Encoded(_) => PixelEncoding::Encoded,
            Self::Linear(_) => PixelEncoding::Linear,
        }
    }

    /// The verdict, and the reasons for it.
    pub fn quality(&self) -> Quality {
        with_estimate!(self, estimate => estimate.quality)
    }

    /// The same water with another verdict.
    #[must_use]
    pub fn with_quality(mut self, quality: Quality) -> Self {
        with_estimate!(&mut self, estimate => estimate.quality = quality);
        self
    }

    /// B∞ of red, green and blue as it looks, encoded, whatever the encoding of the water.
    pub fn veiling_light_as_seen(&self) -> [f32; 3] {
        match self {
            Self::Encoded(estimate) => estimate.water.veiling_light.rgb(),
            Self::Linear(estimate) => estimate.water.veiling_light.rgb().map(Linear::to_encoded),
        }
    }

    /// What is left of the direct signal of red, green and blue at distance z (E, Eq. 6), in this encoding.
    pub fn illumination(&self, z: f32) -> [f32; 3] {
        with_estimate!(self, estimate => estimate.water.illumination(z))
    }

    /// Where B∞ was read, and from which share of the image.
    pub fn veiling_light_source(&self) -> (VeilingLightSource, f32) {
        with_estimate!(self, estimate => (estimate.veiling_light_source, estimate.veiling_light_share))
    }

    /// The mean colour of near things, where anybody looked.
    pub fn near_colour(&self) -> Option<[f32; 3]> {
        with_estimate!(self, estimate => estimate.near_colour)
    }

    /// The depth model used; `None` for supplied depth and for known water.
    pub fn depth_model(&self) -> Option<DepthModel> {
        with_estimate!(self, estimate => estimate.depth_model)
    }

    /// How far off the numbers may be.
    pub fn intervals(&self) -> Intervals {
        with_estimate!(self, estimate => estimate.intervals)
    }

    /// The same water per unit of another kind of depth.
    ///
    /// # Errors
    ///
    /// [`AttenuationError`] when a coefficient does not fit into a number.
    pub fn per(self, from: DepthKind, to: DepthKind, scale: RelativeScale) -> Result<Self, AttenuationError> {
        fn converted<E: Space>(
            mut estimate: Estimate<E>,
            from: DepthKind,
            to: DepthKind,
            scale: RelativeScale,
        ) -> Result<WaterEstimate, AttenuationError> {
            let (water, times) = match (from, to) {
                (DepthKind::Metres, DepthKind::Relative) => {
                    (estimate.water.per_relative(scale), scale.metres_at_one())
                }
                (DepthKind::Relative, DepthKind::Metres) => {
                    (estimate.water.per_metre(scale), 1.0 / scale.metres_at_one())
                }
                _ => return Ok(E::wrap(estimate)),
            };
            estimate.water = water?;
            for end in estimate.intervals.backscatter_coefficient.as_flattened_mut() {
                *end *= times;
            }
            Ok(E::wrap(estimate))
        }
        with_estimate!(self, estimate => converted(estimate, from, to, scale))
    }
}

impl WaterEstimate {
    /// The water of the same colours in which one sees so far, in the unit of its depth.
    ///
    /// # Errors
    ///
    /// [`AttenuationError`] when it has no visibility, or a coefficient does not fit into a number.
    pub fn with_visibility(self, distance: f32) -> Result<Self, AttenuationError> {
        fn changed<E: Space>(
            mut estimate: Estimate<E>,
            distance: f32,
        ) -> Result<WaterEstimate, AttenuationError> {
            let water = estimate.water.with_visibility(distance)?;
            let pairs = water.backscatter_coefficient.iter().zip(estimate.water.backscatter_coefficient);
            for (ends, (new, old)) in estimate.intervals.backscatter_coefficient.iter_mut().zip(pairs) {
                let times = if old > 0.0 { new / old } else { 1.0 };
                ends.iter_mut().for_each(|end| *end *= times);
            }
            estimate.water = water;
            Ok(E::wrap(estimate))
        }
        with_estimate!(self, estimate => changed(estimate, distance))
    }
}

/// An encoding of the core, and the way between its estimates and values.
pub(crate) trait Space: Encoding {
    /// The estimate inside, if it is of this encoding.
    fn estimate(water: &WaterEstimate) -> Option<Estimate<Self>>;
    /// An estimate as a value.
    fn wrap(estimate: Estimate<Self>) -> WaterEstimate;
}

impl Space for Encoded {
    fn estimate(water: &WaterEstimate) -> Option<Estimate<Self>> {
        match water {
            WaterEstimate::Encoded(estimate) => Some(*estimate),
            WaterEstimate::Linear(_) => None,
        }
    }

    fn wrap(estimate: Estimate<Self>) -> WaterEstimate {
        WaterEstimate::Encoded(estimate)
    }
}

impl Space for Linear {
    fn estimate(water: &WaterEstimate) -> Option<Estimate<Self>> {
        match water {
            WaterEstimate::Encoded(_) => None,
            WaterEstimate::Linear(estimate) => Some(*estimate),
        }
    }

    fn wrap(estimate: Estimate<Self>) -> WaterEstimate {
        WaterEstimate::Linear(estimate)
    }
}
