//! The pose of an image, and the projection of its camera.

use crate::scalar::Scalar;

/// A pinhole camera with its pose.
///
/// Axes are those of COLMAP and OpenCV: x to the right, y down, z ahead. A point p of the scene is `R p + t` for the
/// camera, and is projected to `(fx x/z + cx, fy y/z + cy)`, where the centre of the first pixel is (0.5, 0.5).
/// Lens distortion is taken out of images when they are loaded, so that there is none here.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Columns of its images, > 0.
    pub width: usize,
    /// Rows of its images, > 0.
    pub height: usize,
    /// fx and fy, in pixels, > 0.
    pub focal: [f64; 2],
    /// cx and cy, in pixels from the outer corner of the first.
    pub centre: [f64; 2],
    /// R, a rotation, rows first.
    pub rotation: [[f64; 3]; 3],
    /// t, in units of the scene.
    pub translation: [f64; 3],
}

impl Camera {
    /// Where it stands, -Rᵀ t.
    pub fn position(&self) -> [f64; 3] {
        std::array::from_fn(|i| -(0..3).map(|row| self.rotation[row][i] * self.translation[row]).sum::<f64>())
    }

    /// A point of the scene as the camera has it.
    pub fn to_camera(&self, point: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|row| dot(self.rotation[row], point) + self.translation[row])
    }

    /// The point of the scene that lies `distance` along the line of sight of a place on the image.
    pub fn point_at(&self, place: [f64; 2], distance: f64) -> [f64; 3] {
        let ray =
            [(place[0] - self.centre[0]) / self.focal[0], (place[1] - self.centre[1]) / self.focal[1], 1.0];
        let along = distance / dot(ray, ray).sqrt();
        let position = self.position();
        std::array::from_fn(|i| {
            position[i] + along * (0..3).map(|row| self.rotation[row][i] * ray[row]).sum::<f64>()
        })
    }

    /// The rotation of a unit quaternion w, x, y, z, rows first.
    pub fn rotation_of(quaternion: [f64; 4]) -> [[f64; 3]; 3] {
        rotation(quaternion)
    }

    /// The unit quaternion w, x, y, z of its rotation, w >= 0.
    pub fn quaternion(&self) -> [f64; 4] {
        let r = &self.rotation;
        // Each part squared, four times; the root is taken of the largest, and the others follow from it.
        let squares = [
            1.0 + r[0][0] + r[1][1] + r[2][2],
            1.0 + r[0][0] - r[1][1] - r[2][2],
            1.0 - r[0][0] + r[1][1] - r[2][2],
            1.0 - r[0][0] - r[1][1] + r[2][2],
        ];
        let (wx, wy, wz) = (r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]);
        let (xy, xz, yz) = (r[0][1] + r[1][0], r[0][2] + r[2][0], r[1][2] + r[2][1]);
        let products = [
            [squares[0], wx, wy, wz],
            [wx, squares[1], xy, xz],
            [wy, xy, squares[2], yz],
            [wz, xz, yz, squares[3]],
        ];
        let largest = (1..4).fold(0, |largest, i| if squares[i] > squares[largest] { i } else { largest });
        let row = products[largest];
        let sign = if row[0] < 0.0 { -1.0 } else { 1.0 };
        let length = row.iter().map(|value| value * value).sum::<f64>().sqrt().max(f64::MIN_POSITIVE);
        row.map(|value| sign * value / length)
    }

    /// The same view at so many columns and rows.
    #[must_use]
    pub fn scaled_to(&self, width: usize, height: usize) -> Self {
        let scale = [width as f64 / self.width as f64, height as f64 / self.height as f64];
        Self {
            width,
            height,
            focal: [self.focal[0] * scale[0], self.focal[1] * scale[1]],
            centre: [self.centre[0] * scale[0], self.centre[1] * scale[1]],
            ..self.clone()
        }
    }

    /// The same camera in the numbers a scene is computed in.
    pub(crate) fn view<T: Scalar>(&self) -> View<T> {
        let of = |values: [f64; 3]| values.map(T::of);
        let half = [0.5 * self.width as f64 / self.focal[0], 0.5 * self.height as f64 / self.focal[1]];
        let sides = [self.width as f64, self.height as f64];
        let limit = |axis: usize| {
            let beyond = MARGIN * half[axis];
            let (low, high) = (
                -self.centre[axis] / self.focal[axis] - beyond,
                (sides[axis] - self.centre[axis]) / self.focal[axis] + beyond,
            );
            [T::of(low), T::of(high)]
        };
        View {
            focal: self.focal.map(T::of),
            centre: self.centre.map(T::of),
            rotation: self.rotation.map(of),
            translation: of(self.translation),
            position: of(self.position()),
            limits: [limit(0), limit(1)],
        }
    }
}

