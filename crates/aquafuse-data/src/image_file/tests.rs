mod hostile;
mod jpeg_in_tiff;

use super::*;
use crate::files::{remove_stale_parts, write_atomically};
use ::image::{ExtendedColorType, ImageEncoder, codecs::jpeg::JpegEncoder, codecs::png::PngEncoder};
use aquafuse::image::Sample;

/// An EXIF block of one tag: orientation `value`.
fn exif(value: u8) -> Vec<u8> {
    let mut block = b"II*\0\x08\0\0\0\x01\0".to_vec();
    block.extend([0x12, 0x01, 3, 0, 1, 0, 0, 0, value, 0, 0, 0, 0, 0, 0, 0]);
    block
}

/// An ICC profile as far as anyone here looks: the kind of its colours at byte 16.
fn profile(kind: &[u8; 4]) -> Vec<u8> {
    [&[0; 16][..], kind, &[0; 180]].concat()
}

/// A PNG of `width` x `height` whose chunks are given; lengths and check sums are right.
fn png(width: u32, height: u32, colour_type: u8, chunks: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
    let header = [&width.to_be_bytes()[..], &height.to_be_bytes(), &[8, colour_type, 0, 0, 0]].concat();
    let mut file = b"\x89PNG\r\n\x1a\n".to_vec();
    for (name, body) in [&[(b"IHDR", &header[..])], chunks, &[(b"IEND", &[])]].concat() {
        let checked = [&name[..], body].concat();
        file.extend((body.len() as u32).to_be_bytes());
        file.extend(&checked);
        file.extend(crc32(&checked).to_be_bytes());
    }
    file
}

fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| (crc >> 1) ^ (0xEDB8_8320 * (crc & 1)))
    })
}

fn gradient() -> Image<u8> {
    Image::from_raw(16, 8, (0..=127).flat_map(|v| [v, 2 * v, 255 - v]).collect()).unwrap()
}

#[test]
fn a_png_comes_back_as_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    ImageFile::new(gradient()).write(&path, &WriteOptions::default()).unwrap();
    assert_eq!(ImageFile::read(&path).unwrap().pixels, gradient().into());
}

#[test]
fn a_jpeg_keeps_its_colour_at_every_pixel() {
    // Chroma is not subsampled: columns of two alternating hues stay two hues.
    let samples = (0..16 * 16).flat_map(|i| if i % 2 == 0 { [200, 40, 40] } else { [40, 40, 200] }).collect();
    let image = Image::<u8>::from_raw(16, 16, samples).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.jpg");
    ImageFile::new(image.clone()).write(&path, &WriteOptions { quality: 100, ..Default::default() }).unwrap();
    let back = ImageFile::read(&path).unwrap().pixels.into_bytes();
    let worst = back.as_raw().iter().zip(image.as_raw()).map(|(a, b)| a.abs_diff(*b)).max();
    assert!(worst < Some(8), "off by {worst:?}");
}

/// An image of each kind of samples, with opacity or without.
fn kinds() -> Vec<ImageFile> {
    let words: Vec<u16> = (0..16 * 8 * 3).map(|i| (i * 170) as u16).collect();
    let words = Layers { image: Image::from_raw(16, 8, words).unwrap(), alpha: None };
    let alpha = Some((0..128).map(|i| i * 511).collect());
    let floats = words.convert::<f32>();
    [
        gradient().into(),
        Pixels::Bytes(Layers { image: gradient(), alpha: Some((0..128).collect()) }),
        Pixels::Words(Layers { alpha: alpha.clone(), ..words.clone() }),
        Pixels::Words(words),
        Pixels::Floats(Layers {
            alpha: alpha.map(|a: Vec<u16>| a.into_iter().map(Sample::to_unit).collect()),
            ..floats.clone()
        }),
        Pixels::Floats(floats),
    ]
    .map(ImageFile::new)
    .into()
}

