use super::*;
use std::io::Cursor;

use tiff::encoder::{TiffEncoder, colortype};

fn tiff_of_floats(path: &Path, width: u32, numbers: &[f32]) {
    let mut bytes = Cursor::new(Vec::new());
    let height = numbers.len() as u32 / width;
    let mut encoder = TiffEncoder::new(&mut bytes).unwrap();
    encoder.write_image::<colortype::Gray32Float>(width, height, numbers).unwrap();
    std::fs::write(path, bytes.into_inner()).unwrap();
}

#[test]
fn a_number_means_what_its_kind_says() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("z.tiff");
    tiff_of_floats(&path, 4, &[0.0, 0.5, f32::NAN, -1.0]);
    let read = |kind| read_depth(&path, kind).unwrap().distances;
    let same = |found: Vec<f32>, expected: [f32; 4]| {
        assert!(found.iter().zip(expected).all(|(a, b)| *a == b || a.is_nan() && b.is_nan()), "{found:?}");
    };
    const NONE: f32 = f32::NAN;
    same(read(LabelKind::Metres), [NONE, 0.5, NONE, NONE]);
    same(read(LabelKind::Millimetres), [NONE, 0.0005, NONE, NONE]);
    same(read(LabelKind::Relative), [0.0, 0.5, NONE, NONE]);
    same(read(LabelKind::Inverse), [NONE, 2.0, NONE, NONE]);
    same(read(LabelKind::Disparity), [NONE, 2.0, NONE, NONE]);
}

#[test]
fn whole_numbers_of_relative_depth_are_shares_of_their_range() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("z.png");
    ::image::GrayImage::from_raw(3, 1, vec![0, 51, 255]).unwrap().save(&path).unwrap();
    assert_eq!(read_depth(&path, LabelKind::Relative).unwrap().distances, [0.0, 0.2, 1.0]);
    assert_eq!(read_depth(&path, LabelKind::Metres).unwrap().distances[1..], [51.0, 255.0]);
}

#[test]
fn files_are_paired_by_their_stems() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| std::fs::write(folder.path().join(name), "").unwrap();
    assert!(list(folder.path()).unwrap_err().to_string().contains("rgb"));
    for inner in ["rgb", "depth"] {
        std::fs::create_dir(folder.path().join(inner)).unwrap();
    }
    for name in
        ["rgb/b.jpg", "rgb/a.png", "rgb/.a.png", "rgb/c.png", "depth/a.tif", "depth/b.png", "depth/d.png"]
    {
        file(name);
    }
    let listing = list(folder.path()).unwrap();
    let names: Vec<_> = listing.pairs.iter().map(|pair| pair.name.as_str()).collect();
    assert_eq!((names, listing.without_partner), (vec!["a", "b"], vec!["c".to_owned(), "d".to_owned()]));
    file("depth/a.png");
    assert!(matches!(list(folder.path()), Err(PairError::Ambiguous { .. })));
}

#[test]
fn what_cannot_be_a_pair_is_refused_by_cause() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    ::image::RgbImage::from_pixel(8, 8, ::image::Rgb([1, 2, 3])).save(path("colour.png")).unwrap();
    tiff_of_floats(&path("small.tiff"), 4, &[1.0; 16]);
    std::fs::write(path("no.tiff"), "no TIFF").unwrap();
    let said = |rgb: &str, depth: &str| {
        let pair = Pair { name: "p".into(), rgb: path(rgb), depth: path(depth) };
        pair.read(LabelKind::Metres).unwrap_err().to_string()
    };
    assert!(said("colour.png", "small.tiff").contains("small.tiff is 4x4, its picture 8x8"));
    assert!(said("colour.png", "colour.png").contains("depth is read from one channel"));
    assert!(said("small.tiff", "small.tiff").contains("8-bit RGB"));
    assert!(said("colour.png", "no.tiff").contains("damaged"));
    assert!(said("colour.png", "missing.png").contains("cannot read"));
}
