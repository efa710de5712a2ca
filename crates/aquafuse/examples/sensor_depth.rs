//! Fuses with depth as a sensor gives it, millimetres with holes, and with depth from colour, and compares both with
//! the truth: the same place with the veiling light exchanged.
//!
//! cargo run --release -p aquafuse --example sensor_depth -- [SEED]

use aquafuse::depth::{self, DepthMap, Supplied, SuppliedKind};
use aquafuse::fusion::{Bounded, Model, Options, fuse};
use aquafuse::image::{Image, ImageError};
use aquafuse::metrics::psnr;
use aquafuse::truth::{OPEN_WATER, Scene, Size, waters};
use aquafuse::waterbody::{self, Waterbody};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let seed = std::env::args().nth(1).map_or(Ok(1), |seed| seed.parse::<u64>())?;
    let size = Size { width: 320, height: 240 };
    let [blue, green, ..] = waters();
    let (place, other_place) = (Scene::new(seed, size), Scene::new(seed + 1, size));
    let content: Image<u8> = place.seen_through(&blue.water).convert();
    let reference: Image<u8> = other_place.seen_through(&green.water).convert();
    let exchanged = Waterbody { veiling_light: green.water.veiling_light, ..blue.water };
    let truth: Image<u8> = place.seen_through(&exchanged).convert();

    let by_colour =
        fused([&content, &reference], [&depth::estimate(&content), &depth::estimate(&reference)])?;
    let by_sensor =
        fused([&content, &reference], [&sensed(&place, &content)?, &sensed(&other_place, &reference)?])?;
    println!("PSNR against the truth, dB");
    println!("content as it is    {:.2}", psnr(&truth, &content)?);
    println!("depth from colour   {:.2}", psnr(&truth, &by_colour)?);
    println!("depth from a sensor {:.2}", psnr(&truth, &by_sensor)?);
    Ok(())
}

/// What a sensor would measure: millimetres, 0 where nothing comes back.
fn sensed(place: &Scene, image: &Image<u8>) -> Result<DepthMap, Box<dyn std::error::Error>> {
    let measured = |z: f32| if z < OPEN_WATER { (1000.0 * z).round() } else { 0.0 };
    let values = place.depth.distances().into_iter().map(measured).collect();
    let (width, height) = image.size();
    let map = Supplied::new(width, height, values, SuppliedKind::Millimetres)?;
    let found = map.seen_with(image, Default::default())?;
    println!("{:.0} % of a map were holes", 100.0 * found.report.invalid_share());
    Ok(found.depth)
}

/// The content in the reference's water by the model `physical`, bounded by what the estimates are worth.
fn fused(images: [&Image<u8>; 2], depths: [&DepthMap; 2]) -> Result<Image<u8>, ImageError> {
    let (own, share) = waterbody::estimate_with_share(images[0], depths[0], &Default::default())?;
    let other = waterbody::estimate(images[1], depths[1], &Default::default())?;
    let bounded = Bounded::new(&own, &other, Options::for_model(Model::Physical));
    Ok(fuse(images[0], depths[0], bounded.waters().with_share(&share), &bounded.options)?.image)
}
