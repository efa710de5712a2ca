//! The ground: gentle dunes that rise to one side, with ripples and scattered pebbles.

use super::geometry::{Vec3, smooth_step, vec3};
use super::noise::{cells, noise, noise_2d, rough};

/// The shape of the floor.
#[derive(Clone, Copy, Debug)]
pub(super) struct Floor {
    /// Moves the dunes: each place has its own.
    pub(super) offset: f32,
    /// Rise to the reef's side, metres a metre; its sign is the side.
    pub(super) slope: f32,
    /// What it is made of.
    pub(super) ground: Ground,
    /// How much deeper than the camera's ground it lies, metres.
    pub(super) below: f32,
}

/// Linear reflectances of the ground: bare in two shades, and what grows on it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ground {
    bare: [Vec3; 2],
    growth: Vec3,
}

pub(super) const SAND: Ground =
    Ground { bare: [vec3(0.60, 0.50, 0.36), vec3(0.42, 0.34, 0.24)], growth: vec3(0.17, 0.19, 0.09) };
pub(super) const MUD: Ground =
    Ground { bare: [vec3(0.34, 0.31, 0.27), vec3(0.19, 0.18, 0.17)], growth: vec3(0.10, 0.09, 0.07) };

/// Nothing of the floor rises above this, so rays above it need not ask.
pub(super) const CREST: f32 = 2.6;

impl Floor {
    /// Height of the dunes, in metres; the camera's ground is about 0 where none of it is `below`.
    pub(super) fn height(&self, x: f32, z: f32) -> f32 {
        let dunes = 0.7 * noise_2d(0.16 * x + self.offset, 0.16 * z) + 0.3 * noise_2d(0.4 * x, 0.4 * z) - 0.5;
        let rise = smooth_step(0.0, 14.0, x * self.slope.signum()) * 14.0 * self.slope.abs();
        (1.1 * dunes + rise).min(CREST) - self.below
    }

    /// Height with ripples and pebbles: too fine to march against, enough to turn the normal.
    fn relief(&self, x: f32, z: f32) -> f32 {
        let bend = 1.8 * noise(vec3(0.7 * x + self.offset, 3.0, 0.7 * z));
        let ripples = 0.012 * (9.0 * (z + 0.35 * x) + 4.0 * bend).sin();
        let grain = 0.006 * noise(vec3(38.0 * x, 5.0, 38.0 * z));
        self.height(x, z)
            + ripples * noise(vec3(0.4 * x, 9.0, 0.4 * z + self.offset)) * 1.6
            + grain
            + 0.05 * pebble(x, z)
    }

    pub(super) fn normal(&self, p: Vec3, distance: f32) -> Vec3 {
        // Wider taps far away: detail below a pixel would only sparkle.
        let tap = 0.004 + 0.002 * distance;
        let along = |dx: f32, dz: f32| self.relief(p.x + dx, p.z + dz) - self.relief(p.x - dx, p.z - dz);
        vec3(-along(tap, 0.0), 2.0 * tap, -along(0.0, tap)).normalised()
    }

    /// Linear reflectance.
    pub(super) fn albedo(&self, p: Vec3) -> Vec3 {
        let patch = rough(vec3(0.8 * p.x + self.offset, 1.0, 0.8 * p.z), 4);
        let [light, dark] = self.ground.bare;
        let bare = mix(light, dark, smooth_step(0.35, 0.7, patch));
        let speckle = 0.80 + 0.40 * noise(vec3(60.0 * p.x, 1.0, 60.0 * p.z));
        let growth = smooth_step(0.60, 0.74, rough(vec3(0.5 * p.x, 7.0 + self.offset, 0.5 * p.z), 4));
        let covered = mix(bare * speckle, self.ground.growth, 0.75 * growth);
        let stone =
            mix(vec3(0.30, 0.28, 0.26), vec3(0.52, 0.42, 0.40), noise(vec3(3.0 * p.x, 2.0, 3.0 * p.z)));
        mix(covered, stone, smooth_step(0.05, 0.25, pebble(p.x, p.z)))
    }
}

/// Height of a pebble, 0 between them, 1 on top.
fn pebble(x: f32, z: f32) -> f32 {
    let strewn = smooth_step(0.50, 0.62, noise(vec3(0.55 * x, 21.0, 0.55 * z)));
    strewn * smooth_step(0.30, 0.05, cells(4.0 * x, 4.0 * z)[0])
}

pub(super) fn mix(a: Vec3, b: Vec3, t: f32) -> Vec3 {
    a + (b - a) * t
}