#[test]
fn every_kind_of_pixels_comes_back_from_tiff_and_the_others_hold_what_they_can() {
    let folder = tempfile::tempdir().unwrap();
    let options = WriteOptions { overwrite: true, ..Default::default() };
    let back = |image_file: &ImageFile, name: &str| {
        image_file.write(&folder.path().join(name), &options).unwrap();
        ImageFile::read(&folder.path().join(name)).unwrap().pixels
    };
    for image_file in kinds() {
        assert_eq!(back(&image_file, "a.tif"), image_file.pixels);
        let (bytes, words) = match &image_file.pixels {
            Pixels::Bytes(layers) => (layers.clone(), None),
            Pixels::Words(layers) => (layers.convert(), Some(layers.clone())),
            Pixels::Floats(layers) => (layers.convert(), Some(layers.convert())),
        };
        assert_eq!(back(&image_file, "a.webp"), Pixels::Bytes(bytes.clone()));
        assert_eq!(back(&image_file, "a.png"), words.map_or(Pixels::Bytes(bytes), Pixels::Words));
    }
}

#[test]
fn transparency_is_refused_by_jpeg_not_lost() {
    let folder = tempfile::tempdir().unwrap();
    let transparent = &kinds()[1];
    let refused = transparent.write(&folder.path().join("a.jpg"), &WriteOptions::default()).unwrap_err();
    assert!(refused.to_string().contains("write .png"), "{refused}");
}

#[test]
fn profile_exif_and_resolution_travel_with_the_image() {
    let folder = tempfile::tempdir().unwrap();
    let resolution = |unit, density| Some(Resolution { density: (density, 2.0 * density), unit });
    for (name, resolution) in [
        ("a.png", resolution(ResolutionUnit::Metre, 3000.0)),
        ("a.png", resolution(ResolutionUnit::Unknown, 1.0)),
        ("a.jpg", resolution(ResolutionUnit::Inch, 72.0)),
        ("a.jpg", resolution(ResolutionUnit::Centimetre, 30.0)),
        ("a.webp", None),
    ] {
        let metadata = Metadata {
            icc_profile: Some(profile(b"RGB ")),
            exif: Some(exif(6)),
            resolution,
            left_out: Vec::new(),
        };
        let image_file = ImageFile { metadata: metadata.clone(), ..ImageFile::new(gradient()) };
        image_file
            .write(&folder.path().join(name), &WriteOptions { overwrite: true, ..Default::default() })
            .unwrap();
        let back = ImageFile::read(&folder.path().join(name)).unwrap();
        assert_eq!(back.metadata, metadata, "{name}");
        assert_eq!(back.top_edge(), TopEdge::Left);
        assert_eq!(back.pixels.size(), (16, 8), "pixels stay in stored order");
    }
}

#[test]
fn what_a_tiff_says_of_itself_survives_every_format() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let resolution = Some(Resolution { density: (300.0, 150.0), unit: ResolutionUnit::Inch });
    let metadata = Metadata {
        icc_profile: Some(profile(b"RGB ")),
        exif: Some(exif(8)),
        resolution,
        left_out: Vec::new(),
    };
    ImageFile { metadata, ..ImageFile::new(gradient()) }
        .write(&path("0.tif"), &WriteOptions::default())
        .unwrap();
    for (from, to) in [("0.tif", "1.jpg"), ("1.jpg", "2.png"), ("2.png", "3.webp"), ("3.webp", "4.tiff")] {
        ImageFile::read(&path(from)).unwrap().write(&path(to), &WriteOptions::default()).unwrap();
        let metadata = ImageFile::read(&path(to)).unwrap().metadata;
        assert_eq!((metadata.orientation(), metadata.icc_profile), (8, Some(profile(b"RGB "))), "{to}");
    }
    // Resolution is one of a TIFF's own fields, and so of the EXIF it becomes.
    let fields = |name: &str| exif::Exif::read(&std::fs::read(path(name)).unwrap()).unwrap();
    assert_eq!(fields("4.tiff"), fields("0.tif"));
}

