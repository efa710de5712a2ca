//! A splat projected to an image: an ellipse of one colour, and the gradient back to the splat's own numbers.

use super::harmonics;
use crate::camera::{Camera, View, dot, rotation};
use crate::medium::{Between, Medium, PARAMETERS};
use crate::scalar::Scalar;
use crate::splats::{self, HARMONICS, LOG_SCALE, MEAN, OPACITY, ROTATION, Splats, part};

/// Splats nearer than this, in units of the scene, are not rendered: their ellipses have no bound.
const NEAREST: f64 = 0.05;
/// Added to the variance of an ellipse, pixels squared: no splat falls between the pixels. Published.
pub(crate) const DILATION: f64 = 0.3;
/// Opacity at a pixel below which a splat is not rendered there. Published.
pub(crate) const FAINTEST: f64 = 1.0 / 255.0;
/// The least that is kept of the square of an opacity when an ellipse is dilated: a needle has no area. As gsplat has it.
const LEAST_SHARE: f64 = 2.5e-5;
/// Slack in pixels around an ellipse's box, for rounding.
const SLACK: f64 = 0.01;

/// A splat on the image.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Footprint<T> {
    /// Which splat it is.
    pub(crate) splat: u32,
    /// Its projected mean, in pixels.
    pub(crate) mean: [T; 2],
    /// The inverse of its covariance: xx, xy, yy.
    pub(crate) conic: [T; 3],
    /// Half the sides of the box beyond which it is fainter than [`FAINTEST`].
    pub(crate) reach: [T; 2],
    /// The first row of pixels within that box, and the one behind its last; from 0 on, and beyond the image's last.
    pub(crate) rows: [u32; 2],
    pub(crate) opacity: T,
    /// Colour as seen through the medium.
    pub(crate) colour: [T; 3],
    /// Distance of its mean from the camera.
    pub(crate) distance: T,
}

/// Sums over the pixels of a footprint, from which its gradient follows.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sums<T> {
    pub(crate) colour: [T; 3],
    pub(crate) distance: T,
    /// Of v = α dL/dα, and of v times dx, dy, dx², dx dy, dy², where d leads from the projected mean to the pixel.
    pub(crate) moments: [T; 6],
}

impl<T: Scalar> Sums<T> {
    #[inline(always)]
    pub(crate) fn add(&mut self, other: &Self) {
        for c in 0..3 {
            self.colour[c] += other.colour[c];
        }
        self.distance += other.distance;
        for m in 0..6 {
            self.moments[m] += other.moments[m];
        }
    }
}

/// How splats are looked at.
#[derive(Clone, Debug)]
pub(crate) struct Sight<T> {
    pub(crate) view: View<T>,
    pub(crate) between: Between<T>,
    /// Harmonics beyond this degree are left out.
    pub(crate) degree: u8,
}

impl<T: Scalar> Sight<T> {
    pub(crate) fn of(splats: &Splats<T>, degree: u8, camera: &Camera, medium: &Medium<T>) -> Self {
        Self { view: camera.view(), between: medium.between(), degree: degree.min(splats.sh_degree()) }
    }
}

/// Whether one is more than the other; not so where a number has gone wrong.
#[inline(always)]
fn is_more<T: Scalar>(one: T, other: T) -> bool {
    one > other
}

/// What both ways share.
struct Placed<T> {
    /// From the camera's position to the splat, in the scene's axes.
    offset: [T; 3],
    distance: T,
    /// In the camera's axes.
    seen: [T; 3],
    /// x/z and y/z at which it is flattened, and whether these are its own.
    slant: [T; 2],
    own: [bool; 2],
    /// The flattening times the turn into the camera's axes: 2 x 3.
    flat: [[T; 3]; 2],
    /// The unit quaternion, and the length it had.
    quaternion: [T; 4],
    length: T,
    turn: [[T; 3]; 3],
    scale: [T; 3],
    /// The splat's axes times its deviations, on the image: 2 x 3.
    axes: [[T; 3]; 2],
    /// Covariance on the image: xx, xy, yy.
    sharp: [T; 3],
    /// The same, dilated, and its determinant.
    covariance: [T; 3],
    determinant: T,
    /// The determinant of `sharp` over that one: the square of what dilation leaves of the opacity, so that a splat hides as
    /// much as before on a larger area. This is the 2D filter of Mip-Splatting (`rasterize_mode="antialiased"` of gsplat);
    /// without it, splats that are thin in the training images are needles when they are drawn larger.
    kept: T,
}

