//! Chance that can be repeated: numbers from a seed, and textures without memory.

use super::geometry::{Vec3, vec3};
use crate::random::{GOLDEN, split_mix};

/// SplitMix64: good enough to lay out a sea floor, and the same on every machine.
pub(super) struct Random(u64);

impl Random {
    pub(super) fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(GOLDEN) ^ 0x5DEE_CE66)
    }

    /// With this state, as it is.
    pub(super) fn of_state(state: u64) -> Self {
        Self(state)
    }

    fn next(&mut self) -> u64 {
        split_mix(&mut self.0)
    }

    /// Evenly in `[low, high)`.
    pub(super) fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * (self.next() >> 40) as f32 / (1_u32 << 24) as f32
    }

    /// Evenly among 0 .. `count`.
    pub(super) fn below(&mut self, count: usize) -> usize {
        (self.next() % count as u64) as usize
    }

    /// Nearly normal, deviation 1: twelve even numbers.
    pub(super) fn normal(&mut self) -> f32 {
        (0..12).map(|_| self.between(0.0, 1.0)).sum::<f32>() - 6.0
    }

    /// One of the choices.
    pub(super) fn pick<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len())]
    }
}

fn mix(a: f32, b: f32, t: f32) -> f32 {
    a + (b - a) * t
}

fn hash(x: i32, y: i32, z: i32) -> f32 {
    let mut h = (x as u32).wrapping_mul(0x8DA6_B343)
        ^ (y as u32).wrapping_mul(0xD816_3841)
        ^ (z as u32).wrapping_mul(0xCB1A_B31F);
    h = (h ^ (h >> 15)).wrapping_mul(0x2C1B_3C6D);
    h = (h ^ (h >> 12)).wrapping_mul(0x297A_2D39);
    (h ^ (h >> 15)) as f32 / u32::MAX as f32
}

/// The whole number below, and the smoothed rest. (`floor` is a call where the processor has no SSE 4.1.)
fn cell(v: f32) -> (i32, f32) {
    let towards_zero = v as i32;
    let below = towards_zero - i32::from(towards_zero as f32 > v);
    let rest = v - below as f32;
    (below, rest * rest * (3.0 - 2.0 * rest))
}

/// Smooth noise in `[0, 1]` with features of size 1.
pub(super) fn noise(p: Vec3) -> f32 {
    let [(x, u), (y, v), (z, w)] = [p.x, p.y, p.z].map(cell);
    let edge = |dy, dz| mix(hash(x, y + dy, z + dz), hash(x + 1, y + dy, z + dz), u);
    mix(mix(edge(0, 0), edge(1, 0), v), mix(edge(0, 1), edge(1, 1), v), w)
}

/// [`noise`] in a plane, at half the cost.
pub(super) fn noise_2d(x: f32, z: f32) -> f32 {
    let [(i, u), (k, w)] = [x, z].map(cell);
    let edge = |dz| mix(hash(i, 0, k + dz), hash(i + 1, 0, k + dz), u);
    mix(edge(0), edge(1), w)
}

/// Noise with finer and finer detail added, about `[0, 1]`.
pub(super) fn rough(p: Vec3, octaves: u32) -> f32 {
    let (mut sum, mut weight, mut total, mut at) = (0.0, 0.5, 0.0, p);
    for _ in 0..octaves {
        sum += weight * noise(at);
        total += weight;
        weight *= 0.5;
        // Turned a little, so that the grids of the octaves do not line up.
        at = vec3(1.6 * at.x + 1.2 * at.z, 2.0 * at.y + 17.3, 1.6 * at.z - 1.2 * at.x);
    }
    sum / total
}

/// In a plane strewn with one random point a unit cell: the distances to the nearest and second nearest.
pub(super) fn cells(x: f32, z: f32) -> [f32; 2] {
    let [(cell_x, _), (cell_z, _)] = [x, z].map(cell);
    let mut nearest = [9.0_f32; 2];
    for dz in -1..=1 {
        for dx in -1..=1 {
            let (i, k) = (cell_x + dx, cell_z + dz);
            let (px, pz) = (i as f32 + hash(i, 71, k), k as f32 + hash(i, 113, k));
            let distance = ((px - x).powi(2) + (pz - z).powi(2)).sqrt();
            if distance < nearest[0] {
                nearest = [distance, nearest[0]];
            } else if distance < nearest[1] {
                nearest[1] = distance;
            }
        }
    }
    nearest
}
