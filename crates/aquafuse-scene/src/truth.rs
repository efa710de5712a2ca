//! A synthetic place of known geometry, seen by many cameras: training is compared with it.
//!
//! The place is that of [`aquafuse::truth`], in metres. Its axes there are x right, y up, z ahead, which is a left-handed
//! frame; scenes turn y over.

use std::path::{Path, PathBuf};

use aquafuse::image::Image;
use aquafuse::truth::{HALF_VIEW, OPEN_WATER, Pose, Scene, Size, View};
use aquafuse::waterbody::Waterbody;
use aquafuse_data::files::FileError;
use aquafuse_data::image_file::{ImageFile, WriteOptions};

use crate::camera::Camera;
use crate::files::{Cameras, PosedImage, SceneFileError, write_cameras};
use crate::lens::{Lens, shrunk};
use crate::points::Point;

/// A camera and what it sees.
#[derive(Clone, Debug)]
pub struct TruthView {
    /// The camera.
    pub camera: Camera,
    /// The same camera on finer pixels, whose means are the image's.
    pub fine: Camera,
    /// What it sees on those, through air, with distances.
    pub scene: Scene,
}

impl TruthView {
    /// The image taken through air.
    pub fn clear(&self) -> Image<f32> {
        shrunk(&self.scene.clear, self.camera.width, self.camera.height)
    }

    /// The image taken through a water, its coefficients per metre.
    pub fn seen_through(&self, water: &Waterbody) -> Image<f32> {
        shrunk(&self.scene.seen_through(water), self.camera.width, self.camera.height)
    }
}

/// Rows of cameras, one above the other.
const ROWS: usize = 2;
/// How far the outermost stand to the side, metres.
const ASIDE: f32 = 1.1;
/// What all look at, metres ahead of the middle.
const AHEAD: f32 = 5.0;
/// How far down the middle looks, radians: some open water stays in view.
const DOWN: f32 = 0.26;

/// So many views of the place of a seed: cameras on two arcs, all looking at the same things some metres ahead.
///
/// Each pixel is the mean of `finer` x `finer` finer ones, > 0: as of a real sensor, whose pixels have a size. At 1, what is
/// finer than a pixel sparkles from view to view, which no scene in 3D can explain.
pub fn views(seed: u64, size: Size, count: usize, finer: usize) -> Vec<TruthView> {
    let a_row = count.div_ceil(ROWS).max(2);
    let pose = |i: usize| {
        let (row, column) = (i / a_row, i % a_row);
        let side = ASIDE * (2.0 * column as f32 / (a_row - 1) as f32 - 1.0);
        let up = 0.25 + 0.45 * row as f32 + 0.1 * (2.4 * column as f32).sin();
        let back = -0.4 + 0.25 * (1.7 * column as f32).cos();
        let level = (AHEAD - back).hypot(side);
        let target = -AHEAD * DOWN.tan();
        Pose {
            moved: [side, up, back],
            yaw: (-side).atan2(AHEAD - back),
            pitch: (up - target).atan2(level),
            ..Pose::default()
        }
    };
    let view = |i: usize| {
        let (pose, fine) = (pose(i), Size { width: size.width * finer, height: size.height * finer });
        TruthView {
            camera: camera(&pose, size),
            fine: camera(&pose, fine),
            scene: Scene::from(View::default(), seed, &pose, fine),
        }
    };
    (0..count).map(view).collect()
}

/// The camera of a pose.
fn camera(pose: &Pose, size: Size) -> Camera {
    let [right, up, ahead] = pose.moved.map(f64::from);
    let ((sin_yaw, cos_yaw), (sin, cos)) = (f64::from(pose.yaw).sin_cos(), f64::from(pose.pitch).sin_cos());
    let rotation = [
        [cos_yaw, 0.0, -sin_yaw],
        [-sin * sin_yaw, cos, -sin * cos_yaw],
        [cos * sin_yaw, sin, cos * cos_yaw],
    ];
    let position = [right, -up, ahead];
    let (width, height) = (size.width, size.height);
    let focal = width as f64 / (2.0 * f64::from(HALF_VIEW));
    Camera {
        width,
        height,
        focal: [focal; 2],
        centre: [0.5 * width as f64, 0.5 * height as f64],
        translation: rotation.map(|row| -(0..3).map(|i| row[i] * position[i]).sum::<f64>()),
        rotation,
    }
}

