//! Median milliseconds of a frame, for comparison with the same algorithm elsewhere.
//!
//! cargo run --release -p aquafuse --example time_frames -- CONTENT.ppm REFERENCE.ppm FRAMES
//!
//! On as many threads as `RAYON_NUM_THREADS` says. Memory is that of the frame before, as in a video.
//!
//! `cached`: the reference's water is known; the content's depth and water are estimated for every frame.
//! `estimated`: both pictures are estimated for every frame.
//! `restored`: the content is estimated and its water taken out, within its bounds.

use std::time::Instant;

use aquafuse::formation::{BoundedRestoration, RestoreOptions, restore_mut};
use aquafuse::image::{Encoded, Image, SizeError};
use aquafuse::stream::{Options, Stream};
use aquafuse::{depth, waterbody};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [content, reference, frames] = &arguments[..] else {
        return Err("give CONTENT.ppm REFERENCE.ppm FRAMES".into());
    };
    let (content, reference) = (read_ppm(content)?, read_ppm(reference)?);
    let frames: usize = frames.parse()?;
    let water = waterbody::estimate(&reference, &depth::estimate(&reference), &Default::default())?;
    let mut stream = Stream::new(water, Options::default());
    let mut fused = content.clone();
    report("cached", frames, || stream.fuse_into(&content, &mut fused).map(drop))?;
    report("estimated", frames, || {
        let water = stream.estimate(&reference);
        stream.refer_to(water);
        stream.fuse_into(&content, &mut fused).map(drop)
    })?;
    report("restored", frames, || restored(&content))?;
    Ok(())
}

fn restored(content: &Image<u8>) -> Result<(), SizeError> {
    let z = depth::estimate(content);
    let found = waterbody::estimate::<Encoded>(content, &z, &Default::default())?;
    let bounded = BoundedRestoration::new(content, &z, &found, &RestoreOptions::default())?;
    let mut clear = content.clone();
    restore_mut(&mut clear, &z, &bounded.water, &bounded.options)?;
    std::hint::black_box(clear);
    Ok(())
}

fn report(
    name: &str,
    frames: usize,
    mut run: impl FnMut() -> Result<(), SizeError>,
) -> Result<(), SizeError> {
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
