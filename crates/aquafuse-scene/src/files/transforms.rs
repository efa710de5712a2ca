//! `transforms.json`, as NeRF and its successors keep cameras.

use std::path::{Path, PathBuf};

use aquafuse_data::files::{display, write_text};
use serde::Deserialize;
use serde_json::json;

use super::SceneFileError;
use super::cameras::{Intrinsics, OTHER_MODEL, PosedImage, inside};
use crate::camera::Camera;

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
    /// Further terms, which our model does not have.
    k3: Option<f64>,
    k4: Option<f64>,
    k5: Option<f64>,
    k6: Option<f64>,
    is_fisheye: Option<bool>,
    camera_model: Option<Model>,
}

/// A camera model by its name.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
enum Model {
    SimplePinhole,
    Pinhole,
    Perspective,
    SimpleRadial,
    Radial,
    Opencv,
    #[serde(other)]
    Other,
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

/// What the size of an image is, where neither frame nor file says it.
type SizeOf<'a> = &'a dyn Fn(&Path) -> Option<(u64, u64)>;

pub(crate) fn read(
    path: &Path,
    bytes: &[u8],
    size_of: SizeOf<'_>,
) -> Result<Vec<PosedImage>, SceneFileError> {
    let failed = |error: serde_json::Error| {
        SceneFileError::line(path, error.line(), format!("it is not as expected: {error}"))
    };
    let shared: Numbers = serde_json::from_slice(bytes).map_err(failed)?;
    let poses: Frames<Pose> = serde_json::from_slice(bytes).map_err(failed)?;
    let numbers: Frames<Numbers> = serde_json::from_slice(bytes).map_err(failed)?;
    let frames = poses.frames.iter().zip(&numbers.frames).zip(1_usize..);
    frames
        .map(|((pose, own), number)| {
            pose.posed(own, &shared, size_of).map_err(|cause| {
                SceneFileError::content(path, format!("frame {number}: {cause}. Export the cameras again"))
            })
        })
        .collect()
}

/// Writes cameras as `transforms.json`, as nerfstudio reads it, whole or not at all. Images lie in the folder `images`, relative
/// to the file's own. A file that holds the same already is left as it is.
///
/// # Errors
///
/// [`SceneFileError`] when a name is no UTF-8, another file exists and may not be replaced, or the system refuses.
pub fn write_transforms(
    path: &Path,
    posed: &[PosedImage],
    images: &Path,
    overwrite: bool,
) -> Result<(), SceneFileError> {
    let frames = posed.iter().map(|one| {
        let name = images.join(&one.name);
        let Some(name) = name.to_str() else {
            let cause = format!("the name {} is no UTF-8; rename the image", display(&one.name));
            return Err(SceneFileError::content(path, cause));
        };
        let Camera { width, height, focal: [fx, fy], centre: [cx, cy], rotation, .. } = &one.lens.camera;
        let ([right, down, ahead], [x, y, z]) = (rotation, one.lens.camera.position());
        let row = |[right, down, ahead]: [f64; 3], at: f64| [right, -down, -ahead, at];
        let matrix = [
            row([right[0], down[0], ahead[0]], x),
            row([right[1], down[1], ahead[1]], y),
            row([right[2], down[2], ahead[2]], z),
            [0.0, 0.0, 0.0, 1.0],
        ];
        let [k1, k2, p1, p2] = one.lens.distortion;
        Ok(json!({
            "file_path": name.replace('\\', "/"), "transform_matrix": matrix,
            "w": width, "h": height, "fl_x": fx, "fl_y": fy, "cx": cx, "cy": cy,
            "k1": k1, "k2": k2, "p1": p1, "p2": p2,
        }))
    });
    let frames: Vec<serde_json::Value> = frames.collect::<Result<_, _>>()?;
    let text = format!("{:#}\n", json!({ "camera_model": "OPENCV", "frames": frames }));
    let holds = || std::fs::read(path).is_ok_and(|held| held == text.as_bytes());
    if !overwrite && holds() { Ok(()) } else { Ok(write_text(path, &text, overwrite)?) }
}

impl Pose {
    /// The name of its image. Windows writes folders with backslashes, Blender leaves the extension out.
    fn name(&self) -> Result<PathBuf, String> {
        let mut name = inside(&self.file_path.replace('\\', "/"))?;
        if name.extension().is_none() {
            name.set_extension("png");
        }
        Ok(name)
    }

