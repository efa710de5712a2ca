//! How alike two scenes are: images by PSNR and SSIM, surfaces by the deviation of their normals.
//!
//! `report.rs` puts a scene beside the same one fused and makes a [`Report`](aquafuse_data::evaluate::Report) of it.

mod report;

pub use report::{CompareError, Comparison, Model, Side};

use aquafuse::image::Image;

use crate::camera::{Camera, cross, dot, minus, unit};
use crate::render::Drawing;

/// Light that may still come through where a surface counts as seen.
const OPAQUE: f32 = 0.1;

/// How far the surfaces of two drawings of one view lean away from each other, over pixels opaque in both.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NormalDeviation {
    /// SND: the mean angle between normals, of 180°, 0 to 1.
    pub angle: f64,
    /// The mean of 1 - cos of it.
    pub cosine: f64,
    /// Pixels that were compared.
    pub pixels: usize,
}

/// The drawing as an image, cut off at 0 and 1.
pub fn image(drawing: &Drawing<f32>) -> Image<f32> {
    let samples = drawing.pixels().flatten().map(|value| value.clamp(0.0, 1.0)).collect();
    Image::from_raw(drawing.width, drawing.height, samples).expect("one colour a pixel")
}

/// The mean distance along each line of sight; none where too little is opaque.
pub fn distances(drawing: &Drawing<f32>) -> Vec<Option<f32>> {
    let both = drawing.distance.iter().zip(&drawing.through);
    both.map(|(distance, through)| (*through < OPAQUE).then(|| distance / (1.0 - through))).collect()
}

/// Unit normals of the surface that a view's distances draw, towards the camera: across the neighbours of each pixel;
/// none at the edge of the image or of what is opaque.
fn normals(camera: &Camera, drawing: &Drawing<f32>) -> Vec<Option<[f64; 3]>> {
    let distances = distances(drawing);
    let (width, height) = (drawing.width, drawing.height);
    let point = |x: usize, y: usize| {
        let distance = distances[y * width + x]?;
        Some(camera.point_at([x as f64 + 0.5, y as f64 + 0.5], f64::from(distance)))
    };
    let normal = |i: usize| {
        let (x, y) = (i % width, i / width);
        if x == 0 || y == 0 || x + 1 >= width || y + 1 >= height {
            return None;
        }
        let across = minus(point(x + 1, y)?, point(x - 1, y)?);
        let down = minus(point(x, y + 1)?, point(x, y - 1)?);
        unit(cross(down, across))
    };
    (0..width * height).map(normal).collect()
}

/// Normals as an image: right, up and towards the camera are more red, green and blue; black where there is none.
fn normals_shown(camera: &Camera, drawing: &Drawing<f32>) -> Image<f32> {
    let colour = |normal: Option<[f64; 3]>| {
        let seen = normal.map(|normal| camera.rotation.map(|row| dot(row, normal)));
        seen.map_or([0.0; 3], |[x, y, z]| [x, -y, -z].map(|value| (0.5 + 0.5 * value) as f32))
    };
    let samples = normals(camera, drawing).into_iter().flat_map(colour).collect();
    Image::from_raw(drawing.width, drawing.height, samples).expect("one colour a pixel")
}

/// Compares the surfaces of two drawings of one view.
///
/// # Panics
///
/// When the sizes differ.
pub fn normal_deviation(camera: &Camera, a: &Drawing<f32>, b: &Drawing<f32>) -> NormalDeviation {
    assert_eq!((a.width, a.height), (b.width, b.height), "two drawings of one view");
    let mut sum = NormalDeviation::default();
    for (a, b) in normals(camera, a).into_iter().zip(normals(camera, b)) {
        if let (Some(a), Some(b)) = (a, b) {
            let cosine = (0..3).map(|i| a[i] * b[i]).sum::<f64>().clamp(-1.0, 1.0);
            sum.angle += cosine.acos() / std::f64::consts::PI;
            sum.cosine += 1.0 - cosine;
            sum.pixels += 1;
        }
    }
    let count = sum.pixels.max(1) as f64;
    NormalDeviation { angle: sum.angle / count, cosine: sum.cosine / count, ..sum }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plane through (0, 0, 5) whose normal leans by `angle` to the side.
    fn plane(camera: &Camera, angle: f64) -> Drawing<f32> {
        let mut drawing = Drawing::zeros(camera.width, camera.height);
        for i in 0..camera.width * camera.height {
            let ray =
                camera.point_at([(i % camera.width) as f64 + 0.5, (i / camera.width) as f64 + 0.5], 1.0);
            drawing.distance[i] = (5.0 * angle.cos() / (ray[2] * angle.cos() + ray[0] * angle.sin())) as f32;
        }
        drawing
    }

    #[test]
    fn planes_deviate_by_the_angle_between_them() {
        let camera = Camera {
            width: 40,
            height: 30,
            focal: [40.0; 2],
            centre: [20.0, 15.0],
            rotation: Camera::rotation_of([1.0, 0.0, 0.0, 0.0]),
            translation: [0.0; 3],
        };
        let (flat, leaning) = (plane(&camera, 0.0), plane(&camera, 0.3));
        let found = normal_deviation(&camera, &flat, &leaning);
        assert_eq!(found.pixels, 38 * 28);
        assert!((found.angle * std::f64::consts::PI - 0.3).abs() < 1e-3, "{found:?}");
        assert!((found.cosine - (1.0 - 0.3_f64.cos())).abs() < 1e-3);
        assert!(normal_deviation(&camera, &flat, &flat).angle < 1e-6);
    }

    #[test]
    fn what_is_not_opaque_is_not_compared() {
        let camera = Camera {
            width: 8,
            height: 8,
            focal: [8.0; 2],
            centre: [4.0; 2],
            rotation: Camera::rotation_of([1.0, 0.0, 0.0, 0.0]),
            translation: [0.0; 3],
        };
        let (flat, mut empty) = (plane(&camera, 0.0), plane(&camera, 0.0));
        empty.through.fill(1.0);
        assert_eq!(normal_deviation(&camera, &flat, &empty).pixels, 0);
    }
}
