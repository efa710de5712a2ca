//! The two meanings a colour value can have: as a camera writes it, or proportional to light.

use std::fmt::Debug;

/// What the values of an image, or of a water's colour, mean.
///
/// Sealed: [`Encoded`] and [`Linear`] are all there is.
pub trait Encoding: sealed::Sealed + Copy + Debug + Default + PartialEq + Send + Sync + 'static {
    /// Takes an encoded (sRGB) value in `[0, 1]` into this encoding.
    fn from_encoded(value: f32) -> f32;
    /// Takes a value of this encoding to the encoded (sRGB) one.
    fn to_encoded(value: f32) -> f32;
}

/// Values as a camera writes them, behind the sRGB transfer function. The paper works on these.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Encoded;

/// Values proportional to light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Linear;

impl Encoding for Encoded {
    fn from_encoded(value: f32) -> f32 {
        value
    }
    fn to_encoded(value: f32) -> f32 {
        value
    }
}

impl Encoding for Linear {
    fn from_encoded(value: f32) -> f32 {
        if value <= 0.040_45 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
    }
    fn to_encoded(value: f32) -> f32 {
        if value <= 0.003_130_8 { value * 12.92 } else { 1.055 * value.powf(1.0 / 2.4) - 0.055 }
    }
}

mod sealed {
    pub trait Sealed {}
    impl Sealed for super::Encoded {}
    impl Sealed for super::Linear {}
}
