use std::io::Cursor;

use aquafuse::image::Image;
use proptest::prelude::*;

use super::*;

const NAMES: [&str; 6] = ["z.png", "z.tif", "z.tiff", "z.exr", "z.npy", "z.pfm"];

fn map(kind: DepthKind) -> DepthMap {
    let distances = (0..35).map(|i| (i as f32 / 35.0).powi(2)).collect();
    DepthMap::from_distances(7, 5, kind, distances).unwrap()
}

fn file(name: &str, depth: &DepthMap) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    write(&path, depth, &WriteOptions::default()).unwrap();
    std::fs::read(path).unwrap()
}

fn decoded(bytes: &[u8]) -> Result<Raster, Fault> {
    decode(Cursor::new(bytes), Wanted::Any)
}

fn npy(header: &str, values: &[u8]) -> Vec<u8> {
    let length = u16::try_from(header.len()).unwrap().to_le_bytes();
    [&b"\x93NUMPY\x01\x00"[..], &length, header.as_bytes(), values].concat()
}

#[test]
fn floats_come_back_as_they_were_written() {
    let depth = map(DepthKind::Metres);
    for name in &NAMES[1..] {
        let raster = decoded(&file(name, &depth)).unwrap();
        assert_eq!((raster.width, raster.height, raster.full_range), (7, 5, None), "{name}");
        assert_eq!(raster.values, depth.distances(), "{name}");
    }
}

#[test]
fn relative_depth_spans_sixteen_bits_of_png_and_metres_are_millimetres() {
    let relative = DepthMap::from_levels(3, 1, vec![0, 1, 255]).unwrap();
    assert_eq!(decoded(&file("z.png", &relative)).unwrap().values, [0.0, 257.0, 65535.0]);
    let metres = DepthMap::from_distances(3, 1, DepthKind::Metres, vec![0.0, 1.5, 100.0]).unwrap();
    assert_eq!(decoded(&file("z.png", &metres)).unwrap().values, [0.0, 1500.0, 65535.0]);
}

#[test]
fn a_map_in_colours_that_are_all_grey_is_read() {
    let file = |image: image::DynamicImage| {
        let mut bytes = Cursor::new(Vec::new());
        image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
        bytes.into_inner()
    };
    let rgb = image::RgbImage::from_raw(2, 1, vec![7, 7, 7, 9, 9, 9]).unwrap();
    let opaque = image::RgbaImage::from_raw(2, 1, vec![7, 7, 7, 255, 9, 9, 9, 255]).unwrap();
    for grey in [file(rgb.clone().into()), file(opaque.clone().into())] {
        let raster = decoded(&grey).unwrap();
        assert_eq!((raster.values, raster.full_range), (vec![7.0, 9.0], Some(255.0)));
    }
    let words = image::ImageBuffer::<image::Rgb<u16>, _>::from_raw(1, 1, vec![900_u16; 3]).unwrap();
    assert_eq!(decoded(&file(words.into())).unwrap().values, [900.0]);
    let (mut coloured, mut clear) = (rgb, opaque);
    coloured.as_mut()[1] = 8;
    clear.as_mut()[3] = 254;
    for other in [file(coloured.into()), file(clear.into())] {
        assert!(matches!(decoded(&other), Err(Fault::Unsupported(..))));
    }
}

#[test]
fn arrays_of_whole_numbers_and_of_small_floats_are_read() {
    for (descr, bytes, value) in [
        ("<i4", &(-5_i32).to_le_bytes()[..], -5.0),
        (">i2", &1_200_i16.to_be_bytes(), 1_200.0),
        ("<f2", &0x4248_u16.to_le_bytes(), 3.140_625),
    ] {
        let header = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': (1, 1), }}");
        assert_eq!(decoded(&npy(&header, bytes)).unwrap().values, [value], "{descr}");
    }
}

#[test]
fn what_depth_writes_as_relative_is_read_as_relative() {
    let folder = tempfile::tempdir().unwrap();
    let image = Image::from_raw(7, 5, vec![90; 105]).unwrap();
    for name in NAMES {
        let path = folder.path().join(name);
        write(&path, &map(DepthKind::Relative), &WriteOptions::default()).unwrap();
        let read = read(&path, SuppliedKind::Relative).unwrap().seen_with(&image, Default::default());
        for (a, b) in read.unwrap().depth.distances().iter().zip(map(DepthKind::Relative).distances()) {
            assert!((a - b).abs() <= 0.5 / 65535.0, "{name}: {a} {b}");
        }
    }
}

#[test]
fn npy_is_read_in_every_order() {
    let header = |descr: &str, fortran: &str| {
        format!("{{\"shape\": (2, 3), 'fortran_order': {fortran},'descr': '{descr}'}}  \n")
    };
    let rows = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0_f64];
    let by_columns = [1.0, 4.0, 2.0, 5.0, 3.0, 6.0_f64];
    let big: Vec<u8> = rows.iter().flat_map(|value| value.to_be_bytes()).collect();
    let words: Vec<u8> = rows.iter().flat_map(|&value| (value as u16).to_le_bytes()).collect();
    let columns: Vec<u8> = by_columns.iter().flat_map(|&value| (value as f32).to_le_bytes()).collect();
    for (descr, fortran, bytes) in [(">f8", "False", big), ("<u2", "False", words), ("<f4", "True", columns)]
    {
        let raster = decoded(&npy(&header(descr, fortran), &bytes)).unwrap();
        assert_eq!((raster.width, raster.height), (3, 2));
        assert_eq!(raster.values, rows.map(|value| value as f32), "{descr}");
    }
}

