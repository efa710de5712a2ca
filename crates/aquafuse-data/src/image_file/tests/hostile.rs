//! Small files that ask for much time or memory.

use super::jpeg_in_tiff::jpeg_in_tiff;
use super::*;

/// A strip of JPEG has a size of its own, whatever the image's is; compression 6 was never settled.
#[test]
fn a_strip_of_jpeg_of_another_size_is_refused_before_it_is_decoded() {
    let mut strip = Vec::new();
    JpegEncoder::new(&mut strip).write_image(&[9; 512 * 512], 512, 512, ExtendedColorType::L8).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.tiff");
    for (way, cause) in
        [(7, "it has 512x512 pixels instead of 8x8"), (6, "as JPEG in the old way. Save it with LZW")]
    {
        std::fs::write(
            &path,
            jpeg_in_tiff(&[(256, 8), (257, 8), (258, 8), (259, way), (262, 1), (278, 8)], &[&strip], &[]),
        )
        .unwrap();
        let said = ImageFile::read(&path).unwrap_err().to_string();
        assert!(said.contains(cause), "{said}");
        let said =
            crate::depth_file::read(&path, aquafuse::depth::SuppliedKind::Metres).unwrap_err().to_string();
        assert!(said.contains("JPEG compression"), "{said}");
    }
}

/// Pieces may all be the same one of the file, so that a small file makes much work.
#[test]
fn a_tiff_of_too_many_strips_is_refused_for_images_and_for_depth() {
    let file = |rows: u32| {
        let places = 8 + 2 + 9 * 12 + 4;
        let lengths = places + 4 * rows;
        let fields: [(u16, u32, u32); 9] = [
            (256, 1, 1),
            (257, 1, rows),
            (258, 1, 8),
            (259, 1, 1),
            (262, 1, 1),
            (273, rows, places),
            (277, 1, 1),
            (278, 1, 1),
            (279, rows, lengths),
        ];
        let mut file = b"II*\0\x08\0\0\0\x09\0".to_vec();
        for (tag, count, value) in fields {
            // Numbers of 32 bits.
            let parts = [&tag.to_le_bytes()[..], &[4, 0], &count.to_le_bytes(), &value.to_le_bytes()];
            file.extend(parts.concat());
        }
        file.extend([0; 4]);
        file.extend([places, 1].iter().flat_map(|number| number.to_le_bytes().repeat(rows as usize)));
        file
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.tiff");
    std::fs::write(&path, file(1_000)).unwrap();
    assert_eq!(ImageFile::read(&path).unwrap().pixels.size(), (1, 1_000));
    std::fs::write(&path, file(300_000)).unwrap();
    let said = ImageFile::read(&path).unwrap_err().to_string();
    assert!(said.contains("a TIFF of 300000 strips or tiles (262144 are allowed). Save it"), "{said}");
    let said = crate::depth_file::read(&path, aquafuse::depth::SuppliedKind::Metres).unwrap_err().to_string();
    assert!(said.contains("a TIFF of 300000 strips"), "{said}");
}

/// A frame is decoded as it is, and memory was counted for the screen.
#[test]
fn a_gif_whose_frame_is_larger_than_its_screen_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gif");
    // A screen of 2 x 2, two colours, a frame of 2 x 2 of the first one.
    let mut file = b"GIF89a\x02\0\x02\0\x80\0\0\x10\x20\x30\xff\xff\xff\x2c\0\0\0\0\x02\0\x02\0\0\x02\x03\x04\0\x05\0\x3b".to_vec();
    std::fs::write(&path, &file).unwrap();
    assert_eq!(ImageFile::read(&path).unwrap().pixels.size(), (2, 2));
    file[26] = 0xff;
    std::fs::write(&path, &file).unwrap();
    let said = ImageFile::read(&path).unwrap_err().to_string();
    assert!(said.contains("its first frame has more pixels than its screen"), "{said}");
}

#[cfg(unix)]
#[test]
fn a_pipe_is_refused_and_not_waited_for() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe.png");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    assert!(matches!(ImageFile::read(&pipe), Err(FileError::NoFile { .. })));
}

/// A TIFF of one grey strip of 8x8 with these further fields, as tag and value.
fn tiff_with(more: &[(u16, u32)]) -> Vec<u8> {
    let mut fields = vec![(256, 8), (257, 8), (258, 8), (259, 1), (262, 1), (277, 1), (278, 8), (279, 64)];
    fields.extend(more);
    let begin = 8 + 2 + (fields.len() as u32 + 1) * 12 + 4;
    fields.push((273, begin));
    fields.sort_unstable();
    let mut file = [&b"II*\0\x08\0\0\0"[..], &(fields.len() as u16).to_le_bytes()].concat();
    for (tag, value) in fields {
        file.extend([&tag.to_le_bytes()[..], &[4, 0, 1, 0, 0, 0], &value.to_le_bytes()].concat());
    }
    [&file[..], &[0; 4], &[90; 64]].concat()
}

#[test]
fn a_preview_is_not_read_in_the_place_of_its_image() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.tif");
    let read = |file: Vec<u8>| {
        std::fs::write(&path, file).unwrap();
        ImageFile::read(&path).map_err(|error| error.to_string())
    };
    assert!(read(tiff_with(&[])).is_ok() && read(tiff_with(&[(254, 2)])).is_ok());
    for field in [(254, 1), (50706, 0x0401)] {
        let said = read(tiff_with(&[field])).unwrap_err();
        assert!(said.contains("a camera's raw file") && said.contains("Develop it first"), "{said}");
    }
    let mut of_sensor = tiff_with(&[]);
    let at = of_sensor.windows(2).position(|tag| tag == 262_u16.to_le_bytes()).unwrap();
    of_sensor[at + 8..at + 12].copy_from_slice(&32803_u32.to_le_bytes());
    let said = read(of_sensor).unwrap_err();
    assert!(said.contains("a TIFF in a form that is not read") && said.contains("raw file first"), "{said}");
}

#[test]
fn a_coding_of_jpeg_that_is_not_read_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.jpg");
    for (frame, name) in [(0xc3, "a lossless JPEG"), (0xc9, "arithmetic coding"), (0xf7, "a JPEG-LS")] {
        let file =
            [&[0xff, 0xd8, 0xff, frame, 0, 11, 8, 0, 8, 0, 8, 1, 1, 0x11, 0][..], &[0xff, 0xd9]].concat();
        std::fs::write(&path, file).unwrap();
        let said = ImageFile::read(&path).unwrap_err().to_string();
        assert!(said.contains(name) && said.contains("Save it as an ordinary JPEG"), "{said}");
    }
}
