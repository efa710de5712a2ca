//! An image taken in air, put under water (Eq. 1).

use aquafuse::depth::DepthMap;
use aquafuse::formation::form;
use aquafuse::image::{Encoding, Image, ImageError};
use aquafuse::waterbody::Waterbody;

use super::{WaterEstimate, with_estimate};
use crate::image_file::Pixels;

/// Bytes a pixel that [`simulate`] takes beside the image: lit, formed and encoded in floats.
pub const SIMULATED: u64 = 56;

/// Puts the scene of an image that was taken in air under water, in the encoding of the water.
///
/// `light` is the light on the scene relative to the light it was taken in, linear, of red, green and blue; 1 leaves it
/// as it is. Then Eq. 1 is evaluated at every pixel, `U = I e^(-β_D z) + B∞ (1 - e^(-β_B z))`; coefficients are per unit
/// of the depth map's z.
///
/// # Errors
///
/// [`ImageError`] when pixels and depth map differ in size; the pixels are then unchanged.
pub fn simulate(
    pixels: &mut Pixels,
    depth: &DepthMap,
    water: &WaterEstimate,
    light: [f32; 3],
) -> Result<(), ImageError> {
    let lit = lit(pixels, light);
    let formed = with_estimate!(water, estimate => formed(&lit, depth, &estimate.water))?;
    match pixels {
        Pixels::Bytes(layers) => layers.image = formed.convert(),
        Pixels::Words(layers) => layers.image = formed.convert(),
        Pixels::Floats(layers) => layers.image = formed.convert(),
    }
    Ok(())
}

fn formed<E: Encoding>(
    lit: &Image<f32>,
    depth: &DepthMap,
    water: &Waterbody<E>,
) -> Result<Image<f32>, ImageError> {
    let (width, height) = lit.size();
    let clear = lit.as_raw().iter().map(|&value| E::from_encoded(value)).collect();
    let clear = Image::<f32, E>::from_raw(width, height, clear)?;
    Ok(form(&clear, depth, water)?.to_encoded())
}

/// The image as lit by this light, relative to the light it was taken in.
fn lit(pixels: &Pixels, light: [f32; 3]) -> Image<f32> {
    let image = match pixels {
        Pixels::Bytes(layers) => layers.image.to_unit(),
        Pixels::Words(layers) => layers.image.to_unit(),
        Pixels::Floats(layers) => layers.image.to_unit(),
    };
    if light == [1.0; 3] {
        return image;
    }
    let mut linear = image.to_linear();
    for pixel in linear.pixels_mut() {
        for (value, light) in pixel.iter_mut().zip(light) {
            *value *= light;
        }
    }
    linear.to_encoded()
}
