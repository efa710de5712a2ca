//! What lives and lies on the floor: how far it is, and what colour.

use super::floor::mix;
use super::geometry::{Ball, Bunch, Rod, Vec3, ellipsoid, join, smooth_step, vec3};
use super::noise::{noise, rough};

/// A body with its colours, and a ball that holds it.
#[derive(Clone, Debug)]
pub(super) struct Thing {
    pub(super) shape: Shape,
    /// Linear reflectance: of the body, and of its pattern.
    pub(super) colours: [Vec3; 2],
    pub(super) ball: Ball,
}

#[derive(Clone, Debug)]
pub(super) enum Shape {
    /// A boulder, worn and overgrown.
    Rock { centre: Vec3, radii: Vec3, offset: f32 },
    /// A block with worn edges, turned about the vertical by `turn` radians.
    Block { centre: Vec3, half: Vec3, turn: f32 },
    /// A round coral with winding grooves.
    Brain { centre: Vec3, radius: f32 },
    /// A branching coral.
    Branches(Bunch),
    /// A cluster of hollow sponges.
    Tubes(Vec<Rod>),
    /// A tuft of long leaves.
    Leaves(Bunch),
    /// A fish heading along `ahead`, level.
    Fish { centre: Vec3, ahead: Vec3, length: f32, pattern: Pattern },
}

#[derive(Clone, Copy, Debug)]
pub(super) enum Pattern {
    Bars,
    Band,
    TwoTone,
}

impl Thing {
    pub(super) fn new(shape: Shape, colours: [Vec3; 2]) -> Self {
        let ball = match &shape {
            Shape::Rock { centre, radii, .. } => {
                Ball { centre: *centre, radius: 1.25 * radii.x.max(radii.y).max(radii.z) }
            }
            Shape::Block { centre, half, .. } => Ball { centre: *centre, radius: half.length() + 0.05 },
            Shape::Brain { centre, radius } => Ball { centre: *centre, radius: 1.1 * radius },
            Shape::Branches(bunch) | Shape::Leaves(bunch) => bunch.ball(),
            Shape::Tubes(rods) => Ball::around(rods.iter().map(Rod::ball)),
            Shape::Fish { centre, length, .. } => Ball { centre: *centre, radius: 0.75 * length },
        };
        Self { shape, colours, ball }
    }

    /// Distance to the surface; negative inside. Never larger than the true distance by much.
    pub(super) fn distance(&self, p: Vec3) -> f32 {
        match &self.shape {
            Shape::Rock { centre, radii, offset } => {
                let q = p - *centre;
                let smallest = radii.x.min(radii.y).min(radii.z);
                let smooth = ellipsoid(q, *radii);
                if smooth > 0.6 * smallest {
                    // Lumps reach out half of that at most.
                    return smooth - 0.35 * smallest;
                }
                let lumps = rough(q * (1.3 / smallest) + vec3(*offset, 0.0, 0.0), 3) - 0.5;
                let lumpy = smooth - 0.66 * smallest * lumps;
                if lumpy > 0.08 {
                    return 0.75 * lumpy - 0.02;
                }
                0.75 * (lumpy - 0.05 * (rough(q * 9.0 + vec3(0.0, *offset, 0.0), 2) - 0.5))
            }
            Shape::Block { centre, half, turn } => {
                let q = turned(p - *centre, *turn);
                0.9 * (block(q, *half) - 0.03 * noise(p * 7.0))
            }
            Shape::Brain { centre, radius } => {
                let q = p - *centre;
                0.85 * (q.length() - radius * (1.0 + 0.035 * grooves(q * (1.0 / radius))))
            }
            Shape::Branches(bunch) => {
                let (bare, _) = bunch.distance(p);
                if bare > 0.05 {
                    return bare - 0.006;
                }
                0.9 * (bare - 0.006 * noise(p * 70.0))
            }
            Shape::Tubes(rods) => {
                let of = |rod: &Rod| {
                    let (outside, along) = rod.distance(p);
                    let radius = rod.radius_at(along);
                    // Cut flat at the top and bored out.
                    let above = (p - rod.b).dot((rod.b - rod.a).normalised());
                    outside.max(above).max(if along > 0.4 { -(outside + 0.35 * radius) } else { -9.0 })
                };
                0.8 * (rods.iter().map(of).fold(9.0, f32::min) - 0.008 * noise(p * 30.0))
            }
            Shape::Leaves(bunch) => bunch.distance(p).0,
            Shape::Fish { centre, ahead, length, .. } => {
                let q = fish_frame(p - *centre, *ahead) * (1.0 / length);
                0.8 * length * fish(q)
            }
        }
    }

