//! The cameras and points of a scene, whichever program found them.

use std::io::{BufRead, BufReader, Read};
use std::path::{Component, Path, PathBuf};

use aquafuse_data::files::{Step, count, display};
use aquafuse_data::image_file::{ImageFile, ReadOptions};

use super::{SceneFileError, bytes, colmap_binary, colmap_text, transforms};
use crate::camera::Camera;
use crate::lens::Lens;
use crate::points::Point;

/// An image and the lens it was taken with.
#[derive(Clone, Debug, PartialEq)]
pub struct PosedImage {
    /// The image's name relative to the folder of images: it does not lead out of it.
    pub name: PathBuf,
    /// Camera, pose and distortion.
    pub lens: Lens,
}

/// What structure from motion found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cameras {
    /// Images with a pose, sorted by name.
    pub images: Vec<PosedImage>,
    /// Points on surfaces; empty where the model has none.
    pub points: Vec<Point>,
    /// The folder that holds the model, within the one that was named: what goes along when a scene is copied.
    pub model: PathBuf,
}

/// Where a COLMAP model may be in a scene's folder, beside the numbered ones.
const PLACES: [&str; 3] = ["", "sparse", "colmap_text"];
/// Where mappers put the models that they could not join: `sparse/0`, `sparse/1`.
const NUMBERED: &str = "sparse";

/// The COLMAP model of a scene that is read. Mappers write several where they cannot join all images; then it is the one
/// with the most images, the first of those.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChosenModel {
    /// Its folder, within the scene's.
    pub model: PathBuf,
    /// How many images it has.
    pub images: u64,
    /// How many other models stand beside it.
    pub others: usize,
}

impl ChosenModel {
    /// The model of a scene's folder; `None` where there is none.
    pub fn of(folder: &Path) -> Option<Self> {
        let is_model = |place: &Path| {
            ["cameras.bin", "cameras.txt"].iter().any(|name| folder.join(place).join(name).is_file())
        };
        let one = |place: &str| {
            let model = PathBuf::from(place);
            is_model(&model).then(|| Self { images: images_in(&folder.join(&model)), model, others: 0 })
        };
        let [here, rest @ ..] = PLACES;
        if let Some(found) = one(here) {
            return Some(found);
        }
        let entries = folder.join(NUMBERED).read_dir().into_iter().flatten().flatten();
        let number = |entry: std::fs::DirEntry| entry.file_name().to_str()?.parse::<u32>().ok();
        let mut numbers: Vec<u32> = entries.filter_map(number).collect();
        numbers.sort_unstable();
        let models = numbers.into_iter().filter_map(|number| one(&format!("{NUMBERED}/{number}")));
        let models: Vec<Self> = models.collect();
        let others = models.len().saturating_sub(1);
        let most = models.iter().map(|model| model.images).max();
        let chosen = models.into_iter().find(|model| Some(model.images) == most);
        chosen.map(|model| Self { others, ..model }).or_else(|| rest.iter().find_map(|place| one(place)))
    }
}

/// How many images a model says it has; 0 where it cannot be read, which reading it will say.
fn images_in(model: &Path) -> u64 {
    let (binary, mut count) = (model.join("images.bin"), [0; 8]);
    // A pipe would be waited for.
    if binary.is_file()
        && std::fs::File::open(binary).and_then(|mut file| file.read_exact(&mut count)).is_ok()
    {
        return u64::from_le_bytes(count);
    }
    let text = model.join("images.txt");
    let file = text.is_file().then(|| std::fs::File::open(text));
    let Some(Ok(file)) = file else { return 0 };
    // Two lines for each image: its pose, and its points, which may be none.
    let lines = BufReader::new(file).split(b'\n').map_while(Result::ok);
    let lines = lines.filter(|line| !line.starts_with(b"#")).fold(0_u64, |count, _| count.saturating_add(1));
    lines.div_ceil(2)
}

/// What NeRF's files of cameras are called; Blender's have one for each split.
const TRANSFORMS: [&str; 2] = ["transforms.json", "transforms_train.json"];