/// How far beyond the edge of the image, in half images, a splat's own place is used to flatten it. Farther out
/// the flattening, which is right at a point only, would blow splats up that just reach in; published: .3.
const MARGIN: f64 = 0.3;

/// A camera as projection needs it.
#[derive(Clone, Debug)]
pub(crate) struct View<T> {
    pub(crate) focal: [T; 2],
    pub(crate) centre: [T; 2],
    pub(crate) rotation: [[T; 3]; 3],
    pub(crate) translation: [T; 3],
    pub(crate) position: [T; 3],
    /// The least and greatest x/z and y/z at which splats are flattened.
    pub(crate) limits: [[T; 2]; 2],
}

/// The product of two directions.
#[inline(always)]
pub(crate) fn dot<T: Scalar>(a: [T; 3], b: [T; 3]) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The direction at right angles to two others, by the right hand.
pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// From `b` to `a`.
pub(crate) fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[i] - b[i])
}

/// The direction of a vector; `None` if it has no length.
pub(crate) fn unit(a: [f64; 3]) -> Option<[f64; 3]> {
    let length = dot(a, a).sqrt();
    (length > 0.0).then(|| a.map(|value| value / length))
}

/// The rotation of a unit quaternion w, x, y, z, rows first.
#[inline(always)]
pub(crate) fn rotation<T: Scalar>([w, x, y, z]: [T; 4]) -> [[T; 3]; 3] {
    let two = T::ONE + T::ONE;
    let one = T::ONE;
    [
        [one - two * (y * y + z * z), two * (x * y - w * z), two * (x * z + w * y)],
        [two * (x * y + w * z), one - two * (x * x + z * z), two * (y * z - w * x)],
        [two * (x * z - w * y), two * (y * z + w * x), one - two * (x * x + y * y)],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turned() -> Camera {
        Camera {
            width: 40,
            height: 30,
            focal: [50.0, 45.0],
            centre: [19.0, 16.0],
            rotation: Camera::rotation_of([0.8, 0.36, -0.48, 0.0]),
            translation: [0.3, -1.0, 2.0],
        }
    }

    #[test]
    fn a_point_on_a_line_of_sight_is_drawn_where_the_line_was_asked_for() {
        let camera = turned();
        let seen = camera.to_camera(camera.point_at([7.5, 22.5], 3.0));
        assert!((dot(seen, seen).sqrt() - 3.0).abs() < 1e-12);
        assert!((50.0 * seen[0] / seen[2] + 19.0 - 7.5).abs() < 1e-12);
        assert!((45.0 * seen[1] / seen[2] + 16.0 - 22.5).abs() < 1e-12);
    }

    #[test]
    fn a_rotation_and_its_quaternion_are_the_same_turn() {
        for quaternion in
            [[0.8, 0.36, -0.48, 0.0], [0.1, 0.7, 0.1, 0.7], [0.0, 0.0, 0.6, -0.8], [0.5, -0.5, 0.5, 0.5]]
        {
            let camera = Camera { rotation: Camera::rotation_of(quaternion), ..turned() };
            let found = camera.quaternion();
            let sign =
                if found.iter().zip(quaternion).map(|(a, b)| a * b).sum::<f64>() < 0.0 { -1.0 } else { 1.0 };
            assert!(found[0] >= 0.0);
            assert!(
                found.iter().zip(quaternion).all(|(a, b)| (sign * a - b).abs() < 1e-12),
                "{found:?} {quaternion:?}"
            );
        }
    }

    #[test]
    fn a_camera_is_its_own_origin() {
        let camera = turned();
        assert!(camera.to_camera(camera.position()).iter().all(|v| v.abs() < 1e-12));
    }
}
