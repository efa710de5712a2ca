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
fn labels_are_read_as_fusion_reads_depth_and_nothing_is_filled_in() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let labels = |depth: &str, kind| {
        let pair = Pair { name: "p".into(), rgb: path("p.png"), depth: path(depth) };
        pair.read(kind, &ReadOptions::default()).unwrap().1
    };
    let same = |found: Vec<f32>, expected: [f32; 4]| {
        assert!(found.iter().zip(expected).all(|(a, b)| *a == b || a.is_nan() && b.is_nan()), "{found:?}");
    };
    const NONE: f32 = f32::NAN;
    ::image::RgbImage::from_pixel(4, 1, ::image::Rgb([1, 2, 3])).save(path("p.png")).unwrap();
    tiff_of_floats(&path("z.tiff"), 4, &[0.0, 0.5, f32::NAN, -1.0]);
    same(labels("z.tiff", SuppliedKind::Metres), [NONE, 0.5, NONE, NONE]);
    same(labels("z.tiff", SuppliedKind::Millimetres), [NONE, 0.0005, NONE, NONE]);
    same(labels("z.tiff", SuppliedKind::Relative), [0.0, 0.5, NONE, NONE]);
    same(labels("z.tiff", SuppliedKind::Inverse), [1.0, 0.0, NONE, NONE]);

    ::image::GrayImage::from_raw(4, 1, vec![0, 51, 204, 255]).unwrap().save(path("z.png")).unwrap();
    same(labels("z.png", SuppliedKind::Relative), [0.0, 0.2, 0.8, 1.0]);
    same(labels("z.png", SuppliedKind::Disparity), [NONE, 1.0, 0.25, 0.2]);

    let npy = "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 4), }\n";
    let head = [&b"\x93NUMPY\x01\x00"[..], &(npy.len() as u16).to_le_bytes(), npy.as_bytes()].concat();
    let values = [1.0_f32, 0.0, 2.0, 3.0].map(f32::to_le_bytes).concat();
    std::fs::write(path("z.npy"), [head, values].concat()).unwrap();
    same(labels("z.npy", SuppliedKind::Metres), [1.0, NONE, 2.0, 3.0]);
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
    ::image::RgbImage::new(4, 4).save(path("four.png")).unwrap();
    tiff_of_floats(&path("small.tiff"), 4, &[1.0; 16]);
    std::fs::write(path("no.tiff"), "no TIFF").unwrap();
    let said = |rgb: &str, depth: &str| {
        let pair = Pair { name: "p".into(), rgb: path(rgb), depth: path(depth) };
        pair.read(SuppliedKind::Metres, &ReadOptions::default()).unwrap_err().to_string()
    };
    assert!(said("colour.png", "small.tiff").contains("the map is 4x4, the image 8x8"));
    assert!(said("colour.png", "colour.png").contains("one channel"));
    assert!(said("small.tiff", "small.tiff").contains("plain RGB"));
    assert!(said("colour.png", "no.tiff").contains("no depth map"));
    let flat = Pair { name: "p".into(), rgb: path("four.png"), depth: path("small.tiff") };
    let said_of_flat = flat.read(SuppliedKind::Disparity, &ReadOptions::default()).unwrap_err().to_string();
    assert!(said_of_flat.contains("all depths are 1"), "{said_of_flat}");
    assert!(said("colour.png", "missing.png").contains("cannot read"));
}

#[test]
fn limits_hold_for_pairs_and_a_map_of_another_size_is_not_decoded() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    ::image::RgbImage::new(40, 10).save(path("p.png")).unwrap();
    ::image::GrayImage::new(4000, 1000).save(path("z.png")).unwrap();
    let pair = Pair { name: "p".into(), rgb: path("p.png"), depth: path("z.png") };
    let read = |options: &ReadOptions| pair.read(SuppliedKind::Relative, options).unwrap_err().to_string();
    let few = read(&ReadOptions { max_pixels: 399, ..ReadOptions::default() });
    assert!(few.contains("--max-pixels"), "{few}");
    let other = read(&ReadOptions::default());
    assert!(other.contains("4000") && other.contains("40"), "{other}");
}

/// Of memory for one pair more threads read one after the other; what comes out is the same. The images are large enough for
/// work on one to be shared between the threads of a pool.
#[test]
fn pairs_are_gathered_in_their_order_within_memory_for_one() {
    use aquafuse::truth::{Scene, Size, waters};
    let folder = tempfile::tempdir().unwrap();
    let size = Size { width: 512, height: 384 };
    let pairs: Vec<Pair> = (0..4)
        .map(|seed| {
            let (scene, path) =
                (Scene::new(seed, size), |name: &str| folder.path().join(format!("{seed}{name}")));
            let image = scene.seen_through(&waters()[0].water).convert::<u8>();
            let image_file = ImageFile::new(image);
            image_file.write(&path(".png"), &crate::image_file::WriteOptions::default()).unwrap();
            tiff_of_floats(&path(".tiff"), 512, &scene.depth.distances());
            Pair { name: seed.to_string(), rgb: path(".png"), depth: path(".tiff") }
        })
        .collect();
    let one = pairs.iter().map(|pair| ImageFile::open(&pair.rgb, &ReadOptions::default()).unwrap().memory());
    let tight = ReadOptions { max_memory: one.max().unwrap(), ..ReadOptions::default() };
    let scores = |threads: usize, reading: &ReadOptions| {
        let (threads, reading) = (std::num::NonZeroUsize::new(threads), *reading);
        let run = RunOptions { threads, reading, ..RunOptions::default() };
        let gathered = gather(&pairs, SuppliedKind::Metres, Options::default(), &run, &|_| {}).unwrap();
        assert_eq!(gathered.names, ["0", "1", "2", "3"]);
        gathered.fitter.rank_scores(&aquafuse::depth::Eq3::OURS)
    };
    assert_eq!(scores(4, &tight), scores(1, &ReadOptions::default()));
}
