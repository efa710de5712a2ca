//! Camera, ray marching and light: what is seen of a place through air.

use super::floor::CREST;
use super::geometry::{Ray, Vec3, smooth_step, vec3};
use super::layout::Place;
use super::noise::{cells, noise};
use super::thing::Thing;
use super::{Kind, Pose, Size};
use crate::image::{Encoding, Linear};

/// Distance of open water, metres: at β = .08 a metre, e^(-βz) is .0003 of the range and no byte shows it.
pub(super) const FAR: f32 = 100.0;
/// Nothing is looked for beyond; towards it the floor fades into the dark.
const HORIZON: f32 = 26.0;
/// Tangent of half the horizontal field of view (70°), unless a pose has another.
pub(super) const HALF_VIEW: f32 = 0.70;
/// Rays a pixel, placed on a turned grid; the first one gives the depth.
const RAYS: [[f32; 2]; 3] = [[0.5, 0.5], [0.17, 0.78], [0.83, 0.22]];
const MAX_STEPS: usize = 160;

/// What one pixel sees.
#[derive(Clone, Copy)]
pub(super) struct Seen {
    /// Encoded colour.
    pub(super) colour: [f32; 3],
    /// Distance along the ray.
    pub(super) distance: f32,
    /// What the ray meets.
    pub(super) kind: Kind,
}

/// All pixels, row by row.
pub(super) fn render(place: &Place, pose: &Pose, size: Size) -> Vec<Seen> {
    let row = |y: usize| (0..size.width).map(move |x| pixel(place, pose, size, x, y));
    #[cfg(feature = "threads")]
    if crate::bands::has_threads() {
        use rayon::prelude::*;
        return (0..size.height).into_par_iter().flat_map_iter(row).collect();
    }
    (0..size.height).flat_map(row).collect()
}

fn pixel(place: &Place, pose: &Pose, size: Size, x: usize, y: usize) -> Seen {
    let mut light = Vec3::default();
    let (mut distance, mut kind) = (FAR, Kind::OpenWater);
    for (i, [dx, dy]) in RAYS.into_iter().enumerate() {
        let ray = camera_ray(place, pose, size, x as f32 + dx, y as f32 + dy);
        let hit = march(place, &ray, HORIZON);
        if let (0, Some(hit)) = (i, &hit) {
            distance = hit.t;
            kind = hit.thing.map_or(Kind::Floor, |thing| place.kind(thing));
        }
        // Where there is nothing, no light comes from it: open water is its backscatter alone.
        light = light + hit.map_or(Vec3::default(), |hit| shade(place, &ray, &hit));
    }
    let light = light * (1.0 / RAYS.len() as f32);
    let colour = [light.x, light.y, light.z].map(|v| Linear::to_encoded(film(v)).clamp(0.0, 1.0));
    Seen { colour, distance, kind }
}

/// Rolls off the highlights instead of cutting them.
fn film(light: f32) -> f32 {
    let light = 1.15 * light;
    if light < 0.6 { light } else { 0.6 + 0.4 * (1.0 - (-(light - 0.6) / 0.4).exp()) }
}

fn camera_ray(place: &Place, pose: &Pose, size: Size, x: f32, y: f32) -> Ray {
    let (width, height) = (size.width as f32, size.height as f32);
    let right = (2.0 * x / width - 1.0) * pose.half_view;
    let up = (1.0 - 2.0 * y / height) * pose.half_view * height / width;
    let (sin, cos) = pose.roll.sin_cos();
    let (right, up) = (right * cos - up * sin, up * cos + right * sin);
    let (sin, cos) = pose.pitch.sin_cos();
    let level = vec3(right, up * cos - sin, up * sin + cos);
    let (sin, cos) = pose.yaw.sin_cos();
    let direction = vec3(level.x * cos + level.z * sin, level.y, level.z * cos - level.x * sin).normalised();
    let [right, up, ahead] = pose.moved;
    let eye = vec3(0.0, place.floor.height(0.0, 0.0) + place.eye, 0.0);
    Ray { origin: eye + vec3(right, up, ahead), direction }
}

struct Hit<'a> {
    t: f32,
    /// None is the floor.
    thing: Option<&'a Thing>,
}

/// The first thing a ray meets before `limit`.
fn march<'a>(place: &'a Place, ray: &Ray, limit: f32) -> Option<Hit<'a>> {
    let crossed = place.things.iter().filter_map(|thing| Some((thing.ball.crossing(ray)?, thing)));
    let near: Vec<([f32; 2], &Thing)> = crossed.collect();
    let mut t = 0.02;
    for _ in 0..MAX_STEPS {
        let p = ray.at(t);
        let mut step = floor_clearance(place, ray, p);
        let mut thing = None;
        for &([enter, leave], candidate) in &near {
            // Outside its ball a body is at least as far as the ball.
            let distance = match t {
                t if t >= leave => continue,
                t if t < enter => enter - t + 0.01,
                _ => candidate.distance(p),
            };
            if distance < step {
                (step, thing) = (distance, (t >= enter).then_some(candidate));
            }
        }
        if step < 0.0006 * t + 0.0004 {
            return Some(Hit { t, thing });
        }
        t += step;
        if t > limit {
            return None;
        }
    }
    None
}