impl<T: Scalar> Placed<T> {
    fn new(row: &[T], view: &View<T>) -> Option<Self> {
        let position: [T; 3] = part(row, MEAN);
        let seen: [T; 3] = std::array::from_fn(|i| dot(view.rotation[i], position) + view.translation[i]);
        if !is_more(seen[2], T::of(NEAREST)) {
            return None;
        }
        let inverse = T::ONE / seen[2];
        let exact = [seen[0] * inverse, seen[1] * inverse];
        let slant: [T; 2] =
            std::array::from_fn(|a| exact[a].at_least(view.limits[a][0]).at_most(view.limits[a][1]));
        let own = [slant[0] == exact[0], slant[1] == exact[1]];
        let flat: [[T; 3]; 2] = std::array::from_fn(|a| {
            let by = view.focal[a] * inverse;
            std::array::from_fn(|j| by * (view.rotation[a][j] - slant[a] * view.rotation[2][j]))
        });
        let raw: [T; 4] = part(row, ROTATION);
        let square = raw[0] * raw[0] + raw[1] * raw[1] + raw[2] * raw[2] + raw[3] * raw[3];
        let length = square.sqrt().at_least(T::of(1e-12));
        let quaternion = raw.map(|q| q / length);
        let turn = rotation(quaternion);
        let scale = part::<T, 3>(row, LOG_SCALE).map(T::exp);
        let axes: [[T; 3]; 2] = std::array::from_fn(|a| {
            std::array::from_fn(|k| {
                (flat[a][0] * turn[0][k] + flat[a][1] * turn[1][k] + flat[a][2] * turn[2][k]) * scale[k]
            })
        });
        let sharp = [dot(axes[0], axes[0]), dot(axes[0], axes[1]), dot(axes[1], axes[1])];
        let covariance = [sharp[0] + T::of(DILATION), sharp[1], sharp[2] + T::of(DILATION)];
        let determinant = covariance[0] * covariance[2] - covariance[1] * covariance[1];
        let kept = (sharp[0] * sharp[2] - sharp[1] * sharp[1]) / determinant;
        if !is_more(determinant, T::ZERO) {
            return None;
        }
        let offset: [T; 3] = std::array::from_fn(|i| position[i] - view.position[i]);
        Some(Self {
            distance: dot(offset, offset).sqrt(),
            offset,
            seen,
            slant,
            own,
            flat,
            quaternion,
            length,
            turn,
            scale,
            axes,
            sharp,
            covariance,
            determinant,
            kept,
        })
    }

    fn conic(&self) -> [T; 3] {
        let [xx, xy, yy] = self.covariance;
        [yy / self.determinant, -xy / self.determinant, xx / self.determinant]
    }

    fn direction(&self) -> [T; 3] {
        self.offset.map(|v| v / self.distance)
    }
}

/// The splat's own colour from this direction, before it is cut off at 0.
fn colour<T: Scalar>(row: &[T], degree: u8, direction: [T; 3]) -> [T; 3] {
    let basis = harmonics::basis(degree, direction);
    let mut colour = [T::of(0.5); 3];
    for (k, weight) in basis.into_iter().enumerate().take(splats::harmonics(degree)) {
        for c in 0..3 {
            colour[c] += weight * row[HARMONICS + 3 * k + c];
        }
    }
    colour
}

