//! The image formation model, forwards and back (Eq. 1 and 2).

mod bound;
mod levelled;

pub use bound::{BoundedRestoration, RestoreBounds};

use crate::depth::DepthMap;
use crate::image::{Clipping, Encoding, Image, ImageError, ImageMut, ImageRef, Sample};
use crate::waterbody::Waterbody;

/// Puts a scene into water: what a camera sees of a clear image through `water`.
///
/// Evaluates Eq. 1, `U = I e^(-τ(z)) + B∞ (1 - e^(-β_B z))`, at every pixel. Image and depth map share
/// one size; the coefficients are per unit of the map's z. At z = 0 nothing changes; far away only the
/// veiling light is left. The result is not clipped.
///
/// # Errors
///
/// [`ImageError`] when image and depth map differ in size.
///
/// # Examples
///
/// ```
/// use aquafuse::{depth::{DepthKind, DepthMap}, formation::form, image::Image};
/// use aquafuse::waterbody::{Attenuation, VeilingLight, Waterbody};
///
/// let clear: Image<f32> = Image::from_raw(2, 1, vec![0.8; 6])?;
/// let z = DepthMap::from_distances(2, 1, DepthKind::Metres, vec![0.0, 10.0])?;
/// let water = Waterbody {
///     veiling_light: VeilingLight::new([0.1, 0.4, 0.5]),
///     backscatter_coefficient: [0.2; 3],
///     attenuation: [Attenuation::constant(0.2)?; 3],
/// };
/// let seen = form(&clear, &z, &water)?;
/// assert_eq!(seen.pixels()[0], [0.8; 3]);
/// let left = (-2.0_f32).exp();
/// assert!((seen.pixels()[1][0] - (0.8 * left + 0.1 * (1.0 - left))).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn form<'a, T: Sample, E: Encoding>(
    clear: impl Into<ImageRef<'a, T, E>>,
    depth: &DepthMap,
    water: &Waterbody<E>,
) -> Result<Image<f32, E>, ImageError> {
    let clear = clear.into();
    depth.check_fits(clear.size())?;
    let mut seen = clear.to_unit();
    depth.for_each_pixel(
        seen.view_mut(),
        |z| (water.illumination(z), water.backscatter(z)),
        |pixel, (illumination, backscatter)| {
            for c in 0..3 {
                pixel[c] = pixel[c] * illumination[c] + backscatter[c];
            }
        },
    );
    Ok(seen)
}

/// How far [`restore`] may go.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct RestoreOptions {
    /// Bound on the gain e^τ of each channel, >= 1. Where light is all but gone, what is left is noise, and depth from colour
    /// overstates how far that is; levels amplify what is left once more.
    pub max_gain: [f32; 3],
}

impl Default for RestoreOptions {
    fn default() -> Self {
        Self { max_gain: [2.0; 3] }
    }
}

impl RestoreOptions {
    /// The same with another bound on the gain of each channel.
    #[must_use]
    pub fn with_max_gain(self, max_gain: [f32; 3]) -> Self {
        Self { max_gain, ..self }
    }
}

/// Removes the water from an image, giving the scene as if seen through air.
///
/// Evaluates Eq. 2, `I = (U - B) e^(τ(z))`, at every pixel, with the gain e^τ bounded. It undoes
/// [`form`] wherever the bound does not act. The result is not clipped.
///
/// # Errors
///
/// [`ImageError`] when image and depth map differ in size.
///
/// # Examples
///
/// ```
/// use aquafuse::{depth::{DepthKind, DepthMap}, formation::{RestoreOptions, form, restore}, image::Image};
/// use aquafuse::waterbody::{Attenuation, VeilingLight, Waterbody};
///
/// let clear: Image<f32> = Image::from_raw(1, 1, vec![0.8, 0.5, 0.2])?;
/// let z = DepthMap::from_distances(1, 1, DepthKind::Metres, vec![4.0])?;
/// let water = Waterbody {
///     veiling_light: VeilingLight::new([0.1, 0.4, 0.5]),
///     backscatter_coefficient: [0.2; 3],
///     attenuation: [Attenuation::constant(0.3)?; 3],
/// };
/// // The red of this scene is amplified e^1.2 times, which is more than the default bound.
/// let options = RestoreOptions::default().with_max_gain([8.0; 3]);
/// let restored = restore(&form(&clear, &z, &water)?, &z, &water, &options)?;
/// assert!((restored.pixels()[0][0] - 0.8).abs() < 1e-5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn restore<'a, T: Sample, E: Encoding>(
    image: impl Into<ImageRef<'a, T, E>>,
    depth: &DepthMap,
    water: &Waterbody<E>,
    options: &RestoreOptions,
) -> Result<Image<f32, E>, ImageError> {
    let image = image.into();
    depth.check_fits(image.size())?;
    let mut clear = image.to_unit();
    let law = undoing(depth.measured_to(), water, options);
    depth.for_each_pixel(clear.view_mut(), law, |pixel, (gain, backscatter)| {
        for c in 0..3 {
            pixel[c] = (pixel[c] - backscatter[c]) * gain[c];
        }
    });
    Ok(clear)
}

