//! Image files against Pillow, OpenCV and tifffile: they read ours, we read theirs, and what a camera wrote beside
//! the pixels survives.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

use aquafuse::image::Sample;
use aquafuse_data::image_file::{ImageFile, Layers, Pixels, WriteOptions};

const SCRIPT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/independent_images.py");
const WRITTEN: [&str; 4] = ["png", "jpg", "webp", "tif"];

fn python() -> Option<OsString> {
    let python = std::env::var_os("AQUAFUSE_PYTHON");
    if python.is_none() {
        println!("skipped: AQUAFUSE_PYTHON names no Python with Pillow; `cargo xtask test` sets one up");
    }
    python
}

fn run(python: &OsString, what: &str, folder: &Path) {
    let ended = Command::new(python).args([SCRIPT, what]).arg(folder).output().unwrap();
    assert!(ended.status.success(), "{}", String::from_utf8_lossy(&ended.stderr));
}

/// The numbers of an NPY file, and how many bytes each has; its header is a line of text.
fn npy(path: &Path) -> (usize, Vec<u8>) {
    let file = std::fs::read(path).unwrap();
    let end = 10 + usize::from(u16::from_le_bytes([file[8], file[9]]));
    let header = String::from_utf8_lossy(&file[10..end]).into_owned();
    let bytes = if header.contains("f4") { 4 } else { 1 + usize::from(header.contains("u2")) };
    (bytes, file[end..].to_vec())
}

/// Colour and opacity side by side, in the bytes of an NPY file.
fn interleaved<T: Sample>(layers: &Layers<T>, bytes: impl Fn(T) -> Vec<u8>) -> Vec<u8> {
    let pixels = layers.image.pixels().iter().enumerate();
    let values = pixels.flat_map(|(i, pixel)| {
        let opacity = layers.alpha.as_ref().map(|alpha| alpha[i]);
        pixel.iter().copied().chain(opacity)
    });
    values.flat_map(bytes).collect()
}

fn write_npy(path: &Path, image_file: &ImageFile) {
    let (width, height) = image_file.pixels.size();
    let header = format!("{{'descr': '|u1', 'fortran_order': False, 'shape': ({height}, {width}, 3), }}");
    let padded = format!("{header:<117}\n");
    let file = [b"\x93NUMPY\x01\0v\0", padded.as_bytes(), image_file.bytes().as_raw()].concat();
    std::fs::write(path, file).unwrap();
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|path| path.extension().is_none_or(|extension| extension != "npy"));
    files.sort();
    files
}

#[test]
fn we_read_what_others_write() {
    let Some(python) = python() else { return };
    let folder = tempfile::tempdir().unwrap();
    run(&python, "write", folder.path());
    let mut count = 0;
    for path in files(folder.path()) {
        let name = path.file_name().unwrap().to_str().unwrap();
        let (size, expected) = npy(&folder.path().join(format!("{name}.npy")));
        let image_file = ImageFile::read(&path).unwrap();
        let (found_size, found) = match &image_file.pixels {
            Pixels::Bytes(layers) => (1, interleaved(layers, |value| vec![value])),
            Pixels::Words(layers) => (2, interleaved(layers, |value| value.to_le_bytes().to_vec())),
            Pixels::Floats(layers) => (4, interleaved(layers, |value| value.to_le_bytes().to_vec())),
        };
        assert_eq!((found_size, found.len()), (size, expected.len()), "{name}");
        // Decoders of lossy formats may round, upsample and convert CMYK each in their way.
        let allowed = match name {
            "cmyk.jpg" => 6,
            "lossy.webp" | "sampling1.jpg" | "sampling2.jpg" | "progressive.jpg" | "restarts.jpg" => 12,
            _ if name.ends_with("jpg") => 3,
            _ => 0,
        };
        let worst = found.iter().zip(&expected).map(|(a, b)| a.abs_diff(*b)).max().unwrap();
        assert!(worst <= allowed, "{name}: {worst} bytes apart");
        count += 1;
    }
    assert_eq!(count, 39);
}

#[test]
fn what_a_camera_wrote_survives_from_every_format_into_every_other() {
    let Some(python) = python() else { return };
    let folder = tempfile::tempdir().unwrap();
    run(&python, "write", folder.path());
    for from in WRITTEN {
        let ours = tempfile::tempdir().unwrap();
        let image_file = ImageFile::read(&folder.path().join(format!("carried.{from}"))).unwrap();
        assert!(image_file.metadata.left_out.is_empty());
        write_npy(&ours.path().join("ours.npy"), &image_file);
        for to in WRITTEN {
            let path = ours.path().join(format!("ours_from_{from}.{to}"));
            image_file.write(&path, &WriteOptions { quality: 100, ..Default::default() }).unwrap();
        }
        run(&python, "check", ours.path());
    }
}

#[test]
fn eight_orientations_look_the_same_in_a_viewer_as_stored_and_upright() {
    let Some(python) = python() else { return };
    let folder = tempfile::tempdir().unwrap();
    let samples = (0..24 * 16 * 3).map(|i| (i * 7 % 251) as u8).collect::<Vec<_>>();
    // Smooth, for JPEG: a ramp across and another down.
    let smooth = |i: usize| [(i % 24 * 10) as u8, (i / 24 * 15) as u8, samples[0]];
    let image =
        aquafuse::image::Image::<u8>::from_raw(24, 16, (0..24 * 16).flat_map(smooth).collect()).unwrap();
    let seen = ImageFile::new(image);
    write_npy(&folder.path().join("upright.npy"), &seen);
    for orientation in 1..=8_u8 {
        // What undoes it: turned so, it is stored as the orientation says.
        let undone = [1, 2, 3, 4, 5, 8, 7, 6][usize::from(orientation) - 1];
        let mut stored = ImageFile::new(seen.bytes().into_owned());
        stored.pixels = stored.pixels.turned(undone);
        let exif = [&b"II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0"[..], &[orientation], &[0; 7]].concat();
        stored.metadata.exif = Some(exif);
        for extension in WRITTEN {
            let path = folder.path().join(format!("{orientation}.{extension}"));
            stored.write(&path, &WriteOptions::default()).unwrap();
            assert_eq!(ImageFile::read(&path).unwrap().upright().pixels.size(), (24, 16));
        }
    }
    run(&python, "orientations", folder.path());
}
