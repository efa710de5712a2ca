//! A scene's folder: images with their cameras, straightened and ready to train on.

use std::path::{Path, PathBuf};

use aquafuse::image::Image;
use aquafuse_data::files::{FileError, display};
use aquafuse_data::image_file::{ImageFile, ReadOptions};

use crate::camera::Camera;
use crate::files::{Cameras, SceneFileError, read_cameras};
use crate::lens::{Lens, shrunk};
use crate::points::Point;

/// One image of a scene.
#[derive(Clone, Debug)]
pub struct Shown {
    /// Its name in the folder of images.
    pub name: PathBuf,
    /// The pinhole that would have taken `image`.
    pub camera: Camera,
    /// The image without the distortion of its lens, perhaps smaller than the file's.
    pub image: Image<f32>,
}

/// A scene as it was taken.
#[derive(Clone, Debug)]
pub struct Capture {
    /// Images with a pose, sorted by name.
    pub shown: Vec<Shown>,
    /// Points on things; none where the model has none.
    pub points: Vec<Point>,
}

/// A scene's folder could not be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CaptureError {
    /// The cameras.
    #[error(transparent)]
    Cameras(#[from] SceneFileError),
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

/// Reads the images of a scene, each no longer than `longest` pixels on its longer side.
///
/// # Errors
///
/// [`CaptureError`] when cameras or an image cannot be read, or do not fit each other.
pub fn read(
    scene: &Path,
    images: &Path,
    longest: usize,
    reading: &ReadOptions,
) -> Result<Capture, CaptureError> {
    let Cameras { taken, points, .. } = read_cameras(scene)?;
    let mut shown = Vec::with_capacity(taken.len());
    for one in taken {
        let path = images.join(&one.name);
        let image = ImageFile::open(&path, reading)?.decode()?;
        let image = image.bytes().to_unit();
        let (camera, image) =
            straightened(&one.lens, &image, longest).ok_or_else(|| CaptureError::Shape {
                path,
                found: image.size(),
                expected: (one.lens.camera.width, one.lens.camera.height),
            })?;
        shown.push(Shown { name: one.name, camera, image });
    }
    Ok(Capture { shown, points })
}

/// An image without its lens, as large as asked for; none if it has another shape than the lens draws.
fn straightened(lens: &Lens, image: &Image<f32>, longest: usize) -> Option<(Camera, Image<f32>)> {
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
