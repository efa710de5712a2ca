//! COLMAP's models as text: one thing a line, `#` before a remark.

mod write;

use std::collections::BTreeMap;
use std::path::Path;
use std::str::FromStr;

use aquafuse_data::image_file::ReadOptions;

use super::cameras::{Cameras, Intrinsics, PosedImage, inside, model, point};
use super::{SceneFileError, bytes};
use crate::points::Point;

pub use write::write_cameras;

/// Reads `cameras.txt`, `images.txt` and `points3D.txt` of a folder.
pub(super) fn read(folder: &Path, reading: &ReadOptions) -> Result<Cameras, SceneFileError> {
    let parse = |name: &str| -> Result<_, SceneFileError> {
        let path = folder.join(name);
        let bytes = bytes::read(&path, reading)?;
        let text = String::from_utf8(bytes);
        let text =
            text.map_err(|_| SceneFileError::content(&path, "it is no text. Export the model again"))?;
        Ok((path, text))
    };
    let (path, text) = parse("cameras.txt")?;
    let intrinsics = cameras(&path, &text)?;
    let (path, text) = parse("images.txt")?;
    let posed = images(&path, &text, &intrinsics)?;
    let (path, text) = parse("points3D.txt")?;
    Ok(Cameras { images: posed, points: points(&path, &text)?, ..Cameras::default() })
}

/// Lines that are no remark, with their numbers from 1.
fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    text.lines()
        .zip(1_usize..)
        .map(|(line, number)| (number, line.trim()))
        .filter(|(_, line)| !line.starts_with('#'))
}

/// The fields of a line.
struct Fields<'a>(std::str::SplitWhitespace<'a>);

impl<'a> Fields<'a> {
    fn new(line: &'a str) -> Self {
        Self(line.split_whitespace())
    }

    fn word(&mut self, what: &str) -> Result<&'a str, String> {
        self.0.next().ok_or_else(|| format!("it ends before {what}"))
    }

    fn value<V: FromStr>(&mut self, what: &str) -> Result<V, String> {
        let word = self.word(what)?;
        word.parse().map_err(|_| format!("{word:?} is no {what}"))
    }

    fn values<const N: usize>(&mut self, what: &str) -> Result<[f64; N], String> {
        let mut values = [0.0; N];
        for value in &mut values {
            *value = self.value(what)?;
        }
        Ok(values)
    }
}

fn cameras(path: &Path, text: &str) -> Result<BTreeMap<u32, Intrinsics>, SceneFileError> {
    let camera = |line: &str| -> Result<(u32, Intrinsics), String> {
        let mut fields = Fields::new(line);
        let id = fields.value("CAMERA_ID")?;
        let name = fields.word("MODEL")?;
        let (name, count) = model(|known, _| known == name)?;
        let (width, height) = (fields.value("WIDTH")?, fields.value("HEIGHT")?);
        let parameters: Vec<f64> =
            (0..count).map(|_| fields.value("parameter of a camera")).collect::<Result<_, _>>()?;
        Ok((id, Intrinsics::colmap(name, width, height, &parameters)?))
    };
    let parsed = lines(text).filter(|(_, line)| !line.is_empty());
    parsed
        .map(|(number, line)| camera(line).map_err(|cause| SceneFileError::line(path, number, cause)))
        .collect()
}

/// Two lines an image; the second, its points, may be empty and is not needed.
fn images(
    path: &Path,
    text: &str,
    intrinsics: &BTreeMap<u32, Intrinsics>,
) -> Result<Vec<PosedImage>, SceneFileError> {
    let image = |line: &str| -> Result<PosedImage, String> {
        let mut fields = Fields::new(line);
        let _: u32 = fields.value("IMAGE_ID")?;
        let (quaternion, translation) =
            (fields.values("part of a quaternion")?, fields.values("part of a place")?);
        let camera: u32 = fields.value("CAMERA_ID")?;
        // A name may have spaces in it.
        let name = fields.0.collect::<Vec<_>>().join(" ");
        let known = intrinsics.get(&camera).ok_or_else(|| format!("there is no camera {camera}"))?;
        Ok(PosedImage { name: inside(&name)?, lens: known.posed(quaternion, translation)? })
    };
    let mut lines = lines(text);
    let mut posed = Vec::new();
    while let Some((number, line)) = lines.next() {
        if line.is_empty() {
            continue;
        }
        posed.push(image(line).map_err(|cause| SceneFileError::line(path, number, cause))?);
        lines.next();
    }
    Ok(posed)
}

