//! A cloud of points as PLY: places and colours, what every viewer of point clouds reads.

use std::io::Write;
use std::path::Path;

use aquafuse_data::files::write_bytes;

use super::SceneFileError;
use crate::points::Point;

/// Writes points as a PLY file, whole or not at all.
///
/// # Errors
///
/// [`SceneFileError`] when the file exists and may not be replaced, or the system refuses.
pub fn write_cloud(path: &Path, points: &[Point], overwrite: bool) -> Result<(), SceneFileError> {
    Ok(write_bytes(path, &cloud_bytes(points), overwrite)?)
}

fn cloud_bytes(points: &[Point]) -> Vec<u8> {
    let mut bytes = Vec::new();
    // Writing to memory does not fail.
    let _ = write!(bytes, "ply\nformat binary_little_endian 1.0\nelement vertex {}\n", points.len());
    for name in ["x", "y", "z"] {
        let _ = writeln!(bytes, "property double {name}");
    }
    for name in ["red", "green", "blue"] {
        let _ = writeln!(bytes, "property uchar {name}");
    }
    bytes.extend(b"end_header\n");
    for point in points {
        bytes.extend(point.position.iter().flat_map(|value| value.to_le_bytes()));
        bytes.extend(point.colour.map(byte));
    }
    bytes
}

#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "of floats this alone makes whole numbers; what lies outside becomes the nearest one inside"
)]
fn byte(value: f64) -> u8 {
    (255.0 * value).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_is_three_doubles_and_three_bytes() {
        let bytes = cloud_bytes(&[Point { position: [1.0, -2.0, 0.5], colour: [0.0, 0.2, 1.5] }]);
        let header = bytes.windows(11).position(|window| window == b"end_header\n").unwrap() + 11;
        assert_eq!(bytes.len() - header, 27);
        assert_eq!(bytes[header + 8..header + 16], (-2.0_f64).to_le_bytes());
        assert_eq!(bytes[header + 24..], [0, 51, 255]);
        assert!(String::from_utf8_lossy(&bytes[..header]).contains("element vertex 1\n"));
    }
}
