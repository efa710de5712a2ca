//! New views of a scene: an orbit, and from above.
//!
//! A scene of images has no ground and no centre. The centre is what its cameras look at; up is perpendicular to their
//! right. An orbit stays where cameras stood: what no camera saw was never learned.

use std::f64::consts::{PI, TAU};

use crate::camera::{Camera, cross, dot, minus, unit};
use crate::splats::Splats;

/// Directions without a camera, radians, from which on an orbit turns back rather than cross them.
const GAP: f64 = 2.0;
/// How far an orbit sways to either side at the least, radians: cameras that stood in line would show nothing of depth.
const LEAST_SWAY: f64 = 0.08;
/// Steps in which up is made to lie across what is right of all cameras: they look down, or up, but seldom aslant. Where all
/// look the same way, it stays as it is in their images.
const LEVELLED: usize = 64;
/// Splats fainter than this do not show where objects are.
const FAINT: f32 = 0.5;
/// How far a view from above is from the middle, in distances of the cameras from it.
const ABOVE: f64 = 1.2;

/// The centre of a scene, its axes, and the range of its cameras.
#[derive(Clone, Debug)]
pub struct Around {
    /// Whose width, height and focal length all views have.
    like: Camera,
    middle: [f64; 3],
    /// Up, and level from the middle towards the cameras, and level to the right of them: unit vectors at right angles.
    up: [f64; 3],
    back: [f64; 3],
    right: [f64; 3],
    /// The cameras' mean distance from the middle.
    distance: f64,
    /// Radians about `up`, from `back` towards `right`: half way between the outermost cameras, and from there to them.
    side: [f64; 2],
    /// Radians above the level: half way between the lowest and the highest camera, and from there to them.
    height: [f64; 2],
    /// Whether cameras stood all around.
    is_closed: bool,
}

impl Around {
    /// Finds centre and axes from cameras and the splats trained on their images; `None` without a camera, or if the
    /// cameras have no common direction.
    pub fn new(cameras: &[&Camera], splats: &Splats<f32>) -> Option<Self> {
        let first = *cameras.first()?;
        let mean = |of: &dyn Fn(&Camera) -> [f64; 3]| {
            let sum = cameras.iter().map(|camera| of(camera)).fold([0.0; 3], add);
            sum.map(|value| value / cameras.len() as f64)
        };
        let upwards = |camera: &Camera| camera.rotation[1].map(|value| -value);
        let mut up = direction(mean(&upwards), 1.0).unwrap_or_else(|| upwards(first));
        for _ in 0..LEVELLED {
            // Each camera's share of leaning to a side.
            let leaning = mean(&|camera| camera.rotation[0].map(|value| value * dot(camera.rotation[0], up)));
            up = unit(minus(up, leaning)).unwrap_or(up);
        }
        let depths = cameras.iter().filter_map(|camera| depth(camera, splats));
        let (sum, seen) = depths.fold((0.0, 0_u32), |(sum, seen), depth| (sum + depth, seen + 1));
        let ahead = if seen > 0 { sum / f64::from(seen) } else { 1.0 };
        let looked_at =
            |camera: &Camera| add(camera.position(), camera.rotation[2].map(|value| ahead * value));
        let middle = mean(&looked_at);
        let apart = |camera: &Camera| minus(camera.position(), middle);

        let distances: Vec<f64> = cameras.iter().map(|camera| length(apart(camera)).max(1e-9)).collect();
        let distance = distances.iter().sum::<f64>() / distances.len() as f64;
        let level = |from: [f64; 3]| minus(from, up.map(|value| value * dot(from, up)));
        // All around, or straight above what they look at, cameras have no side of their own: that of the first will do.
        let back =
            direction(level(mean(&apart)), distance).or_else(|| unit(level(cross(first.rotation[0], up))))?;
        let right = cross(up, back);
        let sides: Vec<f64> =
            cameras.iter().map(|camera| dot(apart(camera), right).atan2(dot(apart(camera), back))).collect();
        let heights =
            cameras.iter().zip(&distances).map(|(camera, far)| (dot(apart(camera), up) / far).asin());
        let (side, is_closed) = arc(sides);
        let (low, high) = heights.fold((PI, -PI), |(low, high), angle| (low.min(angle), high.max(angle)));
        Some(Self {
            like: first.clone(),
            middle,
            up,
            back,
            right,
            distance,
            side: [side[0], side[1].max(LEAST_SWAY)],
            height: [0.5 * (low + high), 0.5 * (high - low)],
            is_closed,
        })
    }

