//! How alike two scenes are: images by PSNR and SSIM, surfaces by the deviation of their normals.
//!
//! `report.rs` puts a scene beside the same one fused and makes a [`Report`](aquafuse_data::evaluate::Report) of it.

mod normals;
mod report;

pub use report::{CompareError, Comparison, Side};

use aquafuse::image::Image;

use crate::camera::{Camera, dot};
use crate::render::Rendering;
use normals::normals;

/// The highest transmittance at which a surface counts as seen.
const OPAQUE: f32 = 0.1;

/// Surface-normal deviation between two renderings of one view, over pixels where both show a surface (`normals.rs`).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NormalDeviation {
    /// SND: the mean angle between normals, of 180°, 0 to 1.
    pub angle: f64,
    /// The mean of 1 - cos of it.
    pub cosine: f64,
    /// Pixels that were compared.
    pub pixels: usize,
}

/// The colours of a rendering as an image, clipped to [0, 1].
pub fn image(rendering: &Rendering<f32>) -> Image<f32> {
    let samples = rendering.pixels().flatten().map(|value| value.clamp(0.0, 1.0)).collect();
    Image::from_raw(rendering.width, rendering.height, samples).expect("one colour a pixel")
}

/// The mean distance along each line of sight; `None` where too little is opaque.
pub fn distances(rendering: &Rendering<f32>) -> Vec<Option<f32>> {
    let both = rendering.distance.iter().zip(&rendering.transmittance);
    both.map(|(distance, transmittance)| (*transmittance < OPAQUE).then(|| distance / (1.0 - transmittance)))
        .collect()
}

/// Normals as an image: right, up and towards the camera are more red, green and blue; black where no normal is known.
fn normals_shown(camera: &Camera, rendering: &Rendering<f32>) -> Image<f32> {
    let colour = |normal: Option<[f64; 3]>| {
        let seen = normal.map(|normal| camera.rotation.map(|row| dot(row, normal)));
        seen.map_or([0.0; 3], |[x, y, z]| [x, -y, -z].map(|value| (0.5 + 0.5 * value) as f32))
    };
    let samples = normals(camera, rendering).into_iter().flat_map(colour).collect();
    Image::from_raw(rendering.width, rendering.height, samples).expect("one colour a pixel")
}

/// Compares the surfaces of two renderings of one view.
///
/// # Panics
///
/// When the sizes differ.
pub fn normal_deviation(camera: &Camera, a: &Rendering<f32>, b: &Rendering<f32>) -> NormalDeviation {
    assert_eq!((a.width, a.height), (b.width, b.height), "two renderings of one view");
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
    fn plane(camera: &Camera, angle: f64) -> Rendering<f32> {
        let mut rendering = Rendering::zeros(camera.width, camera.height);
        for i in 0..camera.width * camera.height {
            let ray =
                camera.point_at([(i % camera.width) as f64 + 0.5, (i / camera.width) as f64 + 0.5], 1.0);
            rendering.distance[i] =
                (5.0 * angle.cos() / (ray[2] * angle.cos() + ray[0] * angle.sin())) as f32;
        }
        rendering
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
        // All but those whose window would reach beyond the edge.
        assert_eq!(found.pixels, 36 * 26);
        assert!((found.angle * std::f64::consts::PI - 0.3).abs() < 1e-3, "{found:?}");
        assert!((found.cosine - (1.0 - 0.3_f64.cos())).abs() < 1e-3);
        assert!(normal_deviation(&camera, &flat, &flat).angle < 1e-6);
    }

    /// Distances are known to a per cent or so: from pixel to pixel that would be any slope.
    #[test]
    fn what_is_uncertain_at_each_pixel_is_certain_over_a_window() {
        let camera = Camera {
            width: 200,
            height: 150,
            focal: [170.0; 2],
            centre: [100.0, 75.0],
            rotation: Camera::rotation_of([1.0, 0.0, 0.0, 0.0]),
            translation: [0.0; 3],
        };
        let (flat, mut uncertain) = (plane(&camera, 0.0), plane(&camera, 0.0));
        let mut state = 1_u32;
        for distance in &mut uncertain.distance {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            *distance *= 1.0 + 0.01 * ((state >> 8) as f32 / (1 << 23) as f32 - 1.0);
        }
        let found = normal_deviation(&camera, &flat, &uncertain);
        assert!(found.pixels > 20_000 && found.angle < 0.015, "{found:?}");
        // A step is no surface.
        let mut step = plane(&camera, 0.0);
        step.distance.chunks_exact_mut(200).for_each(|row| row[100..].iter_mut().for_each(|v| *v *= 2.0));
        let across = normal_deviation(&camera, &flat, &step);
        assert!(across.angle < 0.005 && across.pixels > 20_000 && across.pixels < 27_000, "{across:?}");
    }

    #[test]
    fn transparent_pixels_are_not_compared() {
        let camera = Camera {
            width: 8,
            height: 8,
            focal: [8.0; 2],
            centre: [4.0; 2],
            rotation: Camera::rotation_of([1.0, 0.0, 0.0, 0.0]),
            translation: [0.0; 3],
        };
        let (flat, mut empty) = (plane(&camera, 0.0), plane(&camera, 0.0));
        empty.transmittance.fill(1.0);
        assert_eq!(normal_deviation(&camera, &flat, &empty).pixels, 0);
    }
}
