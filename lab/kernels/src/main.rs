//! Does one step of the pipeline so many times, and nothing else: for counting instructions.
//!
//! cargo run --release --package kernels -- KERNEL IMAGE.ppm TIMES
//!
//! What loading the image takes is told apart by counting twice, for different numbers of TIMES. It has no
//! vectors and no threads, and with `--features simd` vectors alone.

use std::hint::black_box;

use aquafuse::fusion::{Gain, Model, Options, Waters, fuse_into};
use aquafuse::image::{Encoded, Image};
use aquafuse::smooth::bilateral;
use aquafuse::stream::Stream;
use aquafuse::{Fuser, depth, waterbody};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [kernel, image, times] = &arguments[..] else {
        return Err("give KERNEL IMAGE.ppm TIMES".into());
    };
    let image = read_ppm(image)?;
    let times = 0..times.parse::<usize>()?;
    // Done once by each kernel, so that all start alike.
    let z = depth::estimate(&image);
    let estimate = waterbody::estimate(&image, &z, &Default::default())?;
    match kernel.as_str() {
        "depth" => times.for_each(|_| drop(black_box(depth::estimate(&image)))),
        "waterbody" => {
            for _ in times {
                black_box(waterbody::estimate::<Encoded>(&image, &z, &Default::default())?);
            }
        }
        "fusion" => {
            let waters = Waters::new(&estimate.water, &estimate.water);
            // Twice one's own veil: something to add.
            let options = Options::for_model(Model::Aquafuse).with_gain(Gain::new(2.0)?);
            let mut fused = image.clone();
            for _ in times {
                fuse_into(&image, &z, waters, &options, &mut fused)?;
            }
            black_box(fused);
        }
        "bilateral" => times.for_each(|_| drop(black_box(bilateral(&image)))),
        "frame" => {
            let mut stream = Stream::new(Fuser::from(estimate).model(Model::Aquafuse));
            let mut fused = image.clone();
            stream.fuse_into(&image, &mut fused)?;
            for _ in times {
                stream.fuse_into(&image, &mut fused)?;
            }
            black_box(fused);
        }
        _ => return Err("KERNEL is depth, waterbody, fusion, bilateral or frame".into()),
    }
    Ok(())
}

/// Reads a binary PPM with a header of one line, as `lab` writes it.
fn read_ppm(path: &str) -> Result<Image<u8>, Box<dyn std::error::Error>> {
    let bytes = std::fs::read(path)?;
    let end = bytes.iter().position(|&byte| byte == b'\n').ok_or("no header")?;
    let header = std::str::from_utf8(&bytes[..end])?;
    let ["P6", width, height, "255"] = header.split(' ').collect::<Vec<_>>()[..] else {
        return Err(format!("{path} is no PPM of one header line").into());
    };
    Ok(Image::from_raw(width.parse()?, height.parse()?, bytes[end + 1..].to_vec())?)
}
