//! A veiling light as read from bytes, and where.

use super::places::Places;

/// Noise of an image without a smooth place to measure it, in bytes: that of rounding.
pub(super) const ROUNDING: f32 = 0.3;

/// Where the veiling light was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum VeilingLightSource {
    /// Smooth open water of one colour.
    OpenWater,
    /// What looks most like open water, though it is not likely to be any.
    FarRegion,
    /// The farthest bluish-green pixels: the paper's way.
    Farthest,
    /// Too few of those: the bluish-green pixels of the two top corners.
    TopCorners,
    /// Too few there as well: those of the two bottom corners.
    BottomCorners,
    /// None of these: the farthest pixels whatever their colour.
    Unfiltered,
    /// No image: the water is known from elsewhere.
    Given,
}

/// What was read off an image.
pub(in crate::waterbody) struct Reading {
    /// Encoded colour in `[0, 1]`.
    pub(in crate::waterbody) rgb: [f32; 3],
    pub(in crate::waterbody) source: VeilingLightSource,
    /// Share of the image it is the median of.
    pub(in crate::waterbody) share: f64,
    /// The pixels it was read from.
    pub(in crate::waterbody) places: Places,
    /// Standard error of the colour, encoded; 0 where it is not known.
    pub(in crate::waterbody) standard_error: [f32; 3],
    /// How likely it is to be open water; none where that was not looked for.
    pub(in crate::waterbody) seen: Option<f32>,
    /// Level of depth at which open water was seen.
    pub(in crate::waterbody) level: Option<u8>,
    /// Deviation of values where nothing but water is, in bytes: the camera's noise.
    pub(in crate::waterbody) noise: f32,
}
