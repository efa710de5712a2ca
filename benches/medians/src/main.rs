//! Median milliseconds of a 7x7 median of one channel, by crates that have one, on one thread.
//!
//! cargo run --release --manifest-path benches/medians/Cargo.toml -- PICTURE.ppm FRAMES

use std::hint::black_box;
use std::time::Instant;

use image::GrayImage;
use libblur::{BlurImage, BlurImageMut, FastBlurChannels, ThreadingPolicy};

const RADIUS: u32 = 3;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [path, frames] = &arguments[..] else { return Err("give PICTURE.ppm FRAMES".into()) };
    let (plane, frames) = (read_green(path)?, frames.parse()?);
    report("imageproc", frames, || {
        black_box(imageproc::filter::median_filter(&plane, RADIUS, RADIUS));
        Ok(())
    })?;
    let (width, height) = plane.dimensions();
    let source = BlurImage::borrow(plane.as_raw(), width, height, FastBlurChannels::Plane);
    let mut filtered = BlurImageMut::alloc(width, height, FastBlurChannels::Plane);
    report("libblur", frames, || {
        Ok(libblur::median_blur(&source, &mut filtered, RADIUS, ThreadingPolicy::Single)?)
    })
}

fn report(
    name: &str,
    frames: usize,
    mut run: impl FnMut() -> Result<(), Box<dyn std::error::Error>>,
) -> Result<(), Box<dyn std::error::Error>> {
    run()?;
    let mut spent = Vec::with_capacity(frames);
    for _ in 0..frames {
        let began = Instant::now();
        run()?;
        spent.push(began.elapsed().as_secs_f64() * 1e3);
    }
    spent.sort_by(f64::total_cmp);
    println!("{name} {:.3}", spent[frames / 2]);
    Ok(())
}

/// The green channel of a binary PPM with a header of one line.
fn read_green(path: &str) -> Result<GrayImage, Box<dyn std::error::Error>> {
    let bytes = std::fs::read(path)?;
    let end = bytes.iter().position(|&byte| byte == b'\n').ok_or("no header")?;
    let header: Vec<&str> = std::str::from_utf8(&bytes[..end])?.split(' ').collect();
    let ["P6", width, height, "255"] = header[..] else { return Err("no PPM of one header line".into()) };
    let green = bytes[end + 1..].chunks_exact(3).map(|pixel| pixel[1]).collect();
    GrayImage::from_raw(width.parse()?, height.parse()?, green).ok_or_else(|| "cut short".into())
}
