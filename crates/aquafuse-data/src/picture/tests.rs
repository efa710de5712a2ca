use super::*;
use ::image::{ExtendedColorType, ImageEncoder, codecs::jpeg::JpegEncoder, codecs::png::PngEncoder};

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
    Picture::new(gradient()).write(&path, &WriteOptions::default()).unwrap();
    assert_eq!(Picture::read(&path).unwrap().image, gradient());
}

#[test]
fn a_jpeg_keeps_its_colour_at_every_pixel() {
    // Chroma is not subsampled: columns of two alternating hues stay two hues.
    let samples = (0..16 * 16).flat_map(|i| if i % 2 == 0 { [200, 40, 40] } else { [40, 40, 200] }).collect();
    let image = Image::<u8>::from_raw(16, 16, samples).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.jpg");
    Picture::new(image.clone()).write(&path, &WriteOptions { quality: 100, ..Default::default() }).unwrap();
    let back = Picture::read(&path).unwrap().image;
    let worst = back.as_raw().iter().zip(image.as_raw()).map(|(a, b)| a.abs_diff(*b)).max();
    assert!(worst < Some(8), "off by {worst:?}");
}

#[test]
fn profile_and_exif_travel_with_the_picture() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.png", "a.jpg"] {
        let path = folder.path().join(name);
        let metadata = Metadata { icc_profile: Some(profile(b"RGB ")), exif: Some(exif(6)), orientation: 6 };
        let picture = Picture { image: gradient(), metadata: metadata.clone() };
        picture.write(&path, &WriteOptions::default()).unwrap();
        let back = Picture::read(&path).unwrap();
        assert_eq!(back.metadata, metadata, "{name}");
        assert_eq!(back.top_edge(), TopEdge::Left);
        assert_eq!(back.image.size(), (16, 8), "pixels stay in stored order");
    }
}

#[test]
fn a_grey_picture_is_read_as_rgb() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("grey.png");
    let file = std::fs::File::create(&path).unwrap();
    let mut encoder = PngEncoder::new(file);
    encoder.set_icc_profile(profile(b"GRAY")).unwrap();
    encoder.write_image(&[10, 20], 2, 1, ExtendedColorType::L8).unwrap();
    let picture = Picture::read(&path).unwrap();
    assert_eq!(picture.image.pixels(), [[10; 3], [20; 3]]);
    assert_eq!(picture.metadata.icc_profile, None, "a profile for grey is wrong for RGB");
}

#[test]
fn refusals_name_the_file_the_cause_and_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let message = |name: &str| Picture::read(&path(name)).unwrap_err().to_string();
    std::fs::write(path("note.txt"), "no picture").unwrap();
    std::fs::write(path("empty.png"), "").unwrap();
    let transparent = std::fs::File::create(path("alpha.png")).unwrap();
    PngEncoder::new(transparent).write_image(&[0; 4], 1, 1, ExtendedColorType::Rgba8).unwrap();
    let mut cut = Vec::new();
    PngEncoder::new(&mut cut).write_image(&[9; 3 * 64 * 64], 64, 64, ExtendedColorType::Rgb8).unwrap();
    std::fs::write(path("cut.png"), &cut[..cut.len() - 40]).unwrap();
    std::fs::create_dir(path("folder.png")).unwrap();
    // Known to panic in png 0.18: a palette of two and a third colours.
    std::fs::write(path("palette.png"), png(8, 8, 3, &[(b"PLTE", &[0; 7]), (b"IDAT", &[0; 9])])).unwrap();
    std::fs::write(path("bomb.png"), png(20000, 20000, 2, &[(b"IDAT", &[0; 9])])).unwrap();
    for (name, cause, remedy) in [
        ("missing.png", "No such file", "Check the name"),
        ("folder.png", "directory", "Name a picture in it"),
        ("palette.png", "cannot decode", "get a whole copy"),
        ("bomb.png", "512 MiB", "Scale it down"),
        ("note.txt", "neither PNG nor JPEG", "convert it"),
        ("empty.png", "is empty", "Get a whole copy"),
        ("alpha.png", "transparency", "Flatten"),
        ("cut.png", "cannot decode", "get a whole copy"),
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
    let picture = Picture::new(gradient());
    let refused = picture.write(&path, &WriteOptions::default()).unwrap_err();
    assert!(matches!(refused, FileError::Exists { .. }), "{refused}");
    assert_eq!(std::fs::read(&path).unwrap(), b"mine");
    picture.write(&path, &WriteOptions { overwrite: true, ..Default::default() }).unwrap();
    assert!(Picture::read(&path).is_ok());
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
    Picture::new(gradient()).write(&ours, &WriteOptions::default()).unwrap();
    let mode = |path: &Path| path.metadata().unwrap().permissions().mode();
    assert_eq!(mode(&ours), mode(&plain));
}

#[test]
fn exif_too_large_for_a_jpeg_is_refused_not_cut() {
    let folder = tempfile::tempdir().unwrap();
    let metadata = Metadata { exif: Some(vec![0; 65528]), ..Metadata::default() };
    let picture = Picture { image: gradient(), metadata };
    let refused = picture.write(&folder.path().join("a.jpg"), &WriteOptions::default()).unwrap_err();
    assert!(refused.to_string().contains("write .png"), "{refused}");
    assert!(picture.write(&folder.path().join("a.png"), &WriteOptions::default()).is_ok());
}

#[test]
fn an_unknown_extension_is_refused_before_anything_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gif");
    let refused = Picture::new(gradient()).write(&path, &WriteOptions::default()).unwrap_err();
    assert!(refused.to_string().contains(".png, .jpg or .jpeg"));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn a_jpeg_under_another_name_is_known_by_its_content() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("really_a_jpeg.png");
    let file = std::fs::File::create(&path).unwrap();
    JpegEncoder::new(file).write_image(&[128; 3 * 64], 8, 8, ExtendedColorType::Rgb8).unwrap();
    assert_eq!(Picture::read(&path).unwrap().image.size(), (8, 8));
}
