//! Writes a truth scene as PPM images: clear, and through each of the synthetic waters.
//!
//! cargo run --release -p aquafuse --example scene -- SEED WIDTH HEIGHT DIR

use std::path::PathBuf;

use aquafuse::image::Image;
use aquafuse::truth::{Scene, Size, waters};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [seed, width, height, folder] = &arguments[..] else {
        return Err("give SEED WIDTH HEIGHT DIR".into());
    };
    let scene = Scene::new(seed.parse()?, Size { width: width.parse()?, height: height.parse()? });
    let folder = PathBuf::from(folder);
    write(&folder.join("air.ppm"), &scene.clear.convert())?;
    for named in waters() {
        let seen = scene.seen_through(&named.water).convert();
        write(&folder.join(named.name).with_extension("ppm"), &seen)?;
    }
    Ok(())
}

fn write(path: &std::path::Path, image: &Image<u8>) -> std::io::Result<()> {
    let mut bytes = format!("P6 {} {} 255\n", image.width(), image.height()).into_bytes();
    bytes.extend_from_slice(image.as_raw());
    std::fs::write(path, bytes)
}
