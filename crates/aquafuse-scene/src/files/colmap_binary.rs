//! COLMAP's models as little-endian numbers.

use std::collections::BTreeMap;
use std::path::Path;

use aquafuse_data::image_file::ReadOptions;

use super::SceneFileError;
use super::bytes::{self, Bytes};
use super::cameras::{Cameras, Intrinsics, PosedImage, inside, model, point};
use crate::points::Point;

/// The least bytes of a camera (identity, model, width, height, three parameters), an image (identity, pose, camera,
/// an empty name, a count) and a point (identity, place, colour, error, a count); and those of an image's point and of
/// a step of a point's track.
const CAMERA: usize = 4 + 4 + 8 + 8 + 3 * 8;
const IMAGE: usize = 4 + 7 * 8 + 4 + 1 + 8;
const POINT: usize = 8 + 3 * 8 + 3 + 8 + 8;
const IMAGE_POINT: usize = 8 + 8 + 8;
const TRACK: usize = 4 + 4;

/// Reads `cameras.bin`, `images.bin` and `points3D.bin` of a folder.
pub(super) fn read(folder: &Path, reading: &ReadOptions) -> Result<Cameras, SceneFileError> {
    let path = folder.join("cameras.bin");
    let intrinsics = cameras(&path, &bytes::read(&path, reading)?)?;
    let path = folder.join("images.bin");
    let posed = images(&path, &bytes::read(&path, reading)?, &intrinsics)?;
    let path = folder.join("points3D.bin");
    Ok(Cameras { images: posed, points: points(&path, &bytes::read(&path, reading)?)?, ..Cameras::default() })
}