/// A step down the ray that does not cross the floor.
fn floor_clearance(place: &Place, ray: &Ray, p: Vec3) -> f32 {
    if p.y > CREST {
        let sinking = -ray.direction.y;
        return if sinking > 0.0 { (p.y - CREST) / sinking + 0.01 } else { FAR };
    }
    0.7 * (p.y - place.floor.height(p.x, p.z))
}

fn shade(place: &Place, ray: &Ray, hit: &Hit<'_>) -> Vec3 {
    let p = ray.at(hit.t);
    let (normal, albedo) = match hit.thing {
        Some(thing) => {
            let normal = gradient(thing, p, 0.002 + 0.0008 * hit.t);
            (normal, thing.albedo(p, normal))
        }
        None => (place.floor.normal(p, hit.t), place.floor.albedo(p)),
    };
    let facing = normal.dot(place.sun).max(0.0);
    let lit = if facing > 0.0 { sunlight(place, p + normal * 0.02) } else { 0.0 };
    let sun = vec3(1.0, 0.96, 0.88) * (1.30 * facing * lit * caustics(place, p));
    let sky = vec3(0.58, 0.64, 0.72) * (0.28 + 0.26 * normal.y);
    let bounce = vec3(0.50, 0.42, 0.32) * (0.16 * (0.5 - 0.5 * normal.y));
    let light = sun + (sky + bounce) * (0.75 * openness(place, p, normal));
    let colour = vec3(albedo.x * light.x, albedo.y * light.y, albedo.z * light.z);
    colour * (1.0 - smooth_step(0.7 * HORIZON, HORIZON, hit.t))
}

/// Direction in which the distance to a body grows.
fn gradient(thing: &Thing, p: Vec3, tap: f32) -> Vec3 {
    let corners = [vec3(1.0, -1.0, -1.0), vec3(-1.0, -1.0, 1.0), vec3(-1.0, 1.0, -1.0), vec3(1.0, 1.0, 1.0)];
    let sum = corners
        .into_iter()
        .fold(Vec3::default(), |sum, corner| sum + corner * thing.distance(p + corner * tap));
    sum.normalised()
}

/// 0 in full shadow, 1 in the sun; soft where something only just hides it.
fn sunlight(place: &Place, p: Vec3) -> f32 {
    let ray = Ray { origin: p, direction: place.sun };
    let mut light = 1.0_f32;
    for thing in &place.things {
        let Some([enter, leave]) = thing.ball.crossing(&ray) else { continue };
        let mut t = enter.max(0.01);
        for _ in 0..24 {
            let distance = thing.distance(ray.at(t));
            light = light.min(14.0 * distance / t.max(0.2));
            t += distance.max(0.02);
            if light <= 0.0 || t > leave {
                break;
            }
        }
        if light <= 0.0 {
            return 0.0;
        }
    }
    light
}

/// Share of the sky that reaches a place: corners and clefts are darker.
fn openness(place: &Place, p: Vec3, normal: Vec3) -> f32 {
    let hidden = [0.06_f32, 0.18, 0.42].into_iter().map(|reach| {
        let q = p + normal * reach;
        let floor = (q.y - place.floor.height(q.x, q.z)).max(0.0);
        let free = place
            .things
            .iter()
            .filter(|thing| (thing.ball.centre - q).length() < thing.ball.radius + reach)
            .map(|thing| thing.distance(q).max(0.0))
            .fold(floor.min(reach), f32::min);
        (reach - free) / reach
    });
    let total: f32 = hidden.zip([0.40, 0.35, 0.25]).map(|(hidden, weight)| weight * hidden).sum();
    (1.0 - 0.95 * total).max(0.04)
}

/// The net of light that waves throw on the floor, mean about 1; fainter where it is far.
fn caustics(place: &Place, p: Vec3) -> f32 {
    let along = p - place.sun * (p.y / place.sun.y);
    let (x, z) = (along.x + place.floor.offset, along.z);
    let warp = |shift: f32| 0.55 * (noise(vec3(1.9 * x, shift, 1.9 * z)) - 0.5);
    let net = |scale: f32| {
        let [first, second] = cells(scale * (x + warp(2.0)), scale * (z + warp(8.0)));
        (-9.0 * (second - first)).exp()
    };
    0.72 + 1.35 * net(1.9) * (0.45 + net(1.1))
}
