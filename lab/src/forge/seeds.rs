//! Valid files, from gradients, to damage.

use std::io::Cursor;

use ::exr::prelude::{Encoding, Image, SpecificChannels, Vec2, WritableImage};
use ::tiff::encoder::{TiffEncoder, colortype};
use anyhow::{Context, Result, bail};
use image::{DynamicImage, ImageFormat, Rgb, RgbImage};

pub(crate) const WIDTH: u32 = 48;
pub(crate) const HEIGHT: u32 = 32;

/// What making a valid file gives.
pub(crate) type Made = Result<Vec<u8>>;

/// The pixels of every image: gradients with some texture, for flat images tell nothing of their water.
pub(crate) fn pixel(x: u32, y: u32) -> [u8; 3] {
    let texture = (7 * x + 13 * y) % 11;
    [30 + 2 * x + texture, 80 + 3 * y, 120 + x + y + texture].map(|value| value as u8)
}

pub(crate) fn rgb() -> RgbImage {
    RgbImage::from_fn(WIDTH, HEIGHT, |x, y| Rgb(pixel(x, y)))
}

/// An image in the format of that extension.
pub(crate) fn image(extension: &str) -> Made {
    let format = ImageFormat::from_extension(extension).context("no such format")?;
    encoded(&rgb().into(), format)
}

pub(crate) fn encoded(image: &DynamicImage, format: ImageFormat) -> Made {
    let mut file = Cursor::new(Vec::new());
    image.write_to(&mut file, format)?;
    Ok(file.into_inner())
}

/// A larger JPEG with more texture, some kilobytes of scan.
pub(crate) fn photo() -> Made {
    let textured =
        |x: u32, y: u32| pixel(x % 48, y % 32).map(|value| value / 2 + (x * x * 7 + y * y * 3) as u8 % 97);
    encoded(&RgbImage::from_fn(160, 120, |x, y| Rgb(textured(x, y))).into(), ImageFormat::Jpeg)
}

/// The image whose water is taken.
pub(crate) fn water() -> Made {
    let green = RgbImage::from_fn(WIDTH, HEIGHT, |x, y| {
        let texture = (5 * x + 3 * y) % 7;
        Rgb([20 + x / 2 + texture, 150 - 2 * y + texture, 90 + x].map(|value| value as u8))
    });
    encoded(&green.into(), ImageFormat::Png)
}

/// The distances of every depth map: 1 to 10 m, the top far.
pub(crate) fn metres() -> Vec<f32> {
    let row = |y| move |x| 1.0 + (HEIGHT - y) as f32 * 0.25 + x as f32 / 64.0;
    (0..HEIGHT).flat_map(|y| (0..WIDTH).map(row(y))).collect()
}

/// A depth map in the format of that extension.
pub(crate) fn depth(extension: &str) -> Made {
    depth_of(extension, WIDTH, HEIGHT, &metres())
}

/// Any values as a depth map.
pub(crate) fn depth_of(extension: &str, width: u32, height: u32, values: &[f32]) -> Made {
    match extension {
        "png" => {
            let whole = values.iter().map(|&value| value as u16).collect();
            let grey = image::ImageBuffer::from_raw(width, height, whole).context("too few values")?;
            encoded(&DynamicImage::ImageLuma16(grey), ImageFormat::Png)
        }
        "tiff" => {
            let mut file = Cursor::new(Vec::new());
            TiffEncoder::new(&mut file)?.write_image::<colortype::Gray32Float>(width, height, values)?;
            Ok(file.into_inner())
        }
        "exr" => exr_of(width, height, values, Encoding::SMALL_LOSSLESS),
        "npy" => Ok(npy(
            &format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({height}, {width}), }}"),
            &little_endian(values),
        )),
        "pfm" => Ok([format!("Pf\n{width} {height}\n-1.0\n").into_bytes(), little_endian(values)].concat()),
        _ => bail!("no such format"),
    }
}

/// One channel Z.
pub(crate) fn exr_of(width: u32, height: u32, values: &[f32], encoding: Encoding) -> Made {
    let size = (width as usize, height as usize);
    let channels = SpecificChannels::build()
        .with_channel("Z")
        .with_pixel_fn(|at: Vec2<usize>| (values[at.1 * size.0 + at.0],));
    let mut file = Cursor::new(Vec::new());
    Image::from_encoded_channels(size, encoding, channels).write().non_parallel().to_buffered(&mut file)?;
    Ok(file.into_inner())
}

/// An NPY file of version 1 with any header.
pub(crate) fn npy(header: &str, data: &[u8]) -> Vec<u8> {
    let padded = (10 + header.len() + 1).next_multiple_of(64) - 10 - 1;
    let header = format!("{header:padded$}\n");
    let length = (header.len() as u16).to_le_bytes();
    [b"\x93NUMPY\x01\x00", &length[..], header.as_bytes(), data].concat()
}

pub(crate) fn little_endian(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}
