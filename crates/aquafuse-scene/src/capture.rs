//! The images of a scene's folder, undistorted and scaled, with their pinhole cameras.

use std::path::{Path, PathBuf};

use aquafuse::image::Image;
use aquafuse_data::files::{FileError, display};
use aquafuse_data::image_file::{ImageFile, ReadOptions};

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

/// The folder of a scene's images.
pub fn images_of(scene: &Path) -> PathBuf {
    let images = scene.join("images");
    if images.is_dir() { images } else { scene.to_owned() }
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
