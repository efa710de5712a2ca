//! Lenses: distortion, and images without it.

use aquafuse::image::Image;

use crate::camera::Camera;

/// A camera with the distortion of its lens.
#[derive(Clone, Debug, PartialEq)]
pub struct Lens {
    /// The pinhole camera without distortion.
    pub camera: Camera,
    /// k1, k2, p1, p2 of the model that COLMAP and OpenCV share; RADIAL has p1 = p2 = 0.
    pub distortion: [f64; 4],
}

impl Lens {
    /// Whether it distorts at all.
    pub fn is_distorted(&self) -> bool {
        self.distortion != [0.0; 4]
    }

    /// Where the lens projects what a pinhole camera projects to `place`, both in pixels.
    pub fn distorted(&self, place: [f64; 2]) -> [f64; 2] {
        let Camera { focal, centre, .. } = &self.camera;
        let [x, y] = [(place[0] - centre[0]) / focal[0], (place[1] - centre[1]) / focal[1]];
        let [k1, k2, p1, p2] = self.distortion;
        let square = x * x + y * y;
        let radial = 1.0 + square * (k1 + square * k2);
        let bent = [
            x * radial + 2.0 * p1 * x * y + p2 * (square + 2.0 * x * x),
            y * radial + p1 * (square + 2.0 * y * y) + 2.0 * p2 * x * y,
        ];
        [bent[0] * focal[0] + centre[0], bent[1] * focal[1] + centre[1]]
    }

    /// The image that a pinhole camera of the same focal length would have taken, with bilinear interpolation; beyond the
    /// image its edge is repeated.
    pub fn undistorted(&self, image: &Image<f32>) -> Image<f32> {
        if !self.is_distorted() {
            return image.clone();
        }
        let (width, height) = image.size();
        let samples = (0..width * height).flat_map(|i| {
            let [x, y] = self.distorted([(i % width) as f64 + 0.5, (i / width) as f64 + 0.5]);
            sample(image, x - 0.5, y - 0.5)
        });
        let samples = samples.collect();
        Image::from_raw(width, height, samples).expect("as many pixels as there were")
    }
}

/// The colour at a place between pixels.
fn sample(image: &Image<f32>, x: f64, y: f64) -> [f32; 3] {
    let (width, height) = image.size();
    let (x, y) = (x.clamp(0.0, width as f64 - 1.0), y.clamp(0.0, height as f64 - 1.0));
    let (left, top) = (x as usize, y as usize);
    let (right, bottom) = ((left + 1).min(width - 1), (top + 1).min(height - 1));
    let (across, down) = ((x - left as f64) as f32, (y - top as f64) as f32);
    let at = |x: usize, y: usize| image.pixels()[y * width + x];
    std::array::from_fn(|c| {
        let upper = at(left, top)[c] + across * (at(right, top)[c] - at(left, top)[c]);
        let lower = at(left, bottom)[c] + across * (at(right, bottom)[c] - at(left, bottom)[c]);
        upper + down * (lower - upper)
    })
}

/// An image scaled down: each pixel is the mean of the area it covers.
///
/// # Panics
///
/// When a side is 0.
pub(crate) fn shrunk(image: &Image<f32>, width: usize, height: usize) -> Image<f32> {
    if image.size() == (width, height) {
        return image.clone();
    }
    let narrow: Vec<[f32; 3]> =
        image.rows().flat_map(|row| mean_over(row.len(), width, move |x| row[x])).collect();
    let rows = image.height();
    let columns = (0..width).map(|x| mean_over(rows, height, |y| narrow[y * width + x]));
    let columns: Vec<Vec<[f32; 3]>> = columns.collect();
    let samples = (0..width * height).flat_map(|i| columns[i % width][i / width]).collect();
    Image::from_raw(width, height, samples).expect("both sides have pixels")
}

/// `count` means over equal parts of a line of `length` colours.
fn mean_over(length: usize, count: usize, at: impl Fn(usize) -> [f32; 3]) -> Vec<[f32; 3]> {
    let step = length as f64 / count as f64;
    let part = |i: usize| {
        let (begin, end) = (i as f64 * step, (i + 1) as f64 * step);
        let mut sum = [0.0_f64; 3];
        for x in begin as usize..(end.ceil() as usize).min(length) {
            let share = (end.min(x as f64 + 1.0) - begin.max(x as f64)).max(0.0);
            for c in 0..3 {
                sum[c] += share * f64::from(at(x)[c]);
            }
        }
        sum.map(|value| (value / step) as f32)
    };
    (0..count).map(part).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lens(distortion: [f64; 4]) -> Lens {
        let camera = Camera {
            width: 60,
            height: 40,
            focal: [50.0; 2],
            centre: [30.0, 20.0],
            rotation: Camera::rotation_of([1.0, 0.0, 0.0, 0.0]),
            translation: [0.0; 3],
        };
        Lens { camera, distortion }
    }

    #[test]
    fn what_a_lens_bent_comes_out_straight() {
        // An image whose red and green say where its pinhole would have drawn each pixel.
        let lens = lens([-0.2, 0.03, 0.002, -0.001]);
        let straight = |place: [f64; 2]| {
            // The other way round, by trying nearer and nearer.
            let mut guess = place;
            for _ in 0..50 {
                let there = lens.distorted(guess);
                guess = [guess[0] + place[0] - there[0], guess[1] + place[1] - there[1]];
            }
            guess
        };
        let samples = (0..60 * 40).flat_map(|i| {
            let [x, y] = straight([f64::from(i % 60) + 0.5, f64::from(i / 60) + 0.5]);
            [x as f32 / 100.0, y as f32 / 100.0, 0.0]
        });
        let bent = Image::from_raw(60, 40, samples.collect()).unwrap();
        let out = lens.undistorted(&bent);
        for (x, y) in [(30, 20), (10, 8), (50, 30), (30, 5)] {
            let [red, green, _] = out.pixels()[y * 60 + x];
            assert!((100.0 * red - x as f32 - 0.5).abs() < 0.02, "{red} at {x}, {y}");
            assert!((100.0 * green - y as f32 - 0.5).abs() < 0.02, "{green} at {x}, {y}");
        }
    }

    #[test]
    fn a_shrunk_image_keeps_its_mean() {
        let samples: Vec<f32> = (0..7 * 5 * 3).map(|i| (i * 37 % 101) as f32 / 100.0).collect();
        let image = Image::from_raw(7, 5, samples).unwrap();
        let mean = |image: &Image<f32>| image.as_raw().iter().sum::<f32>() / image.as_raw().len() as f32;
        let small = shrunk(&image, 3, 2);
        assert_eq!(small.size(), (3, 2));
        assert!((mean(&small) - mean(&image)).abs() < 1e-6);
    }
}