#[test]
fn eight_orientations_look_the_same_upright() {
    // As seen: 1 2 3 over 4 5 6. Stored: as each orientation has it.
    let stored: [(usize, [u8; 6]); 8] = [
        (3, [1, 2, 3, 4, 5, 6]),
        (3, [3, 2, 1, 6, 5, 4]),
        (3, [6, 5, 4, 3, 2, 1]),
        (3, [4, 5, 6, 1, 2, 3]),
        (2, [1, 4, 2, 5, 3, 6]),
        (2, [3, 6, 2, 5, 1, 4]),
        (2, [6, 3, 5, 2, 4, 1]),
        (2, [4, 1, 5, 2, 6, 3]),
    ];
    for (orientation, (width, values)) in (1..).zip(stored) {
        let image = Image::from_raw(width, 6 / width, values.iter().flat_map(|&v| [v; 3]).collect()).unwrap();
        let pixels = Pixels::Bytes(Layers { image, alpha: Some(values.to_vec()) });
        let metadata = Metadata { exif: Some(exif(orientation)), ..Metadata::default() };
        let upright = ImageFile { metadata, ..ImageFile::new(pixels) }.upright();
        let Pixels::Bytes(Layers { image, alpha }) = upright.pixels else { panic!("bytes stay bytes") };
        assert_eq!((image.size(), alpha), ((3, 2), Some(vec![1, 2, 3, 4, 5, 6])), "{orientation}");
        assert_eq!(image.pixels()[5], [6; 3]);
        assert_eq!(upright.metadata.orientation(), 1);
    }
}

#[test]
fn a_grey_image_is_read_as_rgb() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("grey.png");
    let file = std::fs::File::create(&path).unwrap();
    let mut encoder = PngEncoder::new(file);
    encoder.set_icc_profile(profile(b"GRAY")).unwrap();
    encoder.write_image(&[10, 20], 2, 1, ExtendedColorType::L8).unwrap();
    let image_file = ImageFile::read(&path).unwrap();
    assert_eq!(image_file.bytes().pixels(), [[10; 3], [20; 3]]);
    assert_eq!(image_file.metadata.icc_profile, None, "a profile for grey is wrong for RGB");
    assert_eq!(image_file.metadata.left_out.len(), 1, "and that is said");
}

#[test]
fn refusals_name_the_file_the_cause_and_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let message = |name: &str| ImageFile::read(&path(name)).unwrap_err().to_string();
    std::fs::write(path("note.txt"), "no image").unwrap();
    std::fs::write(path("empty.png"), "").unwrap();
    let mut cut = Vec::new();
    PngEncoder::new(&mut cut).write_image(&[9; 3 * 64 * 64], 64, 64, ExtendedColorType::Rgb8).unwrap();
    std::fs::write(path("cut.png"), &cut[..cut.len() - 40]).unwrap();
    std::fs::create_dir(path("folder.png")).unwrap();
    // Known to panic in png 0.18: a palette of two and a third colours.
    std::fs::write(path("palette.png"), png(8, 8, 3, &[(b"PLTE", &[0; 7]), (b"IDAT", &[0; 9])])).unwrap();
    std::fs::write(path("bomb.png"), png(20000, 20000, 2, &[(b"IDAT", &[0; 9])])).unwrap();
    for (name, cause, remedy) in [
        ("missing.png", "No such file", "Check the name"),
        ("folder.png", "directory", "Name an image in it"),
        ("palette.png", "cannot decode", "get an intact copy"),
        ("bomb.png", "20000x20000", "scale or split"),
        ("note.txt", "none of PNG, JPEG", "convert it"),
        ("empty.png", "is empty", "Get a complete copy"),
        ("cut.png", "truncated", "Get a complete copy"),
    ] {
        let said = message(name);
        assert!(said.contains(name) && said.contains(cause) && said.contains(remedy), "{said}");
    }
}

#[test]
fn a_file_that_exists_is_not_replaced_unasked() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    std::fs::write(&path, "mine").unwrap();
    let image_file = ImageFile::new(gradient());
    let refused = image_file.write(&path, &WriteOptions::default()).unwrap_err();
    assert!(matches!(refused, FileError::Exists { .. }), "{refused}");
    assert_eq!(std::fs::read(&path).unwrap(), b"mine");
    image_file.write(&path, &WriteOptions { overwrite: true, ..Default::default() }).unwrap();
    assert!(ImageFile::read(&path).is_ok());
}

#[test]
fn a_failing_write_leaves_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    let failed = write_atomically(&path, false, |out| {
        out.write_all(b"half").unwrap();
        Err("the disk is full")
    });
    assert!(failed.unwrap_err().to_string().contains("the disk is full"));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[cfg(unix)]
