//! Points on surfaces, as structure from motion finds them, and the splats that training begins with.

use crate::camera::Camera;
use crate::random::Random;
use crate::splats::Splats;

/// A point of the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Where it is.
    pub position: [f64; 3],
    /// Its colour in the images, encoded, in [0, 1].
    pub colour: [f64; 3],
}

/// Opacity that splats begin with (`init_opa` of gsplat). Published: .1, for ten times as many steps.
const OPACITY: f64 = 0.5;
/// What splats begin with of the distance to their neighbours (`init_scale` of gsplat). Published: 1. Smaller ones leave gaps
/// that training closes; larger ones hide each other, and are slow to shrink.
const SCALE: f64 = 0.6;
/// The neighbours that the first scale of a splat is computed from. Published.
const NEIGHBOURS: usize = 3;
/// The least it may be, units of the scene: two points at one place.
const LEAST: f64 = 1e-4;

/// One ball a point; its scale is six tenths of the root mean square distance to its three nearest neighbours.
pub fn splats(points: &[Point], degree: u8) -> Splats<f32> {
    let mut splats = Splats::new(degree);
    for (point, radius) in points.iter().zip(radii(points)) {
        let row = Splats::<f32>::ball(degree, point.position, SCALE * radius, OPACITY, point.colour);
        splats.push(&row);
    }
    splats
}

/// The means of splats with an opacity of at least 0.5, in their own colours: a point cloud.
pub fn means(splats: &Splats<f32>) -> Vec<Point> {
    let opaque = (0..splats.len()).filter(|&i| splats.opacity(i) >= 0.5);
    opaque
        .map(|i| Point {
            position: splats.mean(i).map(f64::from),
            colour: splats.colour(i).map(|value| f64::from(value.clamp(0.0, 1.0))),
        })
        .collect()
}

/// Random points in the views of cameras, for a scene without points: on lines of sight, uniform in the logarithm of the
/// distance.
///
/// `extent` is the size of the camera positions: points are half to twenty times as far away.
pub fn scattered(cameras: &[&Camera], extent: f64, count: usize, seed: u64) -> Vec<Point> {
    let mut random = Random(seed);
    let points = (0..count).filter_map(|_| {
        let camera = cameras.get(random.below(cameras.len().max(1)))?;
        let place = [random.unit() * camera.width as f64, random.unit() * camera.height as f64];
        let distance = extent * 0.5 * 40.0_f64.powf(random.unit());
        Some(Point { position: camera.point_at(place, distance), colour: [0.5; 3] })
    });
    points.collect()
}

/// Of length 1.
const AXIS: [f64; 3] = [0.8, 0.48, 0.36];

/// The root of the mean square distance to the nearest neighbours of each point.
///
/// Points are sorted along a slanted axis, which walls and floors are not square to; from each, neighbours are looked for to
/// both sides until the axis alone is farther than the nearest found.
fn radii(points: &[Point]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    let along: Vec<f64> =
        points.iter().map(|point| point.position.iter().zip(AXIS).map(|(v, of)| v * of).sum()).collect();
    order.sort_by(|&a, &b| along[a].total_cmp(&along[b]).then(a.cmp(&b)));
    let mut radii = vec![LEAST; points.len()];
    for (rank, &i) in order.iter().enumerate() {
        let mut nearest = [f64::INFINITY; NEIGHBOURS];
        for_each_nearer(&order, rank, |j, farthest| {
            let apart: [f64; 3] = std::array::from_fn(|a| points[j].position[a] - points[i].position[a]);
            // Beyond what rounding may have made of it; and nothing is nearer than what is in the same place.
            if (along[j] - along[i]).powi(2) > *farthest * (1.0 + 1e-9) || *farthest == 0.0 {
                return false;
            }
            let square = apart.iter().map(|v| v * v).sum::<f64>();
            if square < nearest[NEIGHBOURS - 1] {
                nearest[NEIGHBOURS - 1] = square;
                nearest.sort_by(f64::total_cmp);
                *farthest = nearest[NEIGHBOURS - 1];
            }
            true
        });
        let found: Vec<f64> = nearest.into_iter().filter(|square| square.is_finite()).collect();
        if !found.is_empty() {
            radii[i] = (found.iter().sum::<f64>() / found.len() as f64).sqrt().max(LEAST);
        }
    }
    radii
}

/// Asks about neighbours to both sides in turn, each side until `near` says no.
fn for_each_nearer(order: &[usize], rank: usize, mut near: impl FnMut(usize, &mut f64) -> bool) {
    let mut farthest = f64::INFINITY;
    let (mut below, mut above) = (order[..rank].iter().rev(), order[rank + 1..].iter());
    let (mut go_below, mut go_above) = (true, true);
    while go_below || go_above {
        go_below = go_below && below.next().is_some_and(|&j| near(j, &mut farthest));
        go_above = go_above && above.next().is_some_and(|&j| near(j, &mut farthest));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As many as would take minutes if each were looked at from each.
    #[test]
    fn points_on_a_wall_and_points_in_one_place_are_not_all_looked_at() {
        let wall = |i: i32| [5.0, f64::from(i % 300), f64::from(i / 300)];
        let points = |place: &dyn Fn(i32) -> [f64; 3]| -> Vec<Point> {
            (0..90_000).map(|i| Point { position: place(i), colour: [0.5; 3] }).collect()
        };
        assert!(radii(&points(&wall)).iter().all(|radius| (1.0..1.5).contains(radius)));
        assert!(radii(&points(&|_| [1.0, 2.0, 3.0])).iter().all(|&radius| radius == LEAST));
    }

    #[test]
    fn radii_are_those_of_looking_at_every_point() {
        let mut state = 7_u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8)
        };
        let points: Vec<Point> = (0..200)
            .map(|_| Point { position: [next() / 1e7, next() / 1e7, next() / 1e7], colour: [0.5; 3] })
            .collect();
        for (point, radius) in points.iter().zip(radii(&points)) {
            let mut squares: Vec<f64> = points
                .iter()
                .map(|other| (0..3).map(|a| (other.position[a] - point.position[a]).powi(2)).sum())
                .collect();
            squares.sort_by(f64::total_cmp);
            let mean = squares[1..=3].iter().sum::<f64>() / 3.0;
            assert!((mean.sqrt() - radius).abs() < 1e-9);
        }
    }

    #[test]
    fn faint_splats_are_no_points() {
        let mut splats = Splats::<f32>::new(0);
        for (x, opacity) in [(1.0, 0.9), (2.0, 0.3), (3.0, 0.6)] {
            splats.push(&Splats::<f32>::ball(0, [x, 0.0, 0.0], 0.1, opacity, [0.25, 0.5, 0.75]));
        }
        let points = means(&splats);
        assert_eq!(points.iter().map(|point| point.position[0]).collect::<Vec<_>>(), [1.0, 3.0]);
        assert!((points[0].colour[2] - 0.75).abs() < 1e-6);
    }

    #[test]
    fn a_point_alone_and_points_at_one_place_have_a_size() {
        let point = Point { position: [1.0, 2.0, 3.0], colour: [0.2; 3] };
        for count in 1..4 {
            let splats = splats(&vec![point; count], 1);
            assert_eq!(splats.len(), count);
            assert!(splats.rows().iter().all(|v| v.is_finite()));
        }
    }
}