#[test]
fn pfm_stands_on_its_head_in_either_byte_order() {
    let body = |order: fn(f32) -> [u8; 4]| [3.0, 4.0, 1.0, 2.0].map(order).concat();
    for (scale, body) in [("-1.0", body(f32::to_le_bytes)), ("1", body(f32::to_be_bytes))] {
        let bytes = [format!("Pf\n2 2\n{scale}\n").as_bytes(), &body[..]].concat();
        assert_eq!(decoded(&bytes).unwrap().values, [1.0, 2.0, 3.0, 4.0]);
    }
}

#[test]
fn sizes_that_take_too_much_memory_are_refused_from_the_header() {
    let header = |shape: &str| format!("{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}, }}\n");
    for bytes in [
        npy(&header("(100000, 100000)"), &[]),
        npy(&header("(18446744073709551615, 18446744073709551615)"), &[]),
        b"Pf\n4294967296 4294967296\n-1\n".to_vec(),
    ] {
        assert!(matches!(decoded(&bytes), Err(Fault::TooLarge(..))));
    }
    // The sizes of a PNG, a TIFF and an EXR of 7x5, made huge where they stand.
    let small = map(DepthKind::Metres);
    let mut png = file("z.png", &small);
    png[16..24].copy_from_slice(&[0x7f, 0xff, 0xff, 0xff, 0x7f, 0xff, 0xff, 0xff]);
    let end = png.len().min(29);
    let sum = crc32(&png[12..end]);
    png[29..33].copy_from_slice(&sum.to_be_bytes());
    let said = decoded(&png).unwrap_err();
    assert!(matches!(said, Fault::TooLarge(..)), "{said:?}");
    let mut tiff = file("z.tiff", &small);
    // Width, height and rows a strip.
    for tag in [[0, 1, 4, 0, 1, 0, 0, 0], [1, 1, 4, 0, 1, 0, 0, 0], [22, 1, 4, 0, 1, 0, 0, 0]] {
        let value = tiff.windows(8).position(|part| part == tag).unwrap() + 8;
        tiff[value..value + 4].copy_from_slice(&[255, 255, 255, 0]);
    }
    let said = decoded(&tiff).unwrap_err();
    assert!(matches!(said, Fault::TooLarge(..)), "{said:?}");
    let mut exr = file("z.exr", &small);
    let window = exr.windows(10).position(|part| part == b"dataWindow").unwrap() + 10 + 1 + 6 + 4;
    exr[window + 8..window + 12].copy_from_slice(&[255, 255, 255, 15]);
    let said = decoded(&exr).unwrap_err();
    assert!(matches!(said, Fault::TooLarge(..)), "{said:?}");
}

/// Found by fuzzing: a block of some bytes asked for 277 terabytes, which ends the process.
#[test]
fn exr_compressed_by_dwa_is_refused() {
    let whole = file("z.exr", &map(DepthKind::Metres));
    let at = whole.windows(23).position(|part| part == b"compression\0compression").unwrap() + 24 + 4;
    for way in [8, 9] {
        let mut exr = whole.clone();
        exr[at] = way;
        let said = decoded(&exr).unwrap_err();
        assert!(
            matches!(&said, Fault::Unsupported(found, _) if found.contains("numbers in dwa")),
            "{said:?}"
        );
    }
}

#[test]
fn headers_of_more_attributes_than_any_program_writes_are_refused_unread() {
    let whole = file("z.exr", &map(DepthKind::Metres));
    let with = |count: usize| {
        let attributes = (0..count).flat_map(|number| {
            [&b"a"[..], format!("{number}\0int\0").as_bytes(), &[4, 0, 0, 0, 1, 0, 0, 0]].concat()
        });
        let attributes: Vec<u8> = attributes.collect();
        // The table of chunks holds places within the file.
        let (head, rest) = whole.split_at(8);
        let end = chunk_table(rest);
        let mut rest = rest.to_vec();
        let place = u64::from_le_bytes(rest[end..end + 8].try_into().unwrap()) + attributes.len() as u64;
        rest[end..end + 8].copy_from_slice(&place.to_le_bytes());
        [head, &attributes, &rest].concat()
    };
    assert_eq!(decoded(&with(100)).unwrap(), decoded(&whole).unwrap());
    let mut hidden = with(20_000);
    let said = decoded(&hidden).unwrap_err();
    assert!(matches!(&said, Fault::Unsupported(found, _) if found.contains("attributes")), "{said:?}");
    // To the decoder the first letter of a text is never its end.
    hidden.splice(8..8, *b"a\0\0k\0\x04\0\0\0four");
    let said = decoded(&hidden).unwrap_err();
    assert!(matches!(&said, Fault::Unsupported(found, _) if found.contains("attributes")), "{said:?}");
}

