//! Valid files that are not the usual 8-bit RGB: a reader that refuses everything must not look good.

use std::io::Cursor;

use ::tiff::encoder::{Compression, TiffEncoder, colortype};
use anyhow::{Context, Result};
use image::{DynamicImage, ImageFormat, Rgb, RgbImage};

use super::bytes::zlib;
use super::list::Files;
use super::list::Right::Accept;
use super::png_bytes::{
    GREY, PALETTE, RGB, bit_rows, chunk, end, file, idat, index_rows, interlaced, palette, plain, rgb_rows,
    with,
};
use super::seeds::{self, HEIGHT, WIDTH, encoded, metres, npy, pixel};
use super::tiff_bytes::Tiff;
use super::{gif, jpeg_bytes};

const KIND: &str = "unusual but valid";

pub(crate) fn add(files: &mut Files) -> Result<()> {
    by_the_crate(files)?;
    pngs(files);
    jpegs(files);
    tiffs(files)?;
    depths(files)?;
    let (w, h) = (WIDTH as u16, HEIGHT as u16);
    let two = [gif::screen(w, h), gif::frame(w, h, 7), gif::data(1536), gif::frame(8, 8, 7), gif::data(64)];
    files.image(KIND, Accept, "two-frames.gif", [two.concat(), b"\x3b".to_vec()].concat());
    Ok(())
}

/// What the `image` crate writes.
fn by_the_crate(files: &mut Files) -> Result<()> {
    let rgb = DynamicImage::from(seeds::rgb());
    for extension in ["png", "jpg", "webp", "tiff", "bmp", "gif"] {
        files.image(KIND, Accept, &format!("rgb.{extension}"), seeds::image(extension)?);
        let single = DynamicImage::from(RgbImage::from_pixel(1, 1, Rgb(pixel(0, 0))));
        let format = ImageFormat::from_extension(extension).context("no such format")?;
        files.image(KIND, Accept, &format!("single-pixel.{extension}"), encoded(&single, format)?);
    }
    let kinds: [(&str, DynamicImage, &[ImageFormat]); 6] = [
        (
            "grey",
            rgb.to_luma8().into(),
            &[ImageFormat::Png, ImageFormat::Jpeg, ImageFormat::Bmp, ImageFormat::Tiff],
        ),
        ("grey-alpha", rgb.to_luma_alpha8().into(), &[ImageFormat::Png]),
        ("alpha", rgb.to_rgba8().into(), &[ImageFormat::Png, ImageFormat::WebP, ImageFormat::Bmp]),
        ("16-bit", rgb.to_rgb16().into(), &[ImageFormat::Png, ImageFormat::Tiff]),
        ("16-bit-grey", rgb.to_luma16().into(), &[ImageFormat::Png, ImageFormat::Tiff]),
        ("float", rgb.to_rgb32f().into(), &[ImageFormat::Tiff]),
    ];
    for (name, image, formats) in kinds {
        for format in formats {
            let extension = format.extensions_str().first().context("no extension")?;
            files.image(KIND, Accept, &format!("{name}.{extension}"), encoded(&image, *format)?);
        }
    }
    for (width, height) in [(1, 300), (300, 1), (3, 5)] {
        let thin = RgbImage::from_fn(width, height, |x, y| Rgb(pixel(x % 48, y % 32)));
        let bytes = encoded(&thin.into(), ImageFormat::Png)?;
        files.image(KIND, Accept, &format!("thin-{width}x{height}.png"), bytes);
    }
    Ok(())
}

fn pngs(files: &mut Files) {
    let mut add = |name: &str, bytes: Vec<u8>| files.image(KIND, Accept, &format!("{name}.png"), bytes);
    let coloured = |chunks: Vec<u8>| file(&[plain(8, PALETTE), chunks, idat(&index_rows()), end()]);
    add("palette", coloured(palette(16)));
    add("palette-with-transparency", coloured([palette(16), chunk(b"tRNS", &[0, 128, 255])].concat()));
    add("one-bit-grey", file(&[plain(1, GREY), idat(&bit_rows()), end()]));
    add("one-bit-palette", file(&[plain(1, PALETTE), palette(2), idat(&bit_rows()), end()]));
    add("interlaced", interlaced());
    add("one-colour-transparent", with(&[chunk(b"tRNS", &[0, 30, 0, 80, 0, 120])]));
    let pieces: Vec<u8> = zlib(&rgb_rows()).iter().flat_map(|&byte| chunk(b"IDAT", &[byte])).collect();
    add("data-byte-by-byte", file(&[plain(8, RGB), pieces, end()]));
    let empty = || chunk(b"IDAT", &[]);
    add("empty-data-around", file(&[plain(8, RGB), empty(), idat(&rgb_rows()), empty(), end()]));
    add("private-chunk", with(&[chunk(b"aqUa", b"ours alone")]));
}

