//! Median milliseconds of a frame, for comparison with the same algorithm elsewhere.
//!
//! cargo run --release -p aquafuse --example time_frames -- CONTENT.ppm REFERENCE.ppm FRAMES
//!
//! `cached`: the reference's water is known; the content's depth and water are estimated for every frame.
//! `estimated`: both pictures are estimated for every frame.
//! `restored`: the content is estimated and its water taken out, within its bounds.

use std::time::Instant;

use aquafuse::depth;
use aquafuse::formation::{BoundedRestoration, RestoreOptions, restore_mut};
use aquafuse::fusion::{Options, Waters, fuse};
use aquafuse::image::{Encoded, Image, SizeError};
use aquafuse::waterbody::{EstimateOptions, Waterbody, estimate};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [content, reference, frames] = &arguments[..] else {
        return Err("give CONTENT.ppm REFERENCE.ppm FRAMES".into());
    };
    let (content, reference) = (read_ppm(content)?, read_ppm(reference)?);
    let frames: usize = frames.parse()?;
    let water = water_of(&reference)?;
    report("cached", frames, || one_frame(&content, &water))?;
    report("estimated", frames, || one_frame(&content, &water_of(&reference)?))?;
    report("restored", frames, || restored(&content))?;
    Ok(())
}

fn restored(content: &Image<u8>) -> Result<(), SizeError> {
    let z = depth::estimate(content);
    let found = estimate::<Encoded>(content, &z, &EstimateOptions::default())?;
    let bounded = BoundedRestoration::new(content, &z, &found, &RestoreOptions::default())?;
    let mut clear = content.clone();
    restore_mut(&mut clear, &z, &bounded.water, &bounded.options)?;
    std::hint::black_box(clear);
    Ok(())
}

fn water_of(image: &Image<u8>) -> Result<Waterbody, SizeError> {
    Ok(estimate::<Encoded>(image, &depth::estimate(image), &EstimateOptions::default())?.water)
}

fn one_frame(content: &Image<u8>, reference: &Waterbody) -> Result<(), SizeError> {
    let z = depth::estimate(content);
    let own = estimate::<Encoded>(content, &z, &EstimateOptions::default())?.water;
    let waters = Waters { content: &own, reference };
    std::hint::black_box(fuse(content, &z, waters, &Options::default())?);
    Ok(())
}

fn report(name: &str, frames: usize, run: impl Fn() -> Result<(), SizeError>) -> Result<(), SizeError> {
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

/// Reads a binary PPM with a header of one line, as the `scene` example writes it.
fn read_ppm(path: &str) -> Result<Image<u8>, Box<dyn std::error::Error>> {
    let bytes = std::fs::read(path)?;
    let end = bytes.iter().position(|&byte| byte == b'\n').ok_or("no header")?;
    let header = std::str::from_utf8(&bytes[..end])?;
    let ["P6", width, height, "255"] = header.split(' ').collect::<Vec<_>>()[..] else {
        return Err(format!("{path} is no PPM of one header line").into());
    };
    Ok(Image::from_raw(width.parse()?, height.parse()?, bytes[end + 1..].to_vec())?)
}
