//! Small files that ask for much time or memory.

use super::*;

/// A strip of JPEG is unpacked to its own size, whatever the image's is.
#[test]
fn jpeg_within_tiff_is_refused_for_images_and_for_depth() {
    let mut strip = Vec::new();
    JpegEncoder::new(&mut strip).write_image(&[9; 512 * 512], 512, 512, ExtendedColorType::L8).unwrap();
    let fields: [(u16, u32); 8] = [
        (256, 8),
        (257, 8),
        (258, 8),
        (259, 7),
        (262, 1),
        (273, 8 + 2 + 8 * 12 + 4),
        (278, 8),
        (279, strip.len() as u32),
    ];
    let mut file = b"II*\0\x08\0\0\0\x08\0".to_vec();
    for (tag, value) in fields {
        // One number of 32 bits.
        file.extend([&tag.to_le_bytes()[..], &[4, 0, 1, 0, 0, 0], &value.to_le_bytes()].concat());
    }
    file.extend([0; 4]);
    file.extend(strip);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.tiff");
    std::fs::write(&path, file).unwrap();
    let said = ImageFile::read(&path).unwrap_err().to_string();
    assert!(said.contains("a TIFF compressed as JPEG. Save it with LZW"), "{said}");
    let said = crate::depth_file::read(&path, aquafuse::depth::SuppliedKind::Metres).unwrap_err().to_string();
    assert!(said.contains("JPEG compression"), "{said}");
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