fn jpegs(files: &mut Files) {
    use jpeg_bytes::{CMYK, COLOUR, GREY, HALVED, Scan, codes, frame, scan_head, segment, steps};
    let mut add = |name: &str, bytes: Vec<u8>| files.image(KIND, Accept, &format!("{name}.jpg"), bytes);
    for (name, components) in [("grey-by-hand", GREY), ("colour", COLOUR), ("halved", HALVED), ("cmyk", CMYK)]
    {
        add(name, jpeg_bytes::baseline(components));
    }
    let restarts = Scan { components: COLOUR, units: 24, restart: 2, block_ends: true }.bytes();
    let interval = segment(0xdd, &[0, 2]);
    let head = [steps(), codes(), interval, frame(0xc0, 48, 32, COLOUR), scan_head(3, 0, 63), restarts];
    add("restart-marks", jpeg_bytes::file(&head));
    add("progressive", jpeg_bytes::progressive(6));
    add("bytes-after-the-end", [jpeg_bytes::baseline(COLOUR), vec![0; 5000]].concat());
    let many = segment(0xe1, &[0; 65_000]).repeat(40);
    add("two-megabytes-of-metadata", jpeg_bytes::file(&[many, jpeg_bytes::baseline(COLOUR)[2..].to_vec()]));
}

fn tiffs(files: &mut Files) -> Result<()> {
    let mut add = |name: &str, bytes: Vec<u8>| files.image(KIND, Accept, &format!("{name}.tiff"), bytes);
    add("grey-by-hand", Tiff::grey().bytes());
    add("big-endian", Tiff::grey().big_endian().bytes());
    for (name, compression) in [
        ("lzw", Compression::Lzw),
        ("deflate", Compression::Deflate(Default::default())),
        ("runs", Compression::Packbits),
    ] {
        let mut bytes = Cursor::new(Vec::new());
        let mut encoder = TiffEncoder::new(&mut bytes)?.with_compression(compression);
        encoder.write_image::<colortype::RGB8>(WIDTH, HEIGHT, &seeds::rgb())?;
        add(name, bytes.into_inner());
    }
    Ok(())
}

fn depths(files: &mut Files) -> Result<()> {
    let mut add = |name: &str, bytes: Vec<u8>| files.depth(KIND, Accept, name, bytes);
    for extension in ["png", "tiff", "exr", "npy", "pfm"] {
        add(&format!("plain.{extension}"), seeds::depth(extension)?);
    }
    let z = metres();
    let whole = |z: &[f32]| z.iter().map(|&z| z as u8).collect::<Vec<u8>>();
    let big: Vec<u8> = z.iter().flat_map(|z| z.to_be_bytes()).collect();
    let double: Vec<u8> = z.iter().flat_map(|&z| f64::from(z).to_le_bytes()).collect();
    let array = |descr: &str, order: &str, data: &[u8]| {
        npy(
            &format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': ({HEIGHT}, {WIDTH}), }}"),
            data,
        )
    };
    add("big-endian.npy", array(">f4", "False", &big));
    add("double.npy", array("<f8", "False", &double));
    add("by-columns.npy", array("<f4", "True", &seeds::little_endian(&z)));
    add("bytes.npy", array("|u1", "False", &whole(&z)));
    add("big-endian.pfm", [format!("Pf\n{WIDTH} {HEIGHT}\n1.0\n").as_bytes(), &big].concat());
    add("by-hand.tiff", Tiff::depth().bytes());
    let grey = image::GrayImage::from_raw(WIDTH, HEIGHT, whole(&z)).context("too few values")?;
    add("bytes.png", encoded(&grey.into(), ImageFormat::Png)?);
    Ok(())
}
