//! Splats as `.splat`: 32 bytes each, no harmonics, what web viewers load.

use std::path::Path;

use aquafuse_data::files::write_bytes;

use super::SceneFileError;
use crate::splats::Splats;

/// Writes splats as a `.splat` file, whole or not at all.
///
/// # Errors
///
/// [`SceneFileError`] when the file exists and may not be replaced, or the system refuses.
pub fn write_splat(path: &Path, splats: &Splats<f32>, overwrite: bool) -> Result<(), SceneFileError> {
    Ok(write_bytes(path, &splat_bytes(splats), overwrite)?)
}

/// The bytes of such a file: place and deviations as floats, colour, opacity and quaternion as bytes; the largest and
/// most opaque first, so that a file that is still loading already shows something.
pub fn splat_bytes(splats: &Splats<f32>) -> Vec<u8> {
    let weight =
        |i: usize| splats.scale(i).into_iter().fold(splats.opacity(i), |weight, scale| weight * scale);
    let mut order: Vec<usize> = (0..splats.len()).collect();
    order.sort_by(|&a, &b| weight(b).total_cmp(&weight(a)).then(a.cmp(&b)));
    let mut bytes = Vec::with_capacity(splats.len().saturating_mul(32));
    for i in order {
        for value in splats.mean(i).into_iter().chain(splats.scale(i)) {
            bytes.extend(value.to_le_bytes());
        }
        bytes.extend(splats.colour(i).map(|value| byte(255.0 * value)));
        bytes.push(byte(255.0 * splats.opacity(i)));
        bytes.extend(splats.rotation(i).map(|q| byte(q * 128.0 + 128.0)));
    }
    bytes
}

#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "of floats this alone makes whole numbers; what lies outside becomes the nearest one inside"
)]
fn byte(value: f32) -> u8 {
    value.round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_splat_is_32_bytes_and_the_largest_comes_first() {
        let mut splats = Splats::<f32>::new(0);
        splats.push(&Splats::<f32>::ball(0, [1.0, 2.0, 3.0], 0.1, 0.5, [0.0, 0.5, 1.0]));
        splats.push(&Splats::<f32>::ball(0, [4.0, 5.0, 6.0], 0.5, 0.9, [1.0, 0.0, 0.2]));
        let bytes = splat_bytes(&splats);
        assert_eq!(bytes.len(), 64);
        assert_eq!(bytes[..4], 4.0_f32.to_le_bytes());
        assert_eq!(bytes[24..32], [255, 0, 51, 230, 255, 128, 128, 128]);
        assert_eq!(bytes[32 + 24..], [0, 128, 255, 128, 255, 128, 128, 128]);
    }
}