fn points(path: &Path, text: &str) -> Result<Vec<Point>, SceneFileError> {
    let parsed = |line: &str| -> Result<Point, String> {
        let mut fields = Fields::new(line);
        let _: u64 = fields.value("POINT3D_ID")?;
        let position = fields.values("part of a place")?;
        let mut colour = || fields.value("part of a colour, 0 to 255");
        point(position, [colour()?, colour()?, colour()?])
    };
    let lines = lines(text).filter(|(_, line)| !line.is_empty());
    lines
        .map(|(number, line)| parsed(line).map_err(|cause| SceneFileError::line(path, number, cause)))
        .collect()
}

/// Reads a text as each of the three files: a target of fuzzing.
#[cfg(feature = "fuzz-targets")]
pub(crate) fn try_parse(path: &Path, text: &str) -> [Result<(), SceneFileError>; 3] {
    let known = Intrinsics::colmap("PINHOLE", 8, 6, &[5.0, 5.0, 4.0, 3.0]);
    let known = known.map(|camera| (1, camera)).into_iter().collect();
    [cameras(path, text).map(drop), images(path, text, &known).map(drop), points(path, text).map(drop)]
}

#[cfg(test)]
mod tests {
    use super::*;

    const CAMERAS: &str =
        "# remark\n1 SIMPLE_RADIAL 1280 720 633.7 640 360 -0.0377\n3 PINHOLE 10 8 5 6 5 4\n";

    #[test]
    fn a_model_is_read() {
        let path = Path::new("cameras.txt");
        let known = cameras(path, CAMERAS).unwrap();
        assert_eq!(known[&1].distortion, [-0.0377, 0.0, 0.0, 0.0]);
        assert_eq!(known[&3].focal, [5.0, 6.0]);
        // The points of the first image are an empty line, its name has a space.
        let text = "14 2 0 0 0 .5 1 2 3 a b.jpg\n\n15 1 0 0 0 0 0 0 1 dir/c.jpg\n1 2 3\n";
        let posed = images(path, text, &known).unwrap();
        assert_eq!(posed.len(), 2);
        assert_eq!(posed[0].name, Path::new("a b.jpg"));
        assert_eq!(posed[0].lens.camera.rotation[0], [1.0, 0.0, 0.0]);
        assert_eq!(posed[0].lens.camera.translation, [0.5, 1.0, 2.0]);
        let points = points(path, "10 1.5 -2 3 255 0 51 .8 15 22 14 34\n").unwrap();
        assert_eq!(points, [Point { position: [1.5, -2.0, 3.0], colour: [1.0, 0.0, 0.2] }]);
    }

    #[test]
    fn what_is_wrong_is_named_with_its_line() {
        let path = Path::new("scene/cameras.txt");
        let said = |error: SceneFileError| error.to_string();
        let of = |text: &str| said(cameras(path, text).unwrap_err());
        assert!(
            of("# a\n1 FISHEYE 2 2 1 1 1")
                .starts_with("scene/cameras.txt, line 2: a camera model that is none of")
        );
        assert!(of("1 PINHOLE 10 8 5 6 5").contains("line 1: it ends before parameter"));
        assert!(of("1 PINHOLE 0 8 5 6 5 4").contains("0x8 pixels"));
        assert!(of("1 PINHOLE 10 8 -5 6 5 4").contains("focal length"));
        assert!(of("1 PINHOLE 10 8 NaN 6 5 4").contains("focal length"));
        let known = cameras(path, CAMERAS).unwrap();
        let of = |text: &str| said(images(path, text, &known).unwrap_err());
        assert!(of("1 1 0 0 0 0 0 0 9 a.jpg\n").contains("no camera 9"));
        assert!(of("1 0 0 0 0 0 0 0 1 a.jpg\n").contains("quaternion"));
        assert!(of("1 1 0 0 0 0 inf 0 1 a.jpg\n").contains("nowhere"));
        for name in ["../a.jpg", "/etc/a.jpg", "", "a/../../b"] {
            assert!(of(&format!("1 1 0 0 0 0 0 0 1 {name}\n")).contains("leads out"), "{name}");
        }
    }
}