    fn posed(&self, own: &Numbers, shared: &Numbers, size_of: SizeOf<'_>) -> Result<PosedImage, String> {
        let name = self.name()?;
        let get = |of: fn(&Numbers) -> Option<f64>| of(own).or_else(|| of(shared));
        let side = |length: f64, name: &str| {
            whole(length).ok_or_else(|| format!("{name:?} is {length}, no count of pixels"))
        };
        let (width, height) = match (get(|n| n.w), get(|n| n.h)) {
            (Some(width), Some(height)) => (side(width, "w")?.into(), side(height, "h")?.into()),
            _ => size_of(&name).ok_or(
                "neither it nor the file has \"w\" and \"h\", the image's size, and the image cannot be read",
            )?,
        };
        let (columns, rows) = (width as f64, height as f64);
        let is_fisheye = own.is_fisheye.or(shared.is_fisheye).unwrap_or(false);
        let further: [fn(&Numbers) -> Option<f64>; 4] = [|n| n.k3, |n| n.k4, |n| n.k5, |n| n.k6];
        let is_other = matches!(own.camera_model.or(shared.camera_model), Some(Model::Other));
        if is_other || is_fisheye || further.into_iter().any(|k| get(k).is_some_and(|k| k != 0.0)) {
            return Err(format!("{OTHER_MODEL}, or undistort the images in the program that wrote the file"));
        }
        let by_angle =
            |angle: Option<f64>, pixels: f64| angle.map(|angle| 0.5 * pixels / (0.5 * angle).tan());
        let fx = get(|n| n.fl_x).or_else(|| by_angle(get(|n| n.camera_angle_x), columns));
        let fx = fx.ok_or("neither it nor the file has \"fl_x\" or \"camera_angle_x\"")?;
        let fy = get(|n| n.fl_y).or_else(|| by_angle(get(|n| n.camera_angle_y), rows)).unwrap_or(fx);
        let centre = [get(|n| n.cx).unwrap_or(0.5 * columns), get(|n| n.cy).unwrap_or(0.5 * rows)];
        let distortion =
            [get(|n| n.k1), get(|n| n.k2), get(|n| n.p1), get(|n| n.p2)].map(|k| k.unwrap_or(0.0));
        let camera = Intrinsics::new(width, height, [fx, fy], centre, distortion)?;

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
        let posed = read(Path::new("t.json"), FILE.as_bytes(), &|_| None).unwrap();
        let camera = &posed[0].lens.camera;
        assert_eq!(posed[0].name, Path::new("train/r_0.png"));
        assert!((camera.focal[0] - 20.0).abs() < 1e-12);
        assert_eq!(camera.position(), [2.0, 3.0, 4.0]);
        // Two ahead and one up of it.
        assert_eq!(camera.to_camera([2.0, 4.0, 2.0]), [0.0, -1.0, 2.0]);
    }

    #[test]
    fn what_a_file_does_not_say_is_read_from_the_image() {
        let text = FILE
            .replace("\"w\": 40, \"h\": 30.0", "\"k3\": 0, \"camera_model\": \"OPENCV\"")
            .replace("./train/r_0", "train\\\\r_0.jpg");
        let size_of = |name: &Path| (name == Path::new("train/r_0.jpg")).then_some((40, 30));
        let posed = read(Path::new("t.json"), text.as_bytes(), &size_of).unwrap();
        assert_eq!((posed[0].lens.camera.width, posed[0].lens.camera.height), (40, 30));
    }

    #[test]
    fn cameras_come_back_as_they_went() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("transforms.json");
        let text = FILE.replace("[[1,0,0,2],[0,1,0,3],[0,0,1,4]", "[[0,0,1,2],[0.6,0.8,0,3],[-0.8,0.6,0,4]");
        let mut posed = read(Path::new("t.json"), text.as_bytes(), &|_| None).unwrap();
        posed[0].lens.distortion = [0.1, -0.02, 0.003, 0.0];
        let write = |posed: &[PosedImage]| write_transforms(&path, posed, Path::new("images"), false);
        write(&posed).unwrap();
        write(&posed).unwrap();
        assert!(write(&[]).is_err());
        let found = read(&path, &std::fs::read(&path).unwrap(), &|_| None).unwrap();
        assert_eq!(found[0].name, Path::new("images/train/r_0.png"));
        let [a, b] = [&posed[0].lens, &found[0].lens];
        assert_eq!(
            (a.distortion, a.camera.focal, a.camera.centre),
            (b.distortion, b.camera.focal, b.camera.centre)
        );
        let flat = |lens: &crate::lens::Lens| {
            [lens.camera.rotation.as_flattened(), &lens.camera.translation].concat()
        };
        assert!(flat(a).iter().zip(flat(b)).all(|(a, b)| (a - b).abs() < 1e-12), "{a:?} {b:?}");
    }

    #[test]
    fn what_is_wrong_is_named() {
        let of = |from: &str, to: &str| {
            read(Path::new("t.json"), FILE.replace(from, to).as_bytes(), &|_| None).unwrap_err().to_string()
        };
        assert!(of("\"w\": 40, ", "").contains("frame 1: neither it nor the file has \"w\""));
        for model in
            ["\"camera_model\": \"OPENCV_FISHEYE\"", "\"is_fisheye\": true", "\"k3\": 0.01", "\"k4\": -0.1"]
        {
            let said = of("\"w\": 40", &format!("{model}, \"w\": 40"));
            assert!(said.contains("a camera model that is none of SIMPLE_PINHOLE, PINHOLE"), "{said}");
        }
        assert!(of("40", "1e30").contains("no count of pixels"));
        assert!(of("[[1,0", "[[2,0").contains("no rotation"));
        assert!(of("./train", "../train").contains("leads out"));
        assert!(of("]}", "").contains("t.json, line 2"));
    }
}