/// So many things, and nothing after them.
fn all<T>(
    bytes: &mut Bytes<'_>,
    each: usize,
    mut one: impl FnMut(&mut Bytes<'_>) -> Result<T, SceneFileError>,
) -> Result<Vec<T>, SceneFileError> {
    let count = bytes.count(each)?;
    let things = (0..count).map(|_| one(bytes)).collect::<Result<_, _>>()?;
    if bytes.is_at_end() { Ok(things) } else { Err(bytes.wrong("it goes on after its last entry")) }
}

fn doubles<const N: usize>(bytes: &mut Bytes<'_>) -> Result<[f64; N], SceneFileError> {
    let mut values = [0.0; N];
    for value in &mut values {
        *value = bytes.double()?;
    }
    Ok(values)
}

fn cameras(path: &Path, file: &[u8]) -> Result<BTreeMap<u32, Intrinsics>, SceneFileError> {
    let cameras = all(&mut Bytes::new(path, file), CAMERA, |bytes| {
        let (id, number) = (bytes.word()?, bytes.word()?);
        let (name, count) = model(|_, known| known == number).map_err(|cause| bytes.wrong(cause))?;
        let (width, height) = (bytes.long()?, bytes.long()?);
        let parameters: Vec<f64> = (0..count).map(|_| bytes.double()).collect::<Result<_, _>>()?;
        let camera =
            Intrinsics::colmap(name, width, height, &parameters).map_err(|cause| bytes.wrong(cause))?;
        Ok((id, camera))
    });
    Ok(cameras?.into_iter().collect())
}

fn images(
    path: &Path,
    file: &[u8],
    intrinsics: &BTreeMap<u32, Intrinsics>,
) -> Result<Vec<PosedImage>, SceneFileError> {
    all(&mut Bytes::new(path, file), IMAGE, |bytes| {
        let _identity = bytes.word()?;
        let (quaternion, translation) = (doubles(bytes)?, doubles(bytes)?);
        let camera = bytes.word()?;
        let name = bytes.text()?;
        let known =
            intrinsics.get(&camera).ok_or_else(|| bytes.wrong(format!("there is no camera {camera}")))?;
        let lens = known.posed(quaternion, translation).map_err(|cause| bytes.wrong(cause))?;
        let name = inside(&name).map_err(|cause| bytes.wrong(cause))?;
        let seen = bytes.count(IMAGE_POINT)?;
        bytes.skip(seen.saturating_mul(IMAGE_POINT))?;
        Ok(PosedImage { name, lens })
    })
}

fn points(path: &Path, file: &[u8]) -> Result<Vec<Point>, SceneFileError> {
    all(&mut Bytes::new(path, file), POINT, |bytes| {
        let _identity = bytes.long()?;
        let position = doubles(bytes)?;
        let found = point(position, bytes.take()?).map_err(|cause| bytes.wrong(cause))?;
        let _error = bytes.double()?;
        let track = bytes.count(TRACK)?;
        bytes.skip(track.saturating_mul(TRACK))?;
        Ok(found)
    })
}

/// Reads bytes as each of the three files: a target of fuzzing.
#[cfg(feature = "fuzz-targets")]
pub(crate) fn try_parse(path: &Path, file: &[u8]) -> [Result<(), SceneFileError>; 3] {
    let known = Intrinsics::colmap("PINHOLE", 8, 6, &[5.0, 5.0, 4.0, 3.0]);
    let known = known.map(|camera| (1, camera)).into_iter().collect();
    [cameras(path, file).map(drop), images(path, file, &known).map(drop), points(path, file).map(drop)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera_file() -> Vec<u8> {
        let mut file = 1_u64.to_le_bytes().to_vec();
        file.extend(7_u32.to_le_bytes());
        file.extend(2_u32.to_le_bytes());
        file.extend([1280_u64, 720].map(u64::to_le_bytes).as_flattened());
        file.extend([633.7_f64, 640.0, 360.0, -0.0377].map(f64::to_le_bytes).as_flattened());
        file
    }

    fn image_file() -> Vec<u8> {
        let mut file = 1_u64.to_le_bytes().to_vec();
        file.extend(14_u32.to_le_bytes());
        file.extend([1.0_f64, 0.0, 0.0, 0.0, 0.5, 1.0, 2.0].map(f64::to_le_bytes).as_flattened());
        file.extend(7_u32.to_le_bytes());
        file.extend(b"a b.jpg\0");
        file.extend(2_u64.to_le_bytes());
        file.extend([0; 2 * IMAGE_POINT]);
        file
    }

    fn point_file() -> Vec<u8> {
        let mut file = 1_u64.to_le_bytes().to_vec();
        file.extend(9_u64.to_le_bytes());
        file.extend([1.5_f64, -2.0, 3.0].map(f64::to_le_bytes).as_flattened());
        file.extend([255, 0, 51]);
        file.extend(0.8_f64.to_le_bytes());
        file.extend(1_u64.to_le_bytes());
        file.extend([0; TRACK]);
        file
    }

    #[test]
    fn a_model_is_read() {
        let path = Path::new("x.bin");
        let known = cameras(path, &camera_file()).unwrap();
        assert_eq!(known[&7].distortion, [-0.0377, 0.0, 0.0, 0.0]);
        let posed = images(path, &image_file(), &known).unwrap();
        assert_eq!(posed[0].name, Path::new("a b.jpg"));
        assert_eq!(posed[0].lens.camera.translation, [0.5, 1.0, 2.0]);
        let points = points(path, &point_file()).unwrap();
        assert_eq!(points, [Point { position: [1.5, -2.0, 3.0], colour: [1.0, 0.0, 0.2] }]);
    }

    #[test]
    fn every_beginning_of_a_file_is_refused_with_its_place() {
        let path = Path::new("x.bin");
        let known = cameras(path, &camera_file()).unwrap();
        let (camera, image, point) = (camera_file(), image_file(), point_file());
        for end in 0..camera.len() {
            assert!(cameras(path, &camera[..end]).is_err(), "{end}");
        }
        for end in 0..image.len() {
            assert!(images(path, &image[..end], &known).unwrap_err().to_string().starts_with("x.bin, byte "));
        }
        for end in 0..point.len() {
            assert!(points(path, &point[..end]).is_err(), "{end}");
        }
    }

    #[test]
    fn a_count_beyond_the_file_takes_no_memory() {
        let mut file = camera_file();
        file[..8].copy_from_slice(&u64::MAX.to_le_bytes());
        let said = cameras(Path::new("x.bin"), &file).unwrap_err().to_string();
        assert!(said.contains("has room for 1 at most"), "{said}");
    }
}
