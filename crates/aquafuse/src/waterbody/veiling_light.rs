//! The colour of the water at infinity, and the ways to it in their order.

mod corners;
mod histogram;
mod hue;
mod open_water;
mod places;
mod published;
mod reading;

use std::marker::PhantomData;

#[cfg(test)]
pub(super) use places::Places;
pub(super) use reading::Reading;
pub use reading::VeilingLightSource;

use super::Seen;
use super::far_region::Region;
use crate::image::{Encoded, Encoding, Sample, TopEdge};

/// Veiling light B∞: the colour that remains when nothing but water is in sight, per channel in `[0, 1]`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(transparent, bound = ""))]
pub struct VeilingLight<E: Encoding = Encoded> {
    rgb: [f32; 3],
    #[cfg_attr(feature = "serde", serde(skip))]
    encoding: PhantomData<E>,
}

impl<E: Encoding> VeilingLight<E> {
    /// Veiling light of this colour; values outside `[0, 1]` are clipped, a NaN becomes 0.
    pub fn new(rgb: [f32; 3]) -> Self {
        Self { rgb: rgb.map(f32::from_unit), encoding: PhantomData }
    }

    /// Red, green and blue in `[0, 1]`.
    pub fn rgb(&self) -> [f32; 3] {
        self.rgb
    }
}

/// What is outside `[0, 1]` is no colour, and a file that holds it is not mended.
#[cfg(feature = "serde")]
impl<'de, E: Encoding> serde::Deserialize<'de> for VeilingLight<E> {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let rgb = <[f32; 3]>::deserialize(deserializer)?;
        if rgb.iter().all(|value| (0.0..=1.0).contains(value)) {
            Ok(Self { rgb, encoding: PhantomData })
        } else {
            Err(serde::de::Error::custom(format!("veiling_light is {rgb:?}, but lies between 0 and 1")))
        }
    }
}

pub(super) use published::read_things;

/// Reads the veiling light of an image: the colour of its far region. Where that is not likely to be water and depth is
/// measured, what is farthest in the part that is counted. Without a region, the paper's way.
pub(super) fn read(region: Option<&Region>, counted: Seen<'_>, is_measured: bool, top: TopEdge) -> Reading {
    let Some(region) = region else { return published::read(counted, top) };
    open_water::read(region).unwrap_or_else(|| match is_measured {
        true => published::read_things(counted),
        false => open_water::read_things(region),
    })
}