/// The splat of this row as it is seen; `None` if it is not.
pub(crate) fn project<T: Scalar>(splat: u32, row: &[T], sight: &Sight<T>) -> Option<Footprint<T>> {
    let Sight { view, between, degree } = sight;
    let placed = Placed::new(row, view)?;
    let opacity = row[OPACITY].sigmoid() * placed.kept.at_least(T::of(LEAST_SHARE)).sqrt();
    // Where opacity e^-power falls to the faintest: the square of that many deviations.
    let square = T::of(2.0 * (opacity.get() / FAINTEST).ln());
    if !is_more(square, T::ZERO) {
        return None;
    }
    let own = colour(row, *degree, placed.direction()).map(|v| v.at_least(T::ZERO));
    let [xx, _, yy] = placed.covariance;
    let mean: [T; 2] =
        std::array::from_fn(|a| view.focal[a] * placed.seen[a] / placed.seen[2] + view.centre[a]);
    let reach = [(square * xx).sqrt() + T::of(SLACK), (square * yy).sqrt() + T::of(SLACK)];
    let (middle, half) = (mean[1].get(), reach[1].get());
    Some(Footprint {
        splat,
        mean,
        conic: placed.conic(),
        reach,
        rows: [(middle - half - 0.5).ceil() as u32, (middle + half + 0.5).floor() as u32],
        opacity,
        colour: between.through(own, placed.distance),
        distance: placed.distance,
    })
}

/// The gradient by the projected mean of one footprint.
pub(crate) fn grad2d<T: Scalar>(footprint: &Footprint<T>, sums: &Sums<T>) -> [T; 2] {
    let [xx, xy, yy] = footprint.conic;
    let [_, x, y, ..] = sums.moments;
    [xx * x + xy * y, xy * x + yy * y]
}