    /// The point that the cameras look at.
    pub fn centre(&self) -> [f64; 3] {
        self.middle
    }

    /// The direction up, of length 1.
    pub fn up(&self) -> [f64; 3] {
        self.up
    }

    /// `count` views of a closed path; the last precedes the first. The path is a circle if the cameras surround the scene,
    /// otherwise an ellipse along them.
    pub fn orbit(&self, count: usize) -> Vec<Camera> {
        let view = |i: usize| {
            let turn = TAU * i as f64 / count as f64;
            let ([side, sway], [height, rise]) = (self.side, self.height);
            match self.is_closed {
                true => self.view(turn, height),
                false => self.view(side + sway * turn.sin(), height + rise * turn.cos()),
            }
        };
        (0..count).map(view).collect()
    }

    /// The view straight down; the side of the cameras is at the bottom.
    pub fn above(&self) -> Camera {
        let from = add(self.middle, self.up.map(|value| value * ABOVE * self.distance));
        self.looking(from, self.back.map(|value| -value))
    }

    fn view(&self, side: f64, height: f64) -> Camera {
        // A camera right above would not know which way is up.
        let height = height.clamp(-1.5, 1.5);
        let from = std::array::from_fn(|i| {
            let level = side.cos() * self.back[i] + side.sin() * self.right[i];
            self.middle[i] + self.distance * (height.cos() * level + height.sin() * self.up[i])
        });
        self.looking(from, self.up)
    }

    /// A camera there that looks at the middle.
    fn looking(&self, from: [f64; 3], up: [f64; 3]) -> Camera {
        let ahead = unit(minus(self.middle, from)).unwrap_or(self.back.map(|value| -value));
        let right = unit(cross(ahead, up)).unwrap_or(self.right);
        let rotation = [right, cross(ahead, right), ahead];
        let Camera { width, height, .. } = self.like;
        Camera {
            centre: [0.5 * width as f64, 0.5 * height as f64],
            translation: rotation.map(|row| -dot(row, from)),
            rotation,
            ..self.like.clone()
        }
    }
}

/// The middle of the arc that angles fill and half its width, and whether it is the whole circle: all but the widest gap
/// between neighbours, if that is one.
fn arc(mut angles: Vec<f64>) -> ([f64; 2], bool) {
    angles.sort_by(f64::total_cmp);
    let around = angles.iter().cycle().skip(1);
    let gaps = angles.iter().zip(around).map(|(from, to)| (from, (to - from).rem_euclid(TAU)));
    // One alone has the whole circle before it, which as a remainder is nothing.
    let gaps = gaps.map(|(from, gap)| (from, if angles.len() == 1 { TAU } else { gap }));
    let widest =
        gaps.fold((0.0, 0.0), |widest, (from, gap)| if gap > widest.1 { (*from, gap) } else { widest });
    let (begin, filled) = (widest.0 + widest.1, TAU - widest.1);
    let middle = (begin + 0.5 * filled + PI).rem_euclid(TAU) - PI;
    ([middle, 0.5 * filled], widest.1 < GAP)
}

/// How far ahead of a camera the middle one of the splats in its view is; none if nothing is in view.
fn depth(camera: &Camera, splats: &Splats<f32>) -> Option<f64> {
    let mut depths: Vec<f64> = (0..splats.len())
        .filter(|&i| splats.opacity(i) >= FAINT)
        .filter_map(|i| {
            let seen = camera.to_camera(splats.mean(i).map(f64::from));
            let at = |axis: usize| camera.focal[axis] * seen[axis] / seen[2] + camera.centre[axis];
            let inside = |axis: usize, side: usize| (0.0..side as f64).contains(&at(axis));
            (seen[2] > 0.0 && inside(0, camera.width) && inside(1, camera.height)).then_some(seen[2])
        })
        .collect();
    depths.sort_by(f64::total_cmp);
    depths.get(depths.len() / 2).copied()
}

