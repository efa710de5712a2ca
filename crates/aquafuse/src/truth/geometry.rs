//! Points, directions, and the distances to simple bodies.

use std::ops::{Add, Mul, Neg, Sub};

/// A point or a direction: x to the right, y up, z away from the camera, in metres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Vec3 {
    pub(super) x: f32,
    pub(super) y: f32,
    pub(super) z: f32,
}

pub(super) const fn vec3(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3 { x, y, z }
}

impl Vec3 {
    pub(super) fn dot(self, other: Self) -> f32 {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    pub(super) fn length(self) -> f32 {
        self.dot(self).sqrt()
    }

    pub(super) fn normalised(self) -> Self {
        self * (1.0 / self.length().max(1e-12))
    }

    /// Component by component.
    pub(super) fn over(self, other: Self) -> Self {
        vec3(self.x / other.x, self.y / other.y, self.z / other.z)
    }
}

impl Add for Vec3 {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        vec3(self.x + other.x, self.y + other.y, self.z + other.z)
    }
}

impl Sub for Vec3 {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        vec3(self.x - other.x, self.y - other.y, self.z - other.z)
    }
}

impl Mul<f32> for Vec3 {
    type Output = Self;
    fn mul(self, factor: f32) -> Self {
        vec3(self.x * factor, self.y * factor, self.z * factor)
    }
}

impl Neg for Vec3 {
    type Output = Self;
    fn neg(self) -> Self {
        self * -1.0
    }
}

/// A straight line from a point in a unit direction.
#[derive(Clone, Copy)]
pub(super) struct Ray {
    pub(super) origin: Vec3,
    pub(super) direction: Vec3,
}

impl Ray {
    pub(super) fn at(&self, t: f32) -> Vec3 {
        self.origin + self.direction * t
    }
}

/// A ball that holds a body, so that rays which miss it need not ask the body.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ball {
    pub(super) centre: Vec3,
    pub(super) radius: f32,
}

impl Ball {
    /// The smallest ball around the centre of the balls' bounding box that holds all of them.
    pub(super) fn around(balls: impl Iterator<Item = Ball> + Clone) -> Ball {
        let (mut low, mut high) = (vec3(1e9, 1e9, 1e9), vec3(-1e9, -1e9, -1e9));
        for Ball { centre: c, radius: r } in balls.clone() {
            low = vec3(low.x.min(c.x - r), low.y.min(c.y - r), low.z.min(c.z - r));
            high = vec3(high.x.max(c.x + r), high.y.max(c.y + r), high.z.max(c.z + r));
        }
        let centre = (low + high) * 0.5;
        let radius = balls.map(|ball| (ball.centre - centre).length() + ball.radius).fold(0.0, f32::max);
        Ball { centre, radius }
    }

    /// Where a ray enters and leaves; none if it misses or the ball lies behind.
    pub(super) fn crossing(&self, ray: &Ray) -> Option<[f32; 2]> {
        let to_centre = self.centre - ray.origin;
        let along = to_centre.dot(ray.direction);
        let half = self.radius * self.radius - (to_centre.dot(to_centre) - along * along);
        (half > 0.0 && along + half.sqrt() > 0.0).then(|| [along - half.sqrt(), along + half.sqrt()])
    }
}

/// A rod with round ends whose radius changes evenly from `a` to `b`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rod {
    pub(super) a: Vec3,
    pub(super) b: Vec3,
    radius: [f32; 2],
    /// (b - a) / |b - a|²: saves a division at each look.
    along: Vec3,
}

impl Rod {
    pub(super) fn new(a: Vec3, b: Vec3, radius: [f32; 2]) -> Self {
        let axis = b - a;
        Self { a, b, radius, along: axis * (1.0 / axis.dot(axis).max(1e-9)) }
    }

    /// Distance to the surface, and how far along the rod (0 at `a`, 1 at `b`) the nearest place is.
    pub(super) fn distance(&self, p: Vec3) -> (f32, f32) {
        let from_a = p - self.a;
        let along = from_a.dot(self.along).clamp(0.0, 1.0);
        ((from_a - (self.b - self.a) * along).length() - self.radius_at(along), along)
    }

    pub(super) fn radius_at(&self, along: f32) -> f32 {
        self.radius[0] + (self.radius[1] - self.radius[0]) * along
    }

    pub(super) fn ball(&self) -> Ball {
        let centre = (self.a + self.b) * 0.5;
        Ball { centre, radius: (self.b - self.a).length() * 0.5 + self.radius[0].max(self.radius[1]) }
    }
}

/// Rods that grow together: a coral's branches, a tuft's leaves.
#[derive(Clone, Debug)]
pub(super) struct Bunch {
    /// Rods that share a stem stand together, in a ball that spares asking each.
    stems: Vec<(Ball, Vec<Rod>)>,
}

impl Bunch {
    /// Takes the rods in their order, `per_stem` to a stem.
    pub(super) fn new(rods: &[Rod], per_stem: usize) -> Self {
        let stem = |rods: &[Rod]| (Ball::around(rods.iter().map(Rod::ball)), rods.to_vec());
        Self { stems: rods.chunks(per_stem).map(stem).collect() }
    }

    pub(super) fn ball(&self) -> Ball {
        Ball::around(self.stems.iter().map(|(ball, _)| *ball))
    }

    pub(super) fn rods(&self) -> impl Iterator<Item = &Rod> {
        self.stems.iter().flat_map(|(_, rods)| rods)
    }

    /// Distance to the nearest rod, and how far along it the nearest place is.
    pub(super) fn distance(&self, p: Vec3) -> (f32, f32) {
        // Farther than any place asks about; its square is still a number.
        let mut nearest = (1e9, 0.0);
        for (ball, rods) in &self.stems {
            let (away, reach) = (p - ball.centre, ball.radius + nearest.0);
            if away.dot(away) < reach * reach {
                for rod in rods {
                    let found = rod.distance(p);
                    if found.0 < nearest.0 {
                        nearest = found;
                    }
                }
            }
        }
        nearest
    }
}

/// Distance to an ellipsoid around the origin; exact in sign, and near the surface in size.
pub(super) fn ellipsoid(p: Vec3, radii: Vec3) -> f32 {
    let scaled = p.over(radii).length();
    let steepness = p.over(radii).over(radii).length().max(1e-6);
    scaled * (scaled - 1.0) / steepness
}

/// The smaller of two distances with the seam rounded over about `width`.
pub(super) fn join(a: f32, b: f32, width: f32) -> f32 {
    let h = (0.5 + 0.5 * (b - a) / width).clamp(0.0, 1.0);
    b + (a - b) * h - width * h * (1.0 - h)
}

/// 0 below `low`, 1 above `high`, smooth between.
pub(super) fn smooth_step(low: f32, high: f32, x: f32) -> f32 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
