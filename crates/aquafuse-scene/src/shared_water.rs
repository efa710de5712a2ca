//! One water for all images of a scene, in its unit of length.
//!
//! Depth from colour is relative within an image. Points of the scene that a camera sees tell how long its 1 is: with that,
//! distances of all images are of one unit, and so are the waters estimated from them, which are then pooled.

use aquafuse::depth::{DepthKind, DepthMap};
use aquafuse::image::{Encoded, ImageError};
use aquafuse::waterbody::{self, Estimate, EstimateOptions};
use aquafuse_data::image_file::ImageFile;

use crate::lens::Lens;
use crate::medium::Water;
use crate::points::Point;

/// Points in view of a camera, at the least, for its depth to have a unit.
const LEAST_POINTS: usize = 12;

/// How many units of the scene relative depth 1 is in an image; none if too few points are in its view.
///
/// The median of distance over relative depth at the points: half of them may lie on something that hides them, or where
/// colour errs.
pub fn unit_of(relative: &DepthMap, lens: &Lens, points: &[Point]) -> Option<f32> {
    let (width, height) = relative.size();
    let lens = Lens { camera: lens.camera.scaled_to(width, height), ..lens.clone() };
    let camera = &lens.camera;
    let mut units: Vec<f32> = points
        .iter()
        .filter_map(|point| {
            let seen = camera.to_camera(point.position);
            let straight = std::array::from_fn(|a| camera.focal[a] * seen[a] / seen[2] + camera.centre[a]);
            let [x, y] = lens.distorted(straight);
            let inside = seen[2] > 0.0 && x >= 0.0 && y >= 0.0 && x < width as f64 && y < height as f64;
            let z = inside.then(|| relative.at(x as usize, y as usize))?;
            let distance = seen.iter().map(|v| v * v).sum::<f64>().sqrt() as f32;
            (z > 0.0).then(|| distance / z)
        })
        .collect();
    (units.len() >= LEAST_POINTS).then(|| median(&mut units)).flatten()
}

/// The middle one; none if there is none.
pub fn median(values: &mut [f32]) -> Option<f32> {
    values.sort_by(f32::total_cmp);
    values.get(values.len() / 2).copied()
}

/// An image's depth in units of the scene; as it is if it has another kind than relative, or the unit is no length.
#[must_use]
pub fn in_scene(relative: &DepthMap, unit: f32) -> DepthMap {
    let (width, height) = relative.size();
    let distances = relative.distances().into_iter().map(|z| z * unit).collect();
    let scaled = DepthMap::from_distances(width, height, DepthKind::Metres, distances);
    scaled.unwrap_or_else(|_| relative.clone())
}

/// The water of one image, whose depth is in units of the scene.
///
/// # Errors
///
/// [`ImageError`] when image and depth differ in size.
pub fn water_of(image: &ImageFile, depth: &DepthMap) -> Result<Estimate<Encoded>, ImageError> {
    let options = EstimateOptions::default().with_top(image.top_edge());
    waterbody::estimate(&image.bytes(), depth, &options)
}

/// A water as training may begin with it: β_D as it is at `distance`, which is about as far as things are.
pub fn to_learn(estimate: &Estimate<Encoded>, distance: f32) -> Water<f32> {
    let water = &estimate.water;
    Water::new(
        water.veiling_light.rgb().map(f64::from),
        water.backscatter_coefficient.map(f64::from),
        water.attenuation.each_ref().map(|curve| f64::from(curve.coefficient(distance))),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::truth;
    use aquafuse::truth::Size;

    #[test]
    fn points_tell_the_unit_of_relative_depth() {
        let views = truth::views(2, Size { width: 80, height: 60 }, 2, 1);
        let images: Vec<_> = views.iter().map(truth::TruthView::clear).collect();
        let points = truth::points(&views[1..], &images[1..], 20);
        // The true depth, said to be relative to 40 units.
        let distances = views[1].scene.depth.distances();
        let relative = distances.iter().map(|z| z.min(40.0) / 40.0).collect();
        let relative = DepthMap::from_distances(80, 60, DepthKind::Relative, relative).unwrap();
        let lens = Lens { camera: views[1].camera.clone(), distortion: [0.0; 4] };
        let unit = unit_of(&relative, &lens, &points).unwrap();
        assert!((unit - 40.0).abs() < 1e-3, "{unit}");
        assert!((in_scene(&relative, unit).at(40, 50) - views[1].scene.depth.at(40, 50)).abs() < 1e-3);
        assert_eq!(unit_of(&relative, &lens, &points[..5]), None);
    }
}
