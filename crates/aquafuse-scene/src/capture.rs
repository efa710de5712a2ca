//! The images of a scene's folder, undistorted and scaled, with their pinhole cameras.

use std::collections::BTreeSet;
use std::fmt;
use std::path::{Path, PathBuf};

use aquafuse::image::Image;
use aquafuse_data::files::{FileError, display};
use aquafuse_data::image_file::{ImageFile, ReadOptions, list};

use crate::camera::Camera;
use crate::files::{Cameras, PosedImage};
use crate::lens::{Lens, shrunk};

/// One image of a scene, without the distortion of its lens.
#[derive(Clone, Debug)]
pub struct View {
    /// Its name in the folder of images.
    pub name: PathBuf,
    /// The pinhole camera that would have taken `image`.
    pub camera: Camera,
    /// The undistorted image, perhaps smaller than the file's.
    pub image: Image<f32>,
}

/// The views of a scene, split into those to train on and those to score by.
#[derive(Clone, Debug, Default)]
pub struct Split {
    /// Views to train on.
    pub training: Vec<View>,
    /// Views held out of training.
    pub held_out: Vec<View>,
}

/// The images of a scene cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CaptureError {
    /// An image.
    #[error(transparent)]
    Image(#[from] FileError),
    /// Images are not there.
    #[error(
        "{} lacks {missing} of the {of} images of the scene, first {}. Put them there, name another folder (--images), or \
         go on without them (--skip-missing)",
        display(folder),
        display(first)
    )]
    Missing {
        /// The folder of images.
        folder: PathBuf,
        /// The first image that is missing.
        first: PathBuf,
        /// How many are missing.
        missing: usize,
        /// How many there should be.
        of: usize,
    },
    /// An image has another shape than its camera says.
    #[error(
        "{} is {}x{} pixels, but its camera has {}x{}: use the images that the model was made of, or ones scaled evenly",
        display(path),
        found.0,
        found.1,
        expected.0,
        expected.1
    )]
    Shape {
        /// The image.
        path: PathBuf,
        /// Its size.
        found: (usize, usize),
        /// What the camera has.
        expected: (usize, usize),
    },
}

/// The folder that the names of a scene's images begin at: `images` in the scene's folder, or that folder itself, whichever
/// holds more of them.
pub fn images_of(scene: &Path, cameras: &Cameras) -> PathBuf {
    let images = scene.join("images");
    let held = |folder: &Path| {
        cameras.images.iter().filter(|one| folder.join(&one.name).symlink_metadata().is_ok()).count()
    };
    match images.is_dir() && held(&images) >= held(scene) {
        true => images,
        false => scene.to_owned(),
    }
}

/// Images that a scene is read without. [`Display`](fmt::Display) says nothing where there are none.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Unused {
    /// How many images of the scene are not there.
    pub missing: usize,
    /// The images beside those of the scene that have no camera, by name.
    pub without_camera: Vec<PathBuf>,
}

impl fmt::Display for Unused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.missing > 0 {
            write!(f, " (images left out, because missing: {})", self.missing)?;
        }
        if let Some(first) = self.without_camera.first() {
            let count = self.without_camera.len();
            write!(f, " (images left out, because without a camera: {count}, first {})", display(first))?;
        }
        Ok(())
    }
}

/// Leaves the cameras out whose images are not there, if `skip` says so; gives what the scene is then read without.
///
/// # Errors
///
/// [`CaptureError`] when some images are missing and none may be, when all are, or when a folder of images cannot be listed.
pub fn without_unused(cameras: &mut Cameras, images: &Path, skip: bool) -> Result<Unused, CaptureError> {
    let is_there = |one: &PosedImage| images.join(&one.name).symlink_metadata().is_ok();
    let of = cameras.images.len();
    let first = cameras.images.iter().find(|one| !is_there(one)).map(|one| one.name.clone());
    let missing = cameras.images.iter().filter(|one| !is_there(one)).count();
    match first {
        Some(first) if !skip || missing == of => {
            Err(CaptureError::Missing { folder: images.to_owned(), first, missing, of })
        }
        _ => {
            cameras.images.retain(is_there);
            Ok(Unused { missing, without_camera: without_camera(cameras, images)? })
        }
    }
}

