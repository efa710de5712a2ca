//! CIE 1976 L*a*b*.

use crate::image::{Encoding, Linear, Sample};
use crate::simd;

/// From linear light to XYZ: the primaries of sRGB (IEC 61966-2-1), and the white they add up to.
const TO_XYZ: [[f64; 3]; 3] =
    [[0.412453, 0.357580, 0.180423], [0.212671, 0.715160, 0.072169], [0.019334, 0.119193, 0.950227]];
const WHITE: [f64; 3] = [0.95047, 1.0, 1.08883];

/// Converts an encoded sRGB colour, values in `[0, 1]`, to CIE 1976 L*a*b* (D65, 2°).
///
/// L* lies in `[0, 100]`. The Euclidean distance between two colours is their ΔE (CIE76); 2.3 is about what the eye just sees.
///
/// # Examples
///
/// ```
/// use aquafuse::metrics::lab;
///
/// let [lightness, a, b] = lab([0.5; 3]);
/// assert!((lightness - 53.4).abs() < 0.1 && a.hypot(b) < 0.01, "a middle grey has no colour");
/// ```
#[must_use]
pub fn lab(encoded: [f32; 3]) -> [f64; 3] {
    lab_of_light(encoded.map(Linear::from_encoded))
}

/// The mean distance in CIELab (ΔE, CIE76) of pixels from others, place by place; 0 of none.
///
/// 2.3 is about what the eye just sees; black and white are 100 apart.
///
/// # Panics
///
/// When there are not as many others.
///
/// # Examples
///
/// ```
/// use aquafuse::metrics::colour_difference;
///
/// let grey = [[100_u8; 3]; 5];
/// assert_eq!(colour_difference(&grey, &grey), 0.0);
/// assert!(colour_difference(&grey, &[[110; 3]; 5]) > 2.3, "ten steps are seen");
/// ```
#[must_use]
pub fn colour_difference<T: Sample>(pixels: &[[T; 3]], others: &[[T; 3]]) -> f64 {
    assert_eq!(pixels.len(), others.len(), "as many others");
    let sum: f64 = match (T::bytes(pixels.as_flattened()), T::bytes(others.as_flattened())) {
        (Some(pixels), Some(others)) => {
            let light = light_of_bytes();
            let of = |byte: u8| light[usize::from(byte)];
            distances(pixels.as_chunks().0, others.as_chunks().0, of)
        }
        _ => distances(pixels, others, |value: T| Linear::from_encoded(value.to_unit())),
    };
    sum / pixels.len().max(1) as f64
}

/// The linear light behind each byte.
pub(super) fn light_of_bytes() -> [f32; 256] {
    std::array::from_fn(|byte| Linear::from_encoded((byte as u8).to_unit()))
}

/// Pixels that are computed with at once.
const BLOCK: usize = 64;

/// The sum of the distances, by the light behind a value.
fn distances<T: Copy>(pixels: &[[T; 3]], others: &[[T; 3]], light_of: impl Fn(T) -> f32) -> f64 {
    let mut light = [[[0.0_f32; 3]; BLOCK]; 2];
    let mut sum = 0.0;
    for blocks in pixels.chunks(BLOCK).zip(others.chunks(BLOCK)) {
        for (light, block) in light.iter_mut().zip([blocks.0, blocks.1]) {
            for (light, pixel) in light.iter_mut().zip(block) {
                *light = pixel.map(&light_of);
            }
        }
        sum += simd::widest(Distances(&light))[..blocks.0.len()].iter().sum::<f64>();
    }
    sum
}

/// The distances of two blocks of linear light.
struct Distances<'a>(&'a [[[f32; 3]; BLOCK]; 2]);

impl simd::Work for Distances<'_> {
    type Output = [f64; BLOCK];

    #[inline(always)]
    fn run(self) -> [f64; BLOCK] {
        let [pixels, others] = self.0;
        let mut distances = [0.0; BLOCK];
        for i in 0..BLOCK {
            let (a, b) = (lab_of_light(pixels[i]), lab_of_light(others[i]));
            let off = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
            distances[i] = (off[0] * off[0] + off[1] * off[1] + off[2] * off[2]).sqrt();
        }
        distances
    }
}

/// [`lab`] of linear light.
#[inline(always)]
pub(super) fn lab_of_light([r, g, b]: [f32; 3]) -> [f64; 3] {
    let [r, g, b] = [f64::from(r), f64::from(g), f64::from(b)];
    let of = |i: usize| compressed((TO_XYZ[i][0] * r + TO_XYZ[i][1] * g + TO_XYZ[i][2] * b) / WHITE[i]);
    let (x, y, z) = (of(0), of(1), of(2));
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// The cube root, with a line where it would be too steep.
#[inline(always)]
fn compressed(light: f64) -> f64 {
    if light > 0.008856 { cube_root(light) } else { 7.787 * light + 16.0 / 116.0 }
}

/// The cube root of a number above 0: a guess from the exponent of a float, and Halley's steps, each of which trebles its digits. The
/// library's takes ten times as long, and makes no vectors.
#[inline(always)]
fn cube_root(of: f64) -> f64 {
    let guess = f32::from_bits((of as f32).to_bits() / 3 + 709_921_077);
    let closer = |root: f64| {
        let cube = root * root * root;
        root * (cube + 2.0 * of) / (2.0 * cube + of)
    };
    closer(closer(closer(f64::from(guess))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cube_roots_are_those_of_the_library() {
        for light in (1..=2000).map(|i| f64::from(i) / 1000.0).chain([0.008857, 1.08883]) {
            let (found, root) = (cube_root(light), light.cbrt());
            assert!((found / root - 1.0).abs() < 1e-15, "{found} for {root}");
        }
    }

    #[test]
    fn the_mean_difference_of_any_samples_is_that_of_their_colours() {
        let pixels: Vec<[u8; 3]> = (0..200_u8).map(|i| [i, i.wrapping_mul(7), 200 - i]).collect();
        let others: Vec<[u8; 3]> = pixels.iter().map(|[r, g, b]| [*b, *r, *g]).collect();
        let distance = |(a, b): (&[u8; 3], &[u8; 3])| {
            let [a, b] = [a, b].map(|pixel| lab(pixel.map(Sample::to_unit)));
            a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
        };
        let expected = pixels.iter().zip(&others).map(distance).sum::<f64>() / 200.0;
        assert!((colour_difference(&pixels, &others) - expected).abs() < 1e-9);
        let [pixels, others] = [pixels, others]
            .map(|of| -> Vec<[f32; 3]> { of.iter().map(|pixel| pixel.map(Sample::to_unit)).collect() });
        assert!((colour_difference(&pixels, &others) - expected).abs() < 1e-9);
        assert_eq!(colour_difference::<u8>(&[], &[]), 0.0);
    }

    #[test]
    fn the_primaries_have_their_tabled_colours() {
        // B. Lindbloom's values for D65, which is as far off as the rounding of the matrix.
        for (rgb, expected) in [
            ([1.0, 0.0, 0.0], [53.24, 80.09, 67.20]),
            ([0.0, 1.0, 0.0], [87.73, -86.18, 83.18]),
            ([0.0, 0.0, 1.0], [32.30, 79.19, -107.86]),
        ] {
            for (found, expected) in lab(rgb).iter().zip(expected) {
                assert!((found - expected).abs() < 0.02, "{found} for {expected}");
            }
        }
    }
}