    /// Linear reflectance at a place on the surface with this normal.
    pub(super) fn albedo(&self, p: Vec3, normal: Vec3) -> Vec3 {
        let [body, second] = self.colours;
        match &self.shape {
            Shape::Rock { offset, .. } => {
                let bare = body * (0.65 + 0.7 * rough(p * 6.0, 3));
                let patches = rough(p * 2.6 + vec3(*offset, 3.0, 0.0), 4);
                let overgrown =
                    mix(bare, second * (0.7 + 0.6 * noise(p * 40.0)), smooth_step(0.52, 0.60, patches));
                let algae = smooth_step(0.50, 0.64, rough(p * 4.0 + vec3(0.0, *offset, 9.0), 4));
                let topped =
                    mix(overgrown, vec3(0.20, 0.24, 0.08), 0.8 * algae * smooth_step(0.1, 0.8, normal.y));
                let spots = smooth_step(0.72, 0.78, noise(p * 11.0));
                mix(topped, vec3(0.75, 0.50, 0.55), 0.7 * spots)
            }
            Shape::Block { .. } => {
                let bare = body * (0.6 + 0.5 * rough(p * 9.0, 3));
                let patches = smooth_step(0.46, 0.60, rough(p * 2.1, 4));
                mix(bare, second * (0.7 + 0.6 * noise(p * 30.0)), patches)
            }
            Shape::Brain { centre, radius } => {
                let groove = grooves((p - *centre) * (1.0 / radius));
                mix(second, body, smooth_step(-0.4, 0.5, groove))
            }
            Shape::Branches(bunch) => {
                let (_, tip) = bunch.distance(p);
                mix(body * (0.75 + 0.5 * noise(p * 45.0)), second, smooth_step(0.55, 1.0, tip))
            }
            Shape::Tubes(_) => mix(body, second, smooth_step(0.35, 0.75, noise(p * 22.0))),
            Shape::Leaves(bunch) => {
                let root = bunch.rods().next().map_or(p.y, |rod| rod.a.y);
                let height = smooth_step(0.0, 0.8, p.y - root);
                mix(body, second, height) * (0.75 + 0.5 * noise(vec3(90.0 * p.x, 6.0 * p.y, 90.0 * p.z)))
            }
            Shape::Fish { centre, ahead, length, pattern } => {
                let q = fish_frame(p - *centre, *ahead) * (1.0 / length);
                let eye = (vec3(q.x - 0.36, q.y - 0.035, 0.0)).length();
                if eye < 0.028 {
                    return vec3(0.01, 0.01, 0.01);
                }
                if eye < 0.042 {
                    return vec3(0.85, 0.80, 0.55);
                }
                let marked = match pattern {
                    Pattern::Bars => smooth_step(0.1, 0.5, (26.0 * q.x).sin()),
                    Pattern::Band => smooth_step(0.05, 0.035, q.y.abs()) + smooth_step(-0.30, -0.36, q.x),
                    Pattern::TwoTone => smooth_step(-0.02, 0.10, q.x - 1.2 * q.y),
                };
                let scales = 0.85 + 0.3 * noise(q * 70.0);
                // A paler belly hides a fish from below: countershading.
                let shade = 1.0 + 0.25 * smooth_step(0.02, -0.14, q.y);
                mix(body, second, marked.min(1.0)) * (scales * shade)
            }
        }
    }
}

/// Winding ridges on a unit ball, about -1 to 1.
fn grooves(q: Vec3) -> f32 {
    let warp =
        vec3(noise(q * 3.0), noise(q * 3.0 + vec3(9.0, 0.0, 0.0)), noise(q * 3.0 + vec3(0.0, 9.0, 0.0)));
    (46.0 * (noise(q * 2.2 + warp * 0.8) - 0.5)).sin()
}

/// A place seen from a body that is turned about the vertical.
fn turned(q: Vec3, turn: f32) -> Vec3 {
    let (sin, cos) = turn.sin_cos();
    vec3(q.x * cos + q.z * sin, q.y, q.z * cos - q.x * sin)
}

/// Distance to a box around the origin.
fn block(q: Vec3, half: Vec3) -> f32 {
    let out = vec3(q.x.abs() - half.x, q.y.abs() - half.y, q.z.abs() - half.z);
    let outside = vec3(out.x.max(0.0), out.y.max(0.0), out.z.max(0.0)).length();
    outside + out.x.max(out.y).max(out.z).min(0.0)
}

/// Coordinates of a fish: x ahead, y up, z to its side.
fn fish_frame(q: Vec3, ahead: Vec3) -> Vec3 {
    let side = vec3(-ahead.z, 0.0, ahead.x);
    vec3(q.dot(ahead), q.y, q.dot(side))
}

/// A fish of length 1 around the origin.
fn fish(q: Vec3) -> f32 {
    let body = ellipsoid(q - vec3(0.10, 0.0, 0.0), vec3(0.40, 0.165, 0.075));
    let stem = ellipsoid(q - vec3(-0.22, 0.0, 0.0), vec3(0.20, 0.055, 0.030));
    // The tail widens backwards and is forked.
    let back = (-0.26 - q.x).max(0.0);
    let fork = q.y.abs() - 0.72 * back;
    let notch = 0.16 - (0.5 + q.x) - 0.55 * q.y.abs();
    let tail = fork.max(q.z.abs() - 0.012).max(-0.26 + q.x.abs() - 0.20).max(q.x + 0.26).max(notch);
    let dorsal = ellipsoid(q - vec3(0.06, 0.13, 0.0), vec3(0.22, 0.085, 0.012));
    let belly = ellipsoid(q - vec3(-0.02, -0.13, 0.0), vec3(0.12, 0.075, 0.010));
    join(join(body, stem, 0.06), tail.min(dorsal).min(belly), 0.015)
}