/// The direction of a mean; none where what it is the mean of, so long each, cancels out.
fn direction(mean: [f64; 3], each: f64) -> Option<[f64; 3]> {
    (length(mean) > 1e-6 * each).then(|| unit(mean)).flatten()
}

fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[i] + b[i])
}

fn length(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::truth::views;
    use aquafuse::truth::Size;

    /// Cameras on a circle of radius 2 about the scene's one splat, from one angle to another, a bit above it.
    fn ring(from: f64, to: f64) -> (Vec<Camera>, Splats<f32>) {
        let mut splats = Splats::<f32>::new(0);
        splats.push(&Splats::<f32>::ball(0, [1.0, 2.0, 3.0], 0.1, 0.9, [0.5; 3]));
        let around = Around {
            like: views(1, Size { width: 40, height: 30 }, 1, 1).remove(0).camera,
            middle: [1.0, 2.0, 3.0],
            up: [0.0, -1.0, 0.0],
            back: [0.0, 0.0, -1.0],
            right: [1.0, 0.0, 0.0],
            distance: 2.0,
            side: [0.0; 2],
            height: [0.0; 2],
            is_closed: false,
        };
        let place = |i: i32| around.view(from + (to - from) * f64::from(i) / 11.0, 0.2);
        ((0..12).map(place).collect(), splats)
    }

    fn around(from: f64, to: f64) -> Around {
        let (cameras, splats) = ring(from, to);
        Around::new(&cameras.iter().collect::<Vec<_>>(), &splats).unwrap()
    }

    /// Where a camera sees the middle of the scene.
    fn seen(camera: &Camera) -> [f64; 3] {
        camera.to_camera([1.0, 2.0, 3.0])
    }

    #[test]
    fn all_views_look_at_what_the_cameras_looked_at() {
        let around = around(-0.6, 0.9);
        let views = around.orbit(7);
        for camera in views.iter().chain([&around.above()]) {
            let [x, y, z] = seen(camera);
            assert!(x.abs() < 0.1 && y.abs() < 0.1 && z > 1.0, "{x} {y} {z}");
        }
        assert!(views.iter().all(|camera| (seen(camera)[2] - 2.0).abs() < 0.05));
        let down = around.above().rotation[2];
        assert!(down[1] > 0.999, "the view from above looks down: {down:?}");
    }

    #[test]
    fn an_orbit_stays_where_cameras_stood() {
        // y of a camera that looks level along a circle: how far to the side it stands.
        let side = |camera: &Camera| camera.position()[0] - 1.0;
        let swaying = around(-0.6, 0.6).orbit(64);
        assert!(swaying.iter().all(|camera| camera.position()[2] < 3.0 && side(camera).abs() < 1.3));
        let closed = around(0.0, TAU * 11.0 / 12.0).orbit(64);
        assert!(closed.iter().any(|camera| camera.position()[2] > 4.5));
        assert!(closed.iter().any(|camera| camera.position()[2] < 1.5));
    }

    #[test]
    fn an_arc_is_found_across_the_turn_of_the_angle() {
        let ([middle, half], closed) = arc(vec![3.0, -3.0, 2.8]);
        assert!((half - 0.5 * (0.2 + TAU - 6.0)).abs() < 1e-9 && !closed);
        assert!((middle - (2.8 + half)).abs() < 1e-9);
        assert_eq!(arc(vec![0.5]), ([0.5, 0.0], false));
        assert!(arc(vec![0.0, 1.5, 3.0, -1.5]).1);
    }

    #[test]
    fn cameras_in_one_line_still_sway() {
        let (cameras, splats) = ring(0.3, 0.3);
        let around = Around::new(&cameras.iter().collect::<Vec<_>>(), &splats).unwrap();
        let apart = minus(around.orbit(4)[1].position(), around.orbit(4)[3].position());
        assert!(length(apart) > 0.2, "{apart:?}");
        assert!(Around::new(&[], &splats).is_none());
    }
}
