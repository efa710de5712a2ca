//! Normals of the surfaces that a rendering shows, where they are surfaces.
//!
//! Splats know distances to a per cent or so, which at neighbouring pixels is any slope at all. So a normal comes from the
//! plane that fits a window of pixels best. 1 / z of a plane, z being the depth along the camera's axis, is linear in the
//! image: `1/z = a x + b y + c` with x and y the slopes of lines of sight, and (a, b, c) is its normal.

use crate::camera::{Camera, unit};
use crate::render::Rendering;

use super::distances;

/// Half the side of the window, in widths of the image, and in pixels at the least.
const REACH: f64 = 0.025;
const LEAST_REACH: usize = 2;
/// A window counts if its pixels are this near to the plane, as a share of their depth, in the root of the mean square:
/// edges, seaweed and fog are no surfaces.
const FLAT: f64 = 0.02;

/// Unit normals towards the camera, in the scene's axes; `None` at the edge of the image, and where its window is not of
/// one surface.
pub(super) fn normals(camera: &Camera, rendering: &Rendering<f32>) -> Vec<Option<[f64; 3]>> {
    let (width, height) = (rendering.width, rendering.height);
    let slope = |axis: usize, i: usize| (i as f64 + 0.5 - camera.centre[axis]) / camera.focal[axis];
    let inverse: Vec<Option<f64>> = distances(rendering)
        .into_iter()
        .enumerate()
        .map(|(i, distance)| {
            let (x, y) = (slope(0, i % width), slope(1, i / width));
            distance.map(|distance| (1.0 + x * x + y * y).sqrt() / f64::from(distance))
        })
        .collect();
    let reach = ((width as f64 * REACH).round() as usize).max(LEAST_REACH);
    let normal = |i: usize| {
        let (x, y) = (i % width, i / width);
        if x < reach || y < reach || x + reach >= width || y + reach >= height {
            return None;
        }
        let [across, down, level] = plane(&inverse, width, [x, y], reach)?;
        let [a, b] = [across * camera.focal[0], down * camera.focal[1]];
        let c = level - a * slope(0, x) - b * slope(1, y);
        // Towards the camera: against the line of sight.
        let seen = unit([-a, -b, -c])?;
        Some(std::array::from_fn(|axis| (0..3).map(|row| camera.rotation[row][axis] * seen[row]).sum()))
    };
    (0..width * height).map(normal).collect()
}

/// The best plane of a window, as what 1/z grows by from pixel to pixel, and its value in the middle.
fn plane(inverse: &[Option<f64>], width: usize, [x, y]: [usize; 2], reach: usize) -> Option<[f64; 3]> {
    let (mut sum, mut squares, mut across, mut down) = (0.0, 0.0, 0.0, 0.0);
    for row in y - reach..=y + reach {
        for column in x - reach..=x + reach {
            let value = inverse[row * width + column]?;
            sum += value;
            squares += value * value;
            across += value * (column as f64 - x as f64);
            down += value * (row as f64 - y as f64);
        }
    }
    let side = (2 * reach + 1) as f64;
    let count = side * side;
    // Of the square of the offset along one axis, over the window: offsets cancel, so that all three are found apart.
    let spread = count * (side * side - 1.0) / 12.0;
    let (level, across, down) = (sum / count, across / spread, down / spread);
    let rest = squares / count - level * level - (across * across + down * down) * spread / count;
    (rest.max(0.0).sqrt() <= FLAT * level).then_some([across, down, level])
}
