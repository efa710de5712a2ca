//! Places for a network to learn from, in numbers: what a camera somewhere in a place sees through air, and how far everything is.
//!
//! cargo run --release -p aquafuse --example places_to_learn -- places FIRST COUNT WIDTH HEIGHT > FILE
//! cargo run --release -p aquafuse --example places_to_learn -- waters FIRST COUNT > FILE
//!
//! `places` writes for each place the clear image (encoded bytes, red, green and blue of each pixel in turn, row by row), then
//! z of each pixel in centimetres (16 bits, little-endian; 65535 is open water). Where the camera is, how it is held, how wide it
//! sees and what kind of place it is are drawn by the place's number alone, so that a file may be made in parts.
//!
//! `waters` writes for each water of [`sea`] what linear light needs: B∞, β_B and β_D per metre, and what a white diffuser shows:
//! twelve floats (32 bits, little-endian).

use std::error::Error;
use std::io::Write;

use aquafuse::image::Linear;
use aquafuse::random::split_mix;
use aquafuse::truth::{Gaze, HALF_VIEW, OPEN_WATER, Pose, Scene, Site, Size, View};
use aquafuse::waterbody::presets::{White, sea};

/// Places whose seeds nothing else uses.
const FIRST_SEED: u64 = 9_000_000;
/// Nothing may be nearer to the camera than this for more than this share of the image; else it is inside a thing.
const NEAREST: f32 = 0.25;
const INSIDE: f32 = 0.2;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let mut out = std::io::stdout().lock();
    match arguments[..] {
        ["places", first, count, width, height] => {
            let size = Size { width: width.parse()?, height: height.parse()? };
            let first: u64 = first.parse()?;
            for number in first..first + count.parse::<u64>()? {
                out.write_all(&place(number, size))?;
            }
        }
        ["waters", first, count] => {
            let first: u32 = first.parse()?;
            for number in first..first + count.parse::<u32>()? {
                let floats = water(number).into_iter().flat_map(f32::to_le_bytes);
                out.write_all(&floats.collect::<Vec<u8>>())?;
            }
        }
        _ => return Err("usage: places_to_learn places FIRST COUNT WIDTH HEIGHT | waters FIRST COUNT".into()),
    }
    Ok(())
}

/// Numbers by chance.
struct Chance(u64);

impl Chance {
    fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * (split_mix(&mut self.0) >> 40) as f32 / (1_u32 << 24) as f32
    }

    /// Nearly normal, deviation 1.
    fn normal(&mut self) -> f32 {
        (0..12).map(|_| self.between(0.0, 1.0)).sum::<f32>() - 6.0
    }

    fn is(&mut self, likelihood: f32) -> bool {
        self.between(0.0, 1.0) < likelihood
    }
}

/// The record of a place.
fn place(number: u64, size: Size) -> Vec<u8> {
    let mut chance = Chance(FIRST_SEED + (number << 8));
    loop {
        let site = if chance.is(0.6) { Site::Reef } else { Site::Harbour };
        let gaze = if chance.is(0.8) { Gaze::Ahead } else { Gaze::Down };
        let pose = pose(&mut chance);
        let scene = Scene::from(View { site, gaze }, FIRST_SEED + number, &pose, size);
        let distances = scene.depth.distances();
        let near = distances.iter().filter(|&&z| z < NEAREST).count();
        if near as f32 <= INSIDE * distances.len() as f32 {
            let colours = scene.clear.as_raw().iter().map(|value| (255.0 * value).round() as u8);
            let centimetres = distances.iter().flat_map(|&z| {
                let known = if z >= OPEN_WATER { u16::MAX } else { (100.0 * z).clamp(1.0, 65_534.0) as u16 };
                known.to_le_bytes()
            });
            return colours.chain(centimetres).collect();
        }
    }
}

/// Where a camera is, and how it is held: mostly level, now and then tilted, looking up, down or askew.
fn pose(chance: &mut Chance) -> Pose {
    let ahead = if chance.is(0.5) { chance.between(-1.0, 2.0) } else { chance.between(0.0, 9.0) };
    let above = if chance.is(0.6) { chance.between(-0.7, 0.6) } else { chance.between(-0.9, 3.5) };
    let yaw = if chance.is(0.7) { 0.35 * chance.normal() } else { chance.between(-3.2, 3.2) };
    let pitch = match chance.between(0.0, 1.0) {
        kind if kind < 0.6 => 0.15 + 0.15 * chance.normal(),
        kind if kind < 0.85 => chance.between(0.2, 1.57),
        kind if kind < 0.95 => chance.between(-0.5, 0.1),
        _ => chance.between(-0.9, -0.3),
    };
    let roll = match chance.between(0.0, 1.0) {
        kind if kind < 0.7 => 0.06 * chance.normal(),
        kind if kind < 0.9 => 0.35 * chance.normal(),
        _ => chance.between(-3.2, 3.2),
    };
    let half_view = HALF_VIEW * chance.between(0.35_f32.ln(), 1.5_f32.ln()).exp();
    Pose { moved: [chance.between(-2.5, 2.5), above, ahead], yaw, pitch, roll, half_view }
}

/// B∞, β_B, β_D and white of a water.
fn water(number: u32) -> [f32; 12] {
    let (preset, conditions) = sea(number);
    let derived = preset.derive::<Linear>(&conditions.with_white(White::AtSurface));
    let (water, white) = (derived.water, derived.white);
    // Per metre over the first five metres: the curve hardly bends, and what is learned from it is where water is.
    let attenuation = water.attenuation.map(|curve| curve.optical_depth(5.0) / 5.0);
    let parts = [water.veiling_light.rgb(), water.backscatter_coefficient, attenuation, white];
    std::array::from_fn(|i| parts[i / 3][i % 3])
}