/// Points on things as structure from motion would find them: one in so many pixels of the views, with the colours that
/// `image_files`, one a view, have there; none in open water.
///
/// # Panics
///
/// When there is not one image of its size for each view.
pub fn points(views: &[TruthView], image_files: &[Image<f32>], every: usize) -> Vec<Point> {
    assert_eq!(views.len(), image_files.len(), "one image a view");
    let of_view = |(number, (view, image_file)): (usize, (&TruthView, &Image<f32>))| {
        assert_eq!(image_file.size(), (view.camera.width, view.camera.height), "the image of the view");
        let width = view.fine.width;
        let finer = width / view.camera.width;
        let every = every * finer * finer;
        let distances = view.scene.depth.distances();
        // Another pixel of each view, so that no two see the same grid.
        let first = (number * 7919) % every;
        let point = |i: usize| {
            let place = [(i % width) as f64 + 0.5, (i / width) as f64 + 0.5];
            let position = view.fine.point_at(place, f64::from(distances[i]));
            let pixel = i / width / finer * view.camera.width + i % width / finer;
            Point { position, colour: image_file.pixels()[pixel].map(f64::from) }
        };
        let hit: Vec<Point> = (first..distances.len())
            .step_by(every)
            .filter(|&i| distances[i] < OPEN_WATER)
            .map(point)
            .collect();
        hit
    };
    views.iter().zip(image_files).enumerate().flat_map(of_view).collect()
}

/// Writes views as a scene's folder: images, `images/view_NNN.png`, one a view; their cameras, and `points`.
///
/// # Errors
///
/// [`SceneFileError`] when a file of it exists, or the system refuses.
///
/// # Panics
///
/// When there is not one image for each view.
pub fn write(
    folder: &Path,
    views: &[TruthView],
    image_files: &[Image<f32>],
    points: Vec<Point>,
) -> Result<(), SceneFileError> {
    assert_eq!(views.len(), image_files.len(), "one image a view");
    let [images, model] = ["images", "sparse/0"].map(|name| folder.join(name));
    for folder in [&images, &model] {
        let made = std::fs::create_dir_all(folder);
        made.map_err(|error| FileError::Write { path: folder.clone(), cause: error.to_string() })?;
    }
    let mut posed = Vec::with_capacity(views.len());
    for (number, (view, image_file)) in views.iter().zip(image_files).enumerate() {
        let name = PathBuf::from(format!("view_{number:03}.png"));
        ImageFile::new(image_file.convert::<u8>()).write(&images.join(&name), &WriteOptions::default())?;
        posed.push(PosedImage { name, lens: Lens { camera: view.camera.clone(), distortion: [0.0; 4] } });
    }
    write_cameras(&model, &Cameras { images: posed, points, model: PathBuf::new() }, false)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::dot;

    #[test]
    fn what_one_camera_sees_another_sees_at_the_distance_reckoned() {
        let size = Size { width: 80, height: 60 };
        let views = views(3, size, 4, 1);
        let (mut agreeing, mut asked) = (0, 0);
        let (from, to) = (&views[0], &views[1]);
        for (i, z) in from.scene.depth.distances().into_iter().enumerate().filter(|(_, z)| *z < OPEN_WATER) {
            let place = [(i % 80) as f64 + 0.5, (i / 80) as f64 + 0.5];
            let seen = to.camera.to_camera(from.camera.point_at(place, f64::from(z)));
            let [x, y] = [0, 1].map(|a| to.camera.focal[a] * seen[a] / seen[2] + to.camera.centre[a]);
            if x >= 0.0 && y >= 0.0 && x < 80.0 && y < 60.0 {
                let there = f64::from(to.scene.depth.at(x as usize, y as usize));
                asked += 1;
                agreeing += usize::from((there / dot(seen, seen).sqrt() - 1.0).abs() < 0.05);
            }
        }
        // The rest is hidden from the other camera, or at an edge.
        assert!(asked > 1000 && agreeing as f64 > 0.8 * f64::from(asked), "{agreeing} of {asked}");
    }

    #[test]
    fn no_camera_stands_in_a_thing() {
        for view in views(1, Size { width: 40, height: 30 }, 28, 1) {
            assert!(view.scene.depth.distances().iter().all(|&z| z > 0.3));
        }
    }
}