/// The images in the folders of a scene's images that are none of them.
fn without_camera(cameras: &Cameras, images: &Path) -> Result<Vec<PathBuf>, FileError> {
    let known: BTreeSet<PathBuf> = cameras.images.iter().map(|one| images.join(&one.name)).collect();
    let folders: BTreeSet<&Path> = known.iter().filter_map(|path| path.parent()).collect();
    let mut found = Vec::new();
    for folder in folders {
        found.extend(list(folder)?.images.into_iter().filter(|path| !known.contains(path)));
    }
    Ok(found)
}

/// Reads the images that `cameras` belong to, each no longer than `longest` pixels on its longer side.
///
/// # Errors
///
/// [`CaptureError`] when an image cannot be read, or does not fit its camera.
pub fn read(
    cameras: &Cameras,
    images: &Path,
    longest: usize,
    reading: &ReadOptions,
) -> Result<Vec<View>, CaptureError> {
    let mut views = Vec::with_capacity(cameras.images.len());
    for PosedImage { name, lens } in &cameras.images {
        let path = images.join(name);
        let image = ImageFile::open(&path, reading)?.decode()?;
        let image = image.bytes().to_unit();
        let (camera, image) = undistorted(lens, &image, longest).ok_or_else(|| CaptureError::Shape {
            path,
            found: image.size(),
            expected: (lens.camera.width, lens.camera.height),
        })?;
        views.push(View { name: name.clone(), camera, image });
    }
    Ok(views)
}

impl Split {
    /// Holds every `every`th view out, from the first on; 0: none.
    pub fn new(views: Vec<View>, every: usize) -> Self {
        let mut split = Self::default();
        for (index, view) in views.into_iter().enumerate() {
            let is_held_out = every > 0 && index.is_multiple_of(every);
            if is_held_out { &mut split.held_out } else { &mut split.training }.push(view);
        }
        split
    }
}

/// An image without the distortion of its lens, as large as asked for; `None` if its shape is not the camera's.
fn undistorted(lens: &Lens, image: &Image<f32>, longest: usize) -> Option<(Camera, Image<f32>)> {
    let (width, height) = image.size();
    let Camera { width: known_width, height: known_height, .. } = lens.camera;
    // Within a pixel of one shape: sides were rounded when it was scaled.
    if (width * known_height).abs_diff(height * known_width) > known_width.max(known_height) {
        return None;
    }
    let lens = Lens { camera: lens.camera.scaled_to(width, height), ..lens.clone() };
    let straight = lens.undistorted(image);
    let scale = (longest as f64 / width.max(height) as f64).min(1.0);
    let side = |length: usize| ((length as f64 * scale).round() as usize).max(1);
    let (small_width, small_height) = (side(width), side(height));
    Some((lens.camera.scaled_to(small_width, small_height), shrunk(&straight, small_width, small_height)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::truth;

    #[test]
    fn missing_images_are_counted_and_may_be_left_out() {
        let folder = tempfile::tempdir().unwrap();
        let images: Vec<PosedImage> = truth::views(1, aquafuse::truth::Size { width: 8, height: 6 }, 3, 1)
            .iter()
            .zip(["a.png", "b.png", "c.png"])
            .map(|(view, name)| PosedImage {
                name: name.into(),
                lens: Lens { camera: view.camera.clone(), distortion: [0.0; 4] },
            })
            .collect();
        let whole = Cameras { images, ..Cameras::default() };
        assert_eq!(images_of(folder.path(), &whole), folder.path());
        std::fs::create_dir(folder.path().join("images")).unwrap();
        assert_eq!(images_of(folder.path(), &whole), folder.path().join("images"));
        std::fs::write(folder.path().join("b.png"), "").unwrap();
        assert_eq!(images_of(folder.path(), &whole), folder.path());

        let mut cameras = whole.clone();
        let said = without_unused(&mut cameras, folder.path(), false).unwrap_err().to_string();
        assert!(said.contains("lacks 2 of the 3 images") && said.contains("first a.png"), "{said}");
        std::fs::write(folder.path().join("x.png"), "").unwrap();
        let unused = without_unused(&mut cameras, folder.path(), true).unwrap();
        assert_eq!(unused, Unused { missing: 2, without_camera: vec![folder.path().join("x.png")] });
        assert_eq!(cameras.images[0].name, Path::new("b.png"));
        let mut cameras = whole;
        assert!(without_unused(&mut cameras, &folder.path().join("images"), true).is_err());
    }
}
