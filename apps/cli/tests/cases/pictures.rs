//! Photographs as cameras and other programs write them.

use std::fs::File;

use aquafuse::image::Image;
use aquafuse_data::image_file::{ImageFile, WriteOptions};
use tiff::encoder::{TiffEncoder, colortype};
use tiff::tags::Tag;

use super::run::{Run, scene};

fn with_water() -> Run {
    let run = Run::new();
    scene(&run.path("green.png"), 9, "green");
    run
}

fn bytes(run: &Run, name: &str) -> Image<u8> {
    ImageFile::read(&run.path(name)).unwrap().bytes().into_owned()
}

#[test]
fn folder_passed_over() {
    let run = with_water();
    std::fs::create_dir(run.path("dive")).unwrap();
    scene(&run.path("dive/a.jpg"), 1, "blue");
    for name in ["b.jfif", "c.MPO"] {
        std::fs::copy(run.path("dive/a.jpg"), run.path("dive").join(name)).unwrap();
    }
    for name in ["d.avif", "IMG_0001.HEIC", "DSC0001.ARW"] {
        std::fs::write(run.path("dive").join(name), b"\0\0\0\x18ftyp").unwrap();
    }
    let said = run.ok(&["fuse", "dive", "green.png", "-o", "out"]);
    assert!(said.stdout.contains("3 images written"), "{}", said.stdout);
    for words in ["3 (", "DSC0001.ARW", "IMG_0001.HEIC", "d.avif", "develop raw files"] {
        assert!(said.stderr.contains(words), "{}", said.stderr);
    }
}

#[test]
fn picture_raw_dng() {
    let run = with_water();
    let mut encoder = TiffEncoder::new(File::create(run.path("G001.DNG")).unwrap()).unwrap();
    let mut preview = encoder.new_image::<colortype::RGB8>(40, 30).unwrap();
    preview.encoder().write_tag(Tag::NewSubfileType, 1_u32).unwrap();
    preview.write_data(&[90; 40 * 30 * 3]).unwrap();
    encoder.write_image::<colortype::Gray16>(160, 120, &[900; 160 * 120]).unwrap();
    let said = run.fails(1, &["fuse", "G001.DNG", "green.png", "-o", "out.png"]).stderr;
    assert!(
        said.contains("G001.DNG: it is a camera's raw file") && said.contains("Develop it first"),
        "{said}"
    );
    assert!(!run.path("out.png").exists());
}

#[test]
fn picture_refused() {
    let run = with_water();
    let frame = b"\xff\xd8\xff\xc3\x00\x0b\x08\x00\x10\x00\x10\x01\x01\x11\x00\xff\xd9";
    std::fs::write(run.path("lossless.jpg"), frame).unwrap();
    let mut encoder = TiffEncoder::new(File::create(run.path("plain.tif")).unwrap()).unwrap();
    encoder.write_image::<colortype::RGB8>(8, 6, &[90; 8 * 6 * 3]).unwrap();
    // The tag of compression: one short, which is 1 where there is none.
    let plain = run.bytes("plain.tif");
    let at = plain.windows(10).position(|part| part == [3, 1, 3, 0, 1, 0, 0, 0, 1, 0]).unwrap();
    for (name, compression, said) in [
        ("zstd.tif", 50_000_u16, "compression method ZSTD is unsupported"),
        // Strips of JPEG are read, but these are none.
        ("jpeg.tif", 7, "its strip or tile 0 is no JPEG"),
        (
            "old_jpeg.tif",
            6,
            "a TIFF compressed as JPEG in the old way. Save it with LZW, deflate or no compression, or as a JPEG",
        ),
    ] {
        let mut other = plain.clone();
        other[at + 8..at + 10].copy_from_slice(&compression.to_le_bytes());
        std::fs::write(run.path(name), other).unwrap();
        let stderr = run.fails(1, &["fuse", name, "green.png", "-o", "out.png"]).stderr;
        assert!(stderr.contains(name) && stderr.contains(said), "{stderr}");
    }
    let stderr = run.fails(1, &["fuse", "lossless.jpg", "green.png", "-o", "out.png"]).stderr;
    assert!(stderr.contains("lossless.jpg: it is a lossless JPEG. Save it as"), "{stderr}");
}