/// [`restore`] in place: the image becomes the restored one, rounded once and clipped, and nothing is allocated.
///
/// # Errors
///
/// [`ImageError`] when image and depth map differ in size; the image is then unchanged.
pub fn restore_mut<'a, T: Sample, E: Encoding>(
    image: impl Into<ImageMut<'a, T, E>>,
    depth: &DepthMap,
    water: &Waterbody<E>,
    options: &RestoreOptions,
) -> Result<Clipping, ImageError> {
    restore_by_mut(image.into(), depth, undoing(depth.measured_to(), water, options))
}

/// [`restore_mut`] by gain and backscatter at a distance.
fn restore_by_mut<T: Sample, E: Encoding>(
    image: ImageMut<'_, T, E>,
    depth: &DepthMap,
    law: impl Fn(f32) -> ([f32; 3], [f32; 3]) + Sync,
) -> Result<Clipping, ImageError> {
    depth.check_fits(image.size())?;
    let count = image.width() as u64 * image.height() as u64;
    let change = |pixel: &mut [T; 3], (gain, backscatter): ([f32; 3], [f32; 3]), clipped: &mut [u64; 3]| {
        for c in 0..3 {
            let (value, is_clipped) = pixel[c].changed(gain[c], -gain[c] * backscatter[c]);
            pixel[c] = value;
            clipped[c] += u64::from(is_clipped);
        }
    };
    let add = |a: [u64; 3], b: [u64; 3]| std::array::from_fn(|c| a[c] + b[c]);
    let values = depth.sum_over_pixels(image, law, change, add);
    Ok(Clipping { values, pixels: count })
}

/// Gain and backscatter at a distance, those of `measured_to` beyond it.
fn undoing<E: Encoding>(
    measured_to: f32,
    water: &Waterbody<E>,
    options: &RestoreOptions,
) -> impl Fn(f32) -> ([f32; 3], [f32; 3]) {
    // A bound below 1 would darken; `max` also takes a NaN to the safe side.
    let max_gain = options.max_gain.map(|gain| gain.max(1.0));
    move |z| {
        let z = z.min(measured_to);
        let left = water.illumination(z);
        (std::array::from_fn(|c| left[c].recip().min(max_gain[c])), water.backscatter(z))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::depth::{Supplied, SuppliedKind};
    use crate::image::{Encoded, TopEdge};
    use crate::truth::{Scene, Size, waters};

    #[test]
    fn beyond_what_was_measured_the_water_stays() {
        let (scene, water) = (Scene::new(1, Size { width: 96, height: 64 }), waters()[0].water);
        let seen: Image<u8, Encoded> = scene.seen_through(&water).convert();
        let distances = scene.depth.distances();
        let of = |values: Vec<f32>| {
            let map = Supplied::new(96, 64, values, SuppliedKind::Metres).unwrap();
            let depth = map.seen_with(&seen, TopEdge::First).unwrap().depth;
            (restore(&seen, &depth, &water, &RestoreOptions::default()).unwrap(), depth)
        };
        let (whole, _) = of(distances.clone());
        // The farther half has no depth, as structure from motion leaves open water.
        let mut sorted = distances.clone();
        sorted.sort_by(f32::total_cmp);
        let middle = sorted[sorted.len() / 2];
        let (part, depth) = of(distances.iter().map(|&z| if z < middle { z } else { 0.0 }).collect());
        assert!(depth.measured_to() <= middle);
        for (i, z) in distances.iter().enumerate() {
            if *z <= depth.measured_to() {
                assert_eq!(part.pixels()[i], whole.pixels()[i]);
            }
        }
        let farthest = (0..distances.len()).max_by(|&a, &b| distances[a].total_cmp(&distances[b])).unwrap();
        assert!(part.pixels()[farthest][2] > whole.pixels()[farthest][2] + 0.05, "open water has gone black");
    }
}