/// Where the attributes of an EXR end that are followed by its chunks' places.
fn chunk_table(mut rest: &[u8]) -> usize {
    let length = rest.len();
    while rest[0] != 0 {
        for _ in 0..2 {
            rest = &rest[rest.iter().position(|letter| *letter == 0).unwrap() + 1..];
        }
        let size = u32::from_le_bytes(rest[..4].try_into().unwrap()) as usize;
        rest = &rest[4 + size..];
    }
    length - rest.len() + 1
}

#[test]
fn numbers_packed_as_a_fax_are_refused_before_they_are_unpacked() {
    let mut tiff = file("z.tiff", &map(DepthKind::Metres));
    // Compression, one short number: none becomes that of faxes.
    let tag = [3, 1, 3, 0, 1, 0, 0, 0, 1, 0];
    let at = tiff.windows(tag.len()).position(|part| part == tag).unwrap();
    tiff[at + 8] = 4;
    let said = decoded(&tiff).unwrap_err();
    assert!(matches!(&said, Fault::Unsupported(what, _) if what.contains("fax")), "{said:?}");
}

/// The check sum of a PNG chunk.
fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32| if crc & 1 == 1 { (crc >> 1) ^ 0xedb8_8320 } else { crc >> 1 };
    !bytes.iter().fold(!0, |crc, byte| (0..8).fold(crc ^ u32::from(*byte), |crc, _| step(crc)))
}

#[test]
fn what_is_no_plane_of_numbers_is_refused_with_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let header = |descr: &str, shape: &str| {
        format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}\n")
    };
    for (bytes, expected) in [
        (npy(&header("<i8", "(1, 1)"), &[0; 8]), "astype('float32')"),
        (npy(&header("<f4", "(1, 1, 1)"), &[0; 4]), "np.squeeze"),
        (npy("{'descr': ", &[]), "its header is invalid"),
        (b"PF\n1 1\n-1\n".to_vec(), "one channel"),
        (b"Pf\n1 1\n-1\n\0\0".to_vec(), "ends too early"),
        (b"\xff\xd8\xff\xe0 a JPEG".to_vec(), "JPEG alters the values"),
        (vec![], "is empty"),
    ] {
        let path = folder.path().join("z");
        std::fs::write(&path, bytes).unwrap();
        let said = read(&path, SuppliedKind::Metres).unwrap_err().to_string();
        assert!(said.contains(expected) && said.contains(path.to_str().unwrap()), "{said}");
    }
}

#[test]
fn each_image_has_one_map_in_the_folder() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.tiff", "b.png", "b.npy", "a.txt"] {
        std::fs::write(folder.path().join(name), "").unwrap();
    }
    let maps = DepthFolder::list(folder.path()).unwrap();
    assert!(maps.map_of(Path::new("photos/a.jpg")).unwrap().ends_with("a.tiff"));
    for (image, expected) in [("b.jpg", "holds 2 depth maps"), ("c.jpg", "holds 0 depth maps")] {
        let said = maps.map_of(Path::new(image)).unwrap_err().to_string();
        assert!(said.contains(expected), "{said}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    #[test]
    fn no_bytes_make_a_reader_panic(mut bytes in prop::collection::vec(any::<u8>(), 0..400), start in 0..6_usize) {
        let magic: [&[u8]; 6] =
            [b"", b"\x89PNG\r\n\x1a\n", b"II*\0", b"\x76\x2f\x31\x01\x02\0\0\0", b"\x93NUMPY\x01\0", b"Pf\n"];
        bytes.splice(0..0, magic[start].iter().copied());
        let _ = decoded(&bytes);
    }

    #[test]
    fn no_damage_makes_a_reader_panic(
        name in prop::sample::select(&NAMES[..]),
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        length in any::<prop::sample::Index>(),
        cut: bool,
    ) {
        let mut bytes = file(name, &map(DepthKind::Metres));
        for (place, byte) in damage {
            let place = place.index(bytes.len());
            bytes[place] = byte;
        }
        if cut {
            bytes.truncate(length.index(bytes.len()));
        }
        if let Ok(raster) = decoded(&bytes) {
            prop_assert_eq!(raster.values.len(), raster.width * raster.height);
        }
    }
}

#[test]
fn a_map_of_another_size_than_the_image_is_refused_from_its_header() {
    let folder = tempfile::tempdir().unwrap();
    for extension in ["png", "tif", "exr", "npy", "pfm"] {
        let path = folder.path().join(format!("z.{extension}"));
        write(&path, &map(DepthKind::Relative), &WriteOptions::default()).unwrap();
        let (width, height) = map(DepthKind::Relative).size();
        assert!(read_for(&path, SuppliedKind::Relative, (width, height)).is_ok());
        let refused = read_for(&path, SuppliedKind::Relative, (width + 1, height)).unwrap_err();
        assert!(
            matches!(refused, FileError::UnfitDepth { error: SuppliedError::Size { .. }, .. }),
            "{refused}"
        );
    }
}