#[test]
fn a_written_file_is_as_open_as_the_umask_allows() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let (plain, ours) = (folder.path().join("plain"), folder.path().join("a.png"));
    std::fs::write(&plain, "x").unwrap();
    ImageFile::new(gradient()).write(&ours, &WriteOptions::default()).unwrap();
    let mode = |path: &Path| path.metadata().unwrap().permissions().mode();
    assert_eq!(mode(&ours), mode(&plain));
}

#[test]
fn exif_too_large_for_a_jpeg_is_refused_not_cut() {
    let folder = tempfile::tempdir().unwrap();
    let metadata = Metadata { exif: Some(vec![0; 65528]), ..Metadata::default() };
    let image_file = ImageFile { metadata, ..ImageFile::new(gradient()) };
    let refused = image_file.write(&folder.path().join("a.jpg"), &WriteOptions::default()).unwrap_err();
    assert!(refused.to_string().contains("write .png"), "{refused}");
    assert!(image_file.write(&folder.path().join("a.png"), &WriteOptions::default()).is_ok());
}

#[test]
fn an_unknown_extension_is_refused_before_anything_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gif");
    let refused = ImageFile::new(gradient()).write(&path, &WriteOptions::default()).unwrap_err();
    assert!(refused.to_string().contains(WRITTEN));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn a_jpeg_under_another_name_is_known_by_its_content() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("really_a_jpeg.png");
    let file = std::fs::File::create(&path).unwrap();
    JpegEncoder::new(file).write_image(&[128; 3 * 64], 8, 8, ExtendedColorType::Rgb8).unwrap();
    assert_eq!(ImageFile::read(&path).unwrap().pixels.size(), (8, 8));
}

/// Every format we make, of one image.
fn files() -> Vec<(&'static str, Vec<u8>)> {
    let folder = tempfile::tempdir().unwrap();
    let samples: Vec<u8> = (0..48 * 40 * 3).map(|i| (i * i / 7) as u8).collect();
    let image = Image::<u8>::from_raw(48, 40, samples.clone()).unwrap();
    let mut files: Vec<_> = ["a.png", "a.jpg", "a.webp", "a.tif"]
        .into_iter()
        .map(|name| {
            let path = folder.path().join(name);
            ImageFile::new(image.clone()).write(&path, &WriteOptions::default()).unwrap();
            (name, std::fs::read(path).unwrap())
        })
        .collect();
    let buffer = ::image::RgbImage::from_raw(48, 40, samples).unwrap();
    for (name, format) in [("a.bmp", ::image::ImageFormat::Bmp), ("a.gif", ::image::ImageFormat::Gif)] {
        let mut file = std::io::Cursor::new(Vec::new());
        buffer.write_to(&mut file, format).unwrap();
        files.push((name, file.into_inner()));
    }
    files
}

#[test]
fn no_file_cut_anywhere_is_taken_for_whole() {
    let folder = tempfile::tempdir().unwrap();
    for (name, whole) in files() {
        let path = folder.path().join(name);
        let read = |bytes: &[u8]| {
            std::fs::write(&path, bytes).unwrap();
            ImageFile::read(&path)
        };
        assert!(read(&whole).is_ok(), "{name}");
        for cut in (1..whole.len()).step_by(whole.len() / 97 + 1).chain(whole.len() - 8..whole.len()) {
            let refused = read(&whole[..cut]);
            assert!(refused.is_err(), "{name} cut after {cut} of {} bytes", whole.len());
        }
    }
}

#[test]
fn what_is_left_of_an_image_is_taken_on_request_and_the_output_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let lenient = ReadOptions { lenient: true, ..Default::default() };
    for (name, whole) in files().into_iter().filter(|(name, _)| *name != "a.tif") {
        let path = folder.path().join(name);
        std::fs::write(&path, &whole[..whole.len() * 3 / 4]).unwrap();
        let Ok(image_file) = ImageFile::open(&path, &lenient).unwrap().decode() else {
            assert!(matches!(name, "a.webp" | "a.bmp" | "a.gif"), "{name} decodes as far as it goes");
            continue;
        };
        let damage = image_file.damage.clone().unwrap();
        for output in ["out.png", "out.jpg", "out.webp", "out.tif"] {
            let output = folder.path().join(output);
            image_file.write(&output, &WriteOptions { overwrite: true, ..Default::default() }).unwrap();
            let bytes = std::fs::read(&output).unwrap();
            let told = format!("made by aquafuse from a damaged file: {damage}");
            assert!(bytes.windows(told.len()).any(|window| window == told.as_bytes()), "{name}");
        }
    }
}

