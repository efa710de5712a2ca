//! `transforms.json`, as NeRF and its successors keep cameras.

use std::path::Path;

use serde::Deserialize;

use super::SceneFileError;
use super::cameras::{Intrinsics, PosedImage, inside};

/// A frame, or the whole file: a frame's own numbers come before the file's.
#[derive(Clone, Debug, Default, Deserialize)]
struct Numbers {
    camera_angle_x: Option<f64>,
    camera_angle_y: Option<f64>,
    fl_x: Option<f64>,
    fl_y: Option<f64>,
    cx: Option<f64>,
    cy: Option<f64>,
    w: Option<f64>,
    h: Option<f64>,
    k1: Option<f64>,
    k2: Option<f64>,
    p1: Option<f64>,
    p2: Option<f64>,
}

/// The pose of a frame.
#[derive(Deserialize)]
struct Pose {
    file_path: String,
    transform_matrix: [[f64; 4]; 4],
}

/// One side of all frames. A frame's numbers are read apart from its pose, and the file's from both: flattened into one
/// another, they would keep whatever else stands beside them, in several hundred times its length.
#[derive(Deserialize)]
struct Frames<T> {
    frames: Vec<T>,
}

/// How far a rotation's rows may be from unit length and right angles.
const CROOKED: f64 = 1e-3;

pub(crate) fn read(path: &Path, bytes: &[u8]) -> Result<Vec<PosedImage>, SceneFileError> {
    let failed = |error: serde_json::Error| {
        SceneFileError::line(path, error.line(), format!("it is not as expected: {error}"))
    };
    let shared: Numbers = serde_json::from_slice(bytes).map_err(failed)?;
    let poses: Frames<Pose> = serde_json::from_slice(bytes).map_err(failed)?;
    let numbers: Frames<Numbers> = serde_json::from_slice(bytes).map_err(failed)?;
    let frames = poses.frames.iter().zip(&numbers.frames).zip(1_usize..);
    frames
        .map(|((pose, own), number)| {
            pose.posed(own, &shared).map_err(|cause| {
                SceneFileError::content(path, format!("frame {number}: {cause}. Export the cameras again"))
            })
        })
        .collect()
}

impl Pose {
    fn posed(&self, own: &Numbers, shared: &Numbers) -> Result<PosedImage, String> {
        let get = |of: fn(&Numbers) -> Option<f64>| of(own).or_else(|| of(shared));
        let side = |of: fn(&Numbers) -> Option<f64>, name: &str| {
            let length =
                get(of).ok_or_else(|| format!("neither it nor the file has {name:?}, the image's size"))?;
            whole(length).ok_or_else(|| format!("{name:?} is {length}, no count of pixels"))
        };
        let (width, height) = (side(|n| n.w, "w")?, side(|n| n.h, "h")?);
        let (columns, rows) = (f64::from(width), f64::from(height));
        let by_angle =
            |angle: Option<f64>, pixels: f64| angle.map(|angle| 0.5 * pixels / (0.5 * angle).tan());
        let fx = get(|n| n.fl_x).or_else(|| by_angle(get(|n| n.camera_angle_x), columns));
        let fx = fx.ok_or("neither it nor the file has \"fl_x\" or \"camera_angle_x\"")?;
        let fy = get(|n| n.fl_y).or_else(|| by_angle(get(|n| n.camera_angle_y), rows)).unwrap_or(fx);
        let centre = [get(|n| n.cx).unwrap_or(0.5 * columns), get(|n| n.cy).unwrap_or(0.5 * rows)];
        let distortion =
            [get(|n| n.k1), get(|n| n.k2), get(|n| n.p1), get(|n| n.p2)].map(|k| k.unwrap_or(0.0));
        let camera = Intrinsics::new(width.into(), height.into(), [fx, fy], centre, distortion)?;

        // From the camera to the world, the camera's y up and its z towards the one who looks: turned over.
        let [x, y, z, _] = self.transform_matrix;
        let rotation = [[x[0], y[0], z[0]], [-x[1], -y[1], -z[1]], [-x[2], -y[2], -z[2]]];
        let product = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let [a, b, c] = rotation;
        let straight =
            [product(a, a) - 1.0, product(b, b) - 1.0, product(c, c) - 1.0, product(a, b), product(a, c)];
        if !straight.iter().all(|off| off.abs() < CROOKED) {
            return Err("its \"transform_matrix\" is no rotation".into());
        }
        let position = [x[3], y[3], z[3]];
        let translation = rotation.map(|row| -product(row, position));
        let name = self.file_path.strip_prefix("./").unwrap_or(&self.file_path);
        let mut name = inside(name)?;
        if name.extension().is_none() {
            name.set_extension("png");
        }
        Ok(PosedImage { name, lens: camera.turned(rotation, translation)? })
    }
}

/// A count that JSON may have written with a point.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "it was held against the range before"
)]
fn whole(value: f64) -> Option<u32> {
    (value.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&value)).then_some(value as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str = r#"{"camera_angle_x": 1.5707963267948966, "w": 40, "h": 30.0, "frames": [
        {"file_path": "./train/r_0", "transform_matrix": [[1,0,0,2],[0,1,0,3],[0,0,1,4],[0,0,0,1]]}]}"#;

    #[test]
    fn a_frame_looks_along_minus_z_with_y_up() {
        let posed = read(Path::new("t.json"), FILE.as_bytes()).unwrap();
        let camera = &posed[0].lens.camera;
        assert_eq!(posed[0].name, Path::new("train/r_0.png"));
        assert!((camera.focal[0] - 20.0).abs() < 1e-12);
        assert_eq!(camera.position(), [2.0, 3.0, 4.0]);
        // Two ahead and one up of it.
        assert_eq!(camera.to_camera([2.0, 4.0, 2.0]), [0.0, -1.0, 2.0]);
    }

    #[test]
    fn what_is_wrong_is_named() {
        let of = |from: &str, to: &str| {
            read(Path::new("t.json"), FILE.replace(from, to).as_bytes()).unwrap_err().to_string()
        };
        assert!(of("\"w\": 40, ", "").contains("frame 1: neither it nor the file has \"w\""));
        assert!(of("40", "1e30").contains("no count of pixels"));
        assert!(of("[[1,0", "[[2,0").contains("no rotation"));
        assert!(of("./train", "../train").contains("leads out"));
        assert!(of("]}", "").contains("t.json, line 2"));
    }
}