/// A scene with rows above and below it.
fn with_bars(run: &Run, name: &str, rows: usize, row: impl Fn(usize, usize) -> [u8; 3]) {
    let inner = bytes(run, "bare.png");
    let (width, height) = inner.size();
    let bar = |first: usize| {
        (0..rows * width).flat_map(|at| row(at % width, first + at / width)).collect::<Vec<u8>>()
    };
    let pixels = [bar(0), inner.as_raw().to_vec(), bar(rows + height)].concat();
    let image = Image::from_raw(width, height + 2 * rows, pixels).unwrap();
    ImageFile::new(image).write(&run.path(name), &WriteOptions::default()).unwrap();
}

/// The rows of an image from `first`, so many.
fn rows(image: &Image<u8>, first: usize, count: usize) -> &[u8] {
    let row = 3 * image.size().0;
    &image.as_raw()[first * row..(first + count) * row]
}

#[test]
fn letterbox16() {
    let run = with_water();
    scene(&run.path("bare.png"), 3, "blue");
    with_bars(&run, "boxed.png", 12, |_, _| [16; 3]);
    for (content, output) in [("bare.png", "bare_out.png"), ("boxed.png", "boxed_out.png")] {
        run.ok(&["fuse", content, "green.png", "-o", output, "--model", "physical"]);
    }
    let (bare, boxed) = (bytes(&run, "bare_out.png"), bytes(&run, "boxed_out.png"));
    assert_ne!(bare, bytes(&run, "bare.png"));
    assert_eq!(rows(&boxed, 12, 64), bare.as_raw());
    assert!([0, 76].iter().all(|first| rows(&boxed, *first, 12).iter().all(|value| *value == 16)));
}

#[test]
fn hud_bar() {
    let run = with_water();
    scene(&run.path("bare.png"), 3, "blue");
    // Letters in the upper bar.
    let text = |x: usize, y: usize| if (3..9).contains(&y) && x % 7 < 2 { [230; 3] } else { [0; 3] };
    with_bars(&run, "hud.png", 12, text);
    run.ok(&["fuse", "hud.png", "green.png", "-o", "out.png", "--model", "physical"]);
    let (before, after) = (bytes(&run, "hud.png"), bytes(&run, "out.png"));
    assert_eq!(rows(&after, 0, 12), rows(&before, 0, 12));
    assert_ne!(rows(&after, 12, 64), rows(&before, 12, 64));
}

#[test]
fn restore_red() {
    let run = with_water();
    // Teal water over a floor that is nearly grey.
    let pixel = |at: usize| {
        let (x, y) = (at % 96, at / 96);
        let texture = ((x * 7 + y * 13) % 11) as u8;
        let nearness = ((y.max(30) - 30) / 2) as u8;
        match y < 30 {
            true => [20, 120 + texture / 2, 125 + texture / 2],
            false => [60 + nearness + texture, 128 + texture, 120 + texture - nearness / 3],
        }
    };
    let image = Image::from_raw(96, 64, (0..96 * 64).flat_map(pixel).collect()).unwrap();
    ImageFile::new(image).write(&run.path("teal.png"), &WriteOptions::default()).unwrap();
    run.ok(&["restore", "teal.png", "-o", "out.png"]);
    let restored = bytes(&run, "out.png");
    let leads =
        restored.as_raw().chunks(3).filter(|pixel| pixel[0] > pixel[1].max(pixel[2]).saturating_add(4));
    assert!(leads.count() * 100 < 96 * 64, "red leads");
}

#[test]
fn depth_grey_rgb() {
    let run = with_water();
    scene(&run.path("pic.png"), 3, "blue");
    let depth = (0..96 * 64).flat_map(|at| [40 + (at / 96) as u8 * 2; 3]).collect();
    let depth = ImageFile::new(Image::from_raw(96, 64, depth).unwrap());
    depth.write(&run.path("depth.png"), &WriteOptions::default()).unwrap();
    let given = ["--depth", "depth.png", "--depth-kind", "inverse"];
    run.ok(&[&["fuse", "pic.png", "green.png", "-o", "out.png"][..], &given].concat());
}