#[test]
fn what_is_too_large_is_refused_from_the_header() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("large.png");
    let header_only = png(30_000, 30_000, 2, &[]);
    std::fs::write(&path, header_only).unwrap();
    let message = |options: ReadOptions| ImageFile::open(&path, &options).unwrap_err().to_string();
    assert!(message(ReadOptions::default()).contains("--max-pixels"));
    let many = ReadOptions { max_pixels: u64::MAX, ..Default::default() };
    assert!(message(many).contains("more than 64 a byte"));
    let pixels = ReadOptions { max_pixels_per_byte: u64::MAX, ..many };
    assert!(message(pixels).contains("--max-memory"));
    let all = ReadOptions { max_memory: u64::MAX, ..pixels };
    assert!(ImageFile::open(&path, &all).unwrap().memory() > 30_000 * 30_000 * 6);
}

#[test]
fn a_file_beside_images_has_a_quarter_of_memory_at_most_and_may_be_empty() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("labels.txt");
    let file = std::fs::File::create(&path).unwrap();
    let options = ReadOptions { max_memory: 4_000, ..ReadOptions::default() };
    assert_eq!(read_beside(&path, &options).unwrap(), b"");
    file.set_len(1_000).unwrap();
    assert_eq!(read_beside(&path, &options).unwrap(), [0; 1_000]);
    file.set_len(1_001).unwrap();
    let said = read_beside(&path, &options).unwrap_err().to_string();
    assert!(said.contains("labels.txt: it has 1001 bytes; an annotation file or list may have 1000, a quarter of --max-memory"), "{said}");
}

#[test]
fn the_parts_of_dead_processes_are_removed_and_those_in_work_stay() {
    let folder = tempfile::tempdir().unwrap();
    let left = folder.path().join(".aquafuse-dead.part");
    std::fs::write(&left, "half").unwrap();
    let path = folder.path().join("a.txt");
    let written = write_atomically(&path, false, |out| {
        assert_eq!(remove_stale_parts(folder.path()), 1);
        out.write_all(b"whole")
    });
    written.unwrap();
    assert!(!left.exists());
    assert_eq!(std::fs::read(&path).unwrap(), b"whole");
}

#[test]
fn floats_that_are_no_encoded_values_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for value in [1.5, -0.1, f32::NAN, f32::INFINITY] {
        let path = folder.path().join("a.tif");
        let mut file = std::io::Cursor::new(Vec::new());
        let mut encoder = ::tiff::encoder::TiffEncoder::new(&mut file).unwrap();
        encoder.write_image::<::tiff::encoder::colortype::RGB32Float>(1, 1, &[0.5, value, 0.5]).unwrap();
        std::fs::write(&path, file.into_inner()).unwrap();
        let refused = ImageFile::read(&path).unwrap_err().to_string();
        assert!(refused.contains("Scale it to 0 to 1"), "{refused}");
    }
}

#[test]
fn what_does_not_travel_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    let data = [0x78, 1, 1, 4, 0, 0xfb, 0xff, 0, 1, 2, 3, 0, 0x0e, 0, 7];
    std::fs::write(&path, png(1, 1, 2, &[(b"tEXt", b"Comment\0reef"), (b"IDAT", &data)])).unwrap();
    assert_eq!(ImageFile::read(&path).unwrap().metadata.left_out, ["its text chunks"]);
    let mut jpeg = Vec::new();
    JpegEncoder::new(&mut jpeg).write_image(&[128; 3 * 64], 8, 8, ExtendedColorType::Rgb8).unwrap();
    let xmp = b"\xff\xe1\0\x25http://ns.adobe.com/xap/1.0/\0<x/>  ";
    jpeg.splice(2..2, xmp.iter().copied());
    let read = ImageFile::from_bytes("a.jpg".as_ref(), &jpeg, &ReadOptions::default()).unwrap();
    assert_eq!(read.metadata.left_out, ["its XMP"]);
}