/// Reads the cameras of a scene's folder: a COLMAP model, binary before text, or `transforms.json`.
///
/// # Errors
///
/// [`SceneFileError`] when there is none, or one cannot be read within the memory that `reading` allows.
pub fn read_cameras(folder: &Path, reading: &ReadOptions) -> Result<Cameras, SceneFileError> {
    count(Step::CamerasParsed);
    if let Some(chosen) = ChosenModel::of(folder) {
        let model = folder.join(&chosen.model);
        let there = |name: &str| model.join(name).is_file();
        let mut cameras = match there("cameras.bin") {
            true => colmap_binary::read(&model, reading)?,
            false => colmap_text::read(&model, reading)?,
        };
        cameras.images.sort_by(|a, b| a.name.cmp(&b.name));
        return checked(Cameras { model: chosen.model, ..cameras }, &model);
    }
    let paths = TRANSFORMS.map(|name| folder.join(name));
    let Some(path) = paths.into_iter().find(|path| path.is_file()) else {
        return Err(SceneFileError::NoCameras { folder: folder.to_owned() });
    };
    let size_of = |name: &Path| {
        let paths = [folder.join(name), folder.join("images").join(name)];
        let opened = paths.iter().find_map(|path| ImageFile::open(path, reading).ok());
        opened.map(|image| image.size())
    };
    let mut images = transforms::read(&path, &bytes::read(&path, reading)?, &size_of)?;
    images.sort_by(|a, b| a.name.cmp(&b.name));
    checked(Cameras { images, points: Vec::new(), model: PathBuf::new() }, &path)
}

fn checked(cameras: Cameras, path: &Path) -> Result<Cameras, SceneFileError> {
    if cameras.images.is_empty() {
        let cause = "no image has a pose. Run structure from motion on more, or on sharper, images";
        return Err(SceneFileError::content(path, cause));
    }
    // They are sorted by name.
    let mut next = cameras.images.iter().zip(cameras.images.iter().skip(1));
    if let Some((one, _)) = next.find(|(one, next)| one.name == next.name) {
        let cause = format!("it has two cameras of {}. Leave one of them out", display(&one.name));
        return Err(SceneFileError::content(path, cause));
    }
    Ok(cameras)
}

/// The most columns or rows of an image.
const MOST_PIXELS: u64 = 1 << 20;

/// A camera's numbers before its pose is known.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Intrinsics {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) focal: [f64; 2],
    pub(super) centre: [f64; 2],
    pub(super) distortion: [f64; 4],
}

/// COLMAP's models that we undistort: name, number in binary files, and count of parameters.
const MODELS: [(&str, u32, usize); 5] = [
    ("SIMPLE_PINHOLE", 0, 3),
    ("PINHOLE", 1, 4),
    ("SIMPLE_RADIAL", 2, 4),
    ("RADIAL", 3, 5),
    ("OPENCV", 4, 8),
];

/// Name and count of parameters of a model by its name or its number.
pub(super) fn model(is: impl Fn(&str, u32) -> bool) -> Result<(&'static str, usize), String> {
    let found = MODELS.iter().find(|(name, number, _)| is(name, *number));
    found.map(|&(name, _, count)| (name, count)).ok_or_else(|| format!("{OTHER_MODEL}, which writes PINHOLE"))
}

/// What is said of another model: the names are those of [`MODELS`].
pub(super) const OTHER_MODEL: &str = "a camera model that is none of SIMPLE_PINHOLE, PINHOLE, SIMPLE_RADIAL, RADIAL, \
                                      OPENCV; run `colmap image_undistorter`";

impl Intrinsics {
    /// The camera of a model of COLMAP.
    pub(super) fn colmap(name: &str, width: u64, height: u64, parameters: &[f64]) -> Result<Self, String> {
        let (focal, centre, distortion) = match (name, parameters) {
            ("SIMPLE_PINHOLE", &[f, cx, cy]) => ([f, f], [cx, cy], [0.0; 4]),
            ("PINHOLE", &[fx, fy, cx, cy]) => ([fx, fy], [cx, cy], [0.0; 4]),
            ("SIMPLE_RADIAL", &[f, cx, cy, k]) => ([f, f], [cx, cy], [k, 0.0, 0.0, 0.0]),
            ("RADIAL", &[f, cx, cy, k1, k2]) => ([f, f], [cx, cy], [k1, k2, 0.0, 0.0]),
            ("OPENCV", &[fx, fy, cx, cy, k1, k2, p1, p2]) => ([fx, fy], [cx, cy], [k1, k2, p1, p2]),
            _ => return Err(format!("a camera {name} with {} parameters", parameters.len())),
        };
        Self::new(width, height, focal, centre, distortion)
    }

