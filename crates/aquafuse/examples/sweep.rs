//! Fuses one image at several angles θ and says how much it changes: the paper's figure of incidence, in numbers.
//!
//! cargo run --release -p aquafuse --example sweep -- [SEED]

use aquafuse::fusion::{Bounded, Incidence, Model, Options, fuse};
use aquafuse::image::Image;
use aquafuse::metrics::{psnr, ssim};
use aquafuse::truth::{Scene, Size, waters};
use aquafuse::{depth, waterbody};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let seed = std::env::args().nth(1).map_or(Ok(1), |seed| seed.parse::<u64>())?;
    let size = Size { width: 320, height: 240 };
    let [blue, green, ..] = waters();
    let content: Image<u8> = Scene::new(seed, size).seen_through(&blue.water).convert();
    let reference: Image<u8> = Scene::new(seed + 1, size).seen_through(&green.water).convert();

    let (z1, z2) = (depth::estimate(&content), depth::estimate(&reference));
    let (own, share) = waterbody::estimate_with_share(&content, &z1, &Default::default())?;
    let other = waterbody::estimate(&reference, &z2, &Default::default())?;

    println!("| model | θ | mean shift of R, G, B in steps of 255 | PSNR, dB | SSIM |");
    println!("|---|---|---|---|---|");
    for model in [Model::Aquafuse, Model::Physical] {
        for degrees in [0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 90.0] {
            let incidence = Incidence::from_degrees(degrees)?;
            let options = Options::for_model(model).with_incidence(incidence);
            let bounded = Bounded::new(&own, &other, options);
            let fused = fuse(&content, &z1, bounded.waters().with_share(&share), &bounded.options)?.image;
            let [r, g, b] = mean_shift(&content, &fused);
            println!(
                "| `{}` | {degrees}° | {r:.1}, {g:.1}, {b:.1} | {:.2} | {:.3} |",
                model.name(),
                psnr(&content, &fused)?,
                ssim(&content, &fused)?.ok_or("too small for SSIM")?,
            );
        }
    }
    Ok(())
}

/// What was added to each channel on the mean.
fn mean_shift(before: &Image<u8>, after: &Image<u8>) -> [f64; 3] {
    let pixels = before.pixels().len() as f64;
    let pairs = || before.pixels().iter().zip(after.pixels());
    std::array::from_fn(|c| pairs().map(|(a, b)| f64::from(b[c]) - f64::from(a[c])).sum::<f64>() / pixels)
}
