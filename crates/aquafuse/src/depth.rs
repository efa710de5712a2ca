//! Distance from the camera: estimated from colour (Eq. 3), or given.
//!
//! Water takes red away first, so red against the stronger of green and blue shows how much water a
//! pixel was seen through. [`DepthModel`] lists the depth models; [`estimate`] uses the paper's,
//! [`Eq3`], with our coefficients. Depth from elsewhere comes in as
//! [`Supplied`], of a declared kind, and [`DepthMap`] holds it in metres or relative.

mod coarse;
mod eq3;
pub mod fit;
mod layout;
mod map;
mod median;
mod model;
#[cfg(feature = "network")]
mod network;
mod refine;
mod scale;
mod supplied;
mod tables;

pub use eq3::{Eq3, Eq3Error};
pub(crate) use map::{Buffers, InSteps, LEVELS, Quantised, Stepped, TABLE};
pub use map::{DepthError, DepthKind, DepthMap};
pub use model::DepthModel;
pub use scale::{RelativeScale, ScaleError};
pub use supplied::{Supplied, SuppliedDepth, SuppliedError, SuppliedKind, SuppliedReport};

use crate::image::{ImageRef, Sample};

/// e of [`DepthModel::Ratio`]: below it, values are the camera's noise and their ratio means nothing.
const DARK: f64 = 0.02;

/// Estimates relative depth from colour: Eq. 3 with our coefficients, refined by the image.
///
/// The result lies in `[0, 1]`, larger is farther. See [`DepthModel`] for other ways, and for what
/// to expect where red is dead: everything looks far.
///
/// # Examples
///
/// ```
/// use aquafuse::{depth, image::Image};
///
/// // Left half red and near, right half blue and far.
/// let row: Vec<u8> = (0..16).flat_map(|x| if x < 8 { [200, 40, 40] } else { [10, 90, 160] }).collect();
/// let image = Image::<u8>::from_raw(16, 1, row)?;
/// let z = depth::estimate(&image);
/// assert!(z.at(2, 0) < 0.2 && z.at(13, 0) > 0.8);
/// # Ok::<(), aquafuse::image::ImageError>(())
/// ```
#[must_use]
pub fn estimate<'a, T: Sample>(image: impl Into<ImageRef<'a, T>>) -> DepthMap {
    DepthModel::default().estimate(image)
}
