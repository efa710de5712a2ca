//! Forms a truth scene in one of the synthetic waters, takes the water out again and says how near that comes.
//!
//! cargo run --release -p aquafuse --example restore_scene -- [SEED]

use aquafuse::depth::{self, DepthMap};
use aquafuse::formation::{RestoreOptions, restore};
use aquafuse::image::{Image, ImageError};
use aquafuse::metrics::psnr;
use aquafuse::truth::{OPEN_WATER, Scene, Size, waters};
use aquafuse::waterbody::{self, Waterbody};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let seed = std::env::args().nth(1).map_or(Ok(1), |seed| seed.parse())?;
    let scene = Scene::new(seed, Size { width: 320, height: 240 });
    println!("PSNR against the clear scene, dB; open water, which has none, left out");
    println!("| water | seen | restored, all given | z given | z from colour |");
    println!("|---|---|---|---|---|");
    for named in waters() {
        // What a camera would have stored.
        let seen: Image<u8> = scene.seen_through(&named.water).convert();
        let from_colour = depth::estimate(&seen);
        let water = |z: &DepthMap| -> Result<Waterbody, ImageError> {
            Ok(waterbody::estimate(&seen, z, &Default::default())?.water)
        };
        let score = |z: &DepthMap, water: &Waterbody| -> Result<f64, ImageError> {
            let clear: Image<u8> = restore(&seen, z, water, &RestoreOptions::default())?.convert();
            of_things(&scene, &clear)
        };
        println!(
            "| {} | {:.1} | {:.1} | {:.1} | {:.1} |",
            named.name,
            of_things(&scene, &seen)?,
            score(&scene.depth, &named.water)?,
            score(&scene.depth, &water(&scene.depth)?)?,
            score(&from_colour, &water(&from_colour)?)?,
        );
    }
    Ok(())
}

/// PSNR over the pixels at which there is something to see.
fn of_things(scene: &Scene, picture: &Image<u8>) -> Result<f64, ImageError> {
    let distances = scene.depth.distances();
    let things = |image: &Image<u8>| {
        let kept = image.pixels().iter().zip(&distances).filter(|&(_, &z)| z < OPEN_WATER);
        let samples: Vec<u8> = kept.flat_map(|(pixel, _)| *pixel).collect();
        Image::<u8>::from_raw(samples.len() / 3, 1, samples)
    };
    psnr(&things(&scene.clear.convert())?, &things(picture)?)
}