    /// The camera of these numbers; a sentence about what is wrong with them otherwise.
    pub(super) fn new(
        width: u64,
        height: u64,
        focal: [f64; 2],
        centre: [f64; 2],
        distortion: [f64; 4],
    ) -> Result<Self, String> {
        let side = |length: u64| usize::try_from(length).ok().filter(|_| (1..=MOST_PIXELS).contains(&length));
        let (Some(width), Some(height)) = (side(width), side(height)) else {
            return Err(format!("an image of {width}x{height} pixels; sides are 1 to {MOST_PIXELS}"));
        };
        if !focal.iter().all(|f| f.is_finite() && *f > 0.0) {
            return Err(format!("a focal length of {focal:?}, but it is > 0"));
        }
        if !centre.iter().chain(&distortion).all(|v| v.is_finite() && v.abs() < 1e9) {
            return Err("a parameter of a camera that is no number".into());
        }
        Ok(Self { width, height, focal, centre, distortion })
    }

    /// The lens of this camera with a pose, given as COLMAP does: a quaternion w, x, y, z of any length, and t.
    pub(super) fn posed(&self, quaternion: [f64; 4], translation: [f64; 3]) -> Result<Lens, String> {
        let [w, x, y, z] = quaternion;
        let length = w.hypot(x).hypot(y.hypot(z));
        if !(length.is_finite() && length > 1e-9) {
            return Err(format!("a rotation of {quaternion:?}, but a quaternion has a length"));
        }
        self.turned(Camera::rotation_of(quaternion.map(|q| q / length)), translation)
    }

    /// The lens of this camera with a pose as a rotation and t.
    pub(super) fn turned(&self, rotation: [[f64; 3]; 3], translation: [f64; 3]) -> Result<Lens, String> {
        if !translation.iter().all(|t| t.is_finite() && t.abs() < 1e9) {
            return Err(format!("a place of {translation:?}, which is nowhere"));
        }
        let Self { width, height, focal, centre, distortion } = self.clone();
        Ok(Lens { camera: Camera { width, height, focal, centre, rotation, translation }, distortion })
    }
}

/// An image's name as a path that stays in its folder; a sentence about what is wrong with it otherwise.
pub(super) fn inside(name: &str) -> Result<PathBuf, String> {
    let path = Path::new(name);
    let stays = path.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    if name.is_empty() || !stays || name.contains('\0') {
        return Err(format!("an image named {name:?}, which leads out of its folder"));
    }
    Ok(path.components().filter(|part| matches!(part, Component::Normal(_))).collect())
}

/// A point that may be used; a sentence about what is wrong with it otherwise.
pub(super) fn point(position: [f64; 3], colour: [u8; 3]) -> Result<Point, String> {
    if !position.iter().all(|v| v.is_finite() && v.abs() < 1e9) {
        return Err(format!("a point at {position:?}, which is nowhere"));
    }
    Ok(Point { position, colour: colour.map(|v| f64::from(v) / 255.0) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_several_models_the_one_with_the_most_images_is_chosen() {
        let folder = tempfile::tempdir().unwrap();
        let model = |name: &str, images: u64| {
            let model = folder.path().join(name);
            std::fs::create_dir_all(&model).unwrap();
            std::fs::write(model.join("cameras.bin"), "").unwrap();
            std::fs::write(model.join("images.bin"), images.to_le_bytes()).unwrap();
        };
        assert_eq!(ChosenModel::of(folder.path()), None);
        let chosen = || {
            let chosen = ChosenModel::of(folder.path()).unwrap();
            (chosen.model.to_str().unwrap().replace('\\', "/"), chosen.images, chosen.others)
        };
        model("sparse/0", 7);
        assert_eq!(chosen(), ("sparse/0".to_owned(), 7, 0));
        model("sparse/1", 7);
        assert_eq!(chosen(), ("sparse/0".to_owned(), 7, 1));
        model("sparse/10", 40);
        model("sparse/2", 9);
        assert_eq!(chosen(), ("sparse/10".to_owned(), 40, 3));
        let text = folder.path().join("sparse/11");
        std::fs::create_dir(&text).unwrap();
        std::fs::write(text.join("cameras.txt"), "").unwrap();
        std::fs::write(text.join("images.txt"), ["# two lines each", &"1 pose\n\n".repeat(41)].join("\n"))
            .unwrap();
        assert_eq!(chosen(), ("sparse/11".to_owned(), 41, 4));
    }
}