/// Writes the gradient of a splat's numbers into `gradient`, and adds the water's to `water`.
pub(crate) fn back<T: Scalar>(
    row: &[T],
    sight: &Sight<T>,
    footprint: &Footprint<T>,
    sums: &Sums<T>,
    gradient: &mut [T],
    water: &mut [T; PARAMETERS],
) {
    let Sight { view, between, degree } = sight;
    let degree = *degree;
    let Some(placed) = Placed::new(row, view) else { return };
    let half = T::of(0.5);
    gradient[OPACITY] = sums.moments[0] * (T::ONE - row[OPACITY].sigmoid());

    let (mut of_position, mut of_distance) = ([T::ZERO; 3], sums.distance);
    let direction = placed.direction();
    let raw = colour(row, degree, direction);
    let own = raw.map(|v| v.at_least(T::ZERO));
    let (mut of_colour, through) = between.back(own, placed.distance, sums.colour, water);
    of_distance += through;
    for c in 0..3 {
        if raw[c] < T::ZERO {
            of_colour[c] = T::ZERO;
        }
    }
    let basis = harmonics::basis(degree, direction);
    let known = splats::harmonics(degree);
    for (k, weight) in basis.into_iter().enumerate().take(known) {
        for c in 0..3 {
            gradient[HARMONICS + 3 * k + c] = weight * of_colour[c];
        }
    }
    if degree > 0 {
        let mut of_direction = [T::ZERO; 3];
        for (k, slope) in harmonics::slopes(degree, direction).into_iter().enumerate().take(known).skip(1) {
            let weight = dot(part(row, HARMONICS + 3 * k), of_colour);
            for i in 0..3 {
                of_direction[i] += weight * slope[i];
            }
        }
        let along = dot(of_direction, direction);
        for i in 0..3 {
            of_position[i] += (of_direction[i] - along * direction[i]) / placed.distance;
        }
    }
    for i in 0..3 {
        of_position[i] += of_distance * direction[i];
    }

    let [xx, xy, yy] = footprint.conic;
    let [_, _, _, sxx, sxy, syy] = sums.moments;
    // Of the inverse of the covariance, as a symmetric matrix, then of the covariance: -Q G Q.
    let [gxx, gxy, gyy] = [-half * sxx, -half * sxy, -half * syy];
    let left = [[xx * gxx + xy * gxy, xx * gxy + xy * gyy], [xy * gxx + yy * gxy, xy * gxy + yy * gyy]];
    let mut of_covariance = [
        -(left[0][0] * xx + left[0][1] * xy),
        -(left[0][0] * xy + left[0][1] * yy),
        -(left[1][0] * xy + left[1][1] * yy),
    ];
    if placed.kept > T::of(LEAST_SHARE) {
        // Of the share that is kept, whose logarithm is half the logarithm of the determinants' ratio: half of the inverse of the
        // ellipse as it was, less half of the inverse of the dilated one.
        let [sxx, sxy, syy] = placed.sharp;
        let (by, whole) = (half * sums.moments[0], T::ONE / (placed.kept * placed.determinant));
        of_covariance[0] += by * (syy * whole - xx);
        of_covariance[1] += by * (-sxy * whole - xy);
        of_covariance[2] += by * (sxx * whole - yy);
    }
    let two = T::of(2.0);
    let [cxx, cxy, cyy] = of_covariance;
    let of_axes: [[T; 3]; 2] = [
        std::array::from_fn(|k| two * (cxx * placed.axes[0][k] + cxy * placed.axes[1][k])),
        std::array::from_fn(|k| two * (cxy * placed.axes[0][k] + cyy * placed.axes[1][k])),
    ];

    // axes = flat · turn · scale.
    let mut of_turn = [[T::ZERO; 3]; 3];
    let mut of_flat = [[T::ZERO; 3]; 2];
    for k in 0..3 {
        gradient[LOG_SCALE + k] = of_axes[0][k] * placed.axes[0][k] + of_axes[1][k] * placed.axes[1][k];
        for j in 0..3 {
            of_turn[j][k] =
                (placed.flat[0][j] * of_axes[0][k] + placed.flat[1][j] * of_axes[1][k]) * placed.scale[k];
            for a in 0..2 {
                of_flat[a][j] += of_axes[a][k] * placed.turn[j][k] * placed.scale[k];
            }
        }
    }
    let of_quaternion = turn_back(placed.quaternion, &of_turn);
    let q = placed.quaternion;
    let along = (0..4).fold(T::ZERO, |sum, i| sum + of_quaternion[i] * q[i]);
    for i in 0..4 {
        gradient[ROTATION + i] = (of_quaternion[i] - along * q[i]) / placed.length;
    }

    // mean = focal · seen/z + centre; flat = focal/z · (rotation row - slant · rotation row 2).
    let grad2d = grad2d(footprint, sums);
    let inverse = T::ONE / placed.seen[2];
    let mut of_seen = [T::ZERO; 3];
    for a in 0..2 {
        of_seen[a] += grad2d[a] * view.focal[a] * inverse;
        of_seen[2] += -grad2d[a] * view.focal[a] * placed.seen[a] * inverse * inverse;
        of_seen[2] += -dot(of_flat[a], placed.flat[a]) * inverse;
        if placed.own[a] {
            let of_slant = -view.focal[a] * inverse * dot(of_flat[a], view.rotation[2]);
            of_seen[a] += of_slant * inverse;
            of_seen[2] += -of_slant * placed.slant[a] * inverse;
        }
    }
    for i in 0..3 {
        for row in 0..3 {
            of_position[i] += view.rotation[row][i] * of_seen[row];
        }
        gradient[MEAN + i] = of_position[i];
    }
}

/// From the gradient of a rotation to that of its quaternion w, x, y, z, as four free numbers.
fn turn_back<T: Scalar>([w, x, y, z]: [T; 4], g: &[[T; 3]; 3]) -> [T; 4] {
    let two = T::of(2.0);
    [
        two * (x * (g[2][1] - g[1][2]) + y * (g[0][2] - g[2][0]) + z * (g[1][0] - g[0][1])),
        two * (y * (g[0][1] + g[1][0]) + z * (g[0][2] + g[2][0]) + w * (g[2][1] - g[1][2])
            - two * x * (g[1][1] + g[2][2])),
        two * (x * (g[0][1] + g[1][0]) + z * (g[1][2] + g[2][1]) + w * (g[0][2] - g[2][0])
            - two * y * (g[0][0] + g[2][2])),
        two * (x * (g[0][2] + g[2][0]) + y * (g[1][2] + g[2][1]) + w * (g[1][0] - g[0][1])
            - two * z * (g[0][0] + g[1][1])),
    ]
}
