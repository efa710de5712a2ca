//! `inspect --plots`, as a user runs the command.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

mod run;

use aquafuse::depth::DepthMap;
use aquafuse::image::Image;
use aquafuse_data::depth_file;
use aquafuse_data::image_file::{ImageFile, WriteOptions};
use run::{Run, scene};
use serde_json::Value;

/// Columns and rows of cells, the size of one, and the height of the heading above them.
const CELLS: (usize, usize) = (4, 3);
const CELL: (usize, usize) = (416, 376);
const HEAD: usize = 48;
/// Cell of the veiling light, and the middle of its swatch there, below an image of 3 to 2.
const VEIL: (usize, usize) = (0, 1);
const SWATCH: (usize, usize) = (44, 312);

fn figure(run: &Run, name: &str) -> Image<u8> {
    let figure = ImageFile::read(&run.path(name)).unwrap().pixels.into_bytes();
    assert_eq!(figure.size(), (CELLS.0 * CELL.0, HEAD + CELLS.1 * CELL.1));
    figure
}

fn at(figure: &Image<u8>, cell: (usize, usize), (x, y): (usize, usize)) -> [u8; 3] {
    figure.pixels()[(HEAD + cell.1 * CELL.1 + y) * figure.width() + cell.0 * CELL.0 + x]
}

/// How many colours a cell holds.
fn colours(figure: &Image<u8>, cell: (usize, usize)) -> usize {
    let places = (0..CELL.1).flat_map(|y| (0..CELL.0).map(move |x| (x, y)));
    places.map(|place| at(figure, cell, place)).collect::<std::collections::HashSet<_>>().len()
}

#[test]
fn every_panel_is_drawn_and_the_veils_colour_is_shown() {
    let run = Run::new();
    scene(&run.path("reef.png"), 1, "blue");
    let said = run.ok(&["inspect", "reef.png", "--plots", "new/figures"]).stdout;
    assert!(said.contains("new/figures/reef.inspect.png"), "{said}");
    let figure = figure(&run, "new/figures/reef.inspect.png");
    for row in 0..CELLS.1 {
        for column in 0..CELLS.0 {
            let found = colours(&figure, (column, row));
            assert!(found > 30, "the cell in column {column}, row {row} has {found} colours");
        }
    }
    let json: Value = serde_json::from_str(&run.ok(&["inspect", "reef.png", "--json"]).stdout).unwrap();
    let veil: Vec<u8> = json["waterbody"]["veiling_light"]
        .as_array()
        .unwrap()
        .iter()
        .map(|value| (255.0 * value.as_f64().unwrap()).round() as u8)
        .collect();
    assert_eq!(at(&figure, VEIL, SWATCH)[..], veil);
}

#[test]
fn json_stays_pure_and_an_existing_figure_is_refused_by_name() {
    let run = Run::new();
    scene(&run.path("reef.png"), 1, "blue");
    let inspect = ["inspect", "reef.png", "--json", "--plots", "."];
    let json: Value = serde_json::from_str(&run.ok(&inspect).stdout).unwrap();
    assert_eq!(json["schema"], 1);
    std::fs::write(run.path("reef.inspect.png"), "mine").unwrap();
    let refused = run.fails(2, &inspect);
    assert!(
        refused.stderr.contains("reef.inspect.png exists") && refused.stdout.is_empty(),
        "{}",
        refused.stderr
    );
    assert_eq!(run.bytes("reef.inspect.png"), b"mine");
    run.ok(&[&inspect[..], &["--overwrite"]].concat());
    figure(&run, "reef.inspect.png");
    let alone = run.fails(2, &["inspect", "reef.png", "--overwrite"]).stderr;
    assert!(alone.contains("--plots"), "{alone}");
}

#[test]
fn supplied_depth_is_drawn_beside_depth_from_colour() {
    let run = Run::new();
    scene(&run.path("reef.png"), 1, "blue");
    // Steps to the right: bright at the right end of its panel, and only there.
    let steps = (0..64).flat_map(|_| (0..96).map(|x| x * 2)).collect();
    let z = DepthMap::from_levels(96, 64, steps).unwrap();
    depth_file::write(&run.path("z.npy"), &z, &WriteOptions::default()).unwrap();
    run.ok(&["inspect", "reef.png", "--plots", ".", "--depth", "z.npy", "--depth-kind", "relative"]);
    let figure = figure(&run, "reef.inspect.png");
    let [left, right] = [20, 395].map(|x| at(&figure, (3, 0), (x, 170))[0]);
    assert!(left < 20 && right > 240, "{left} {right}");
    assert!(colours(&figure, (3, 1)) > 30);
}

#[test]
fn an_image_on_its_side_is_drawn_upright() {
    let run = Run::new();
    // Stored: left half dark, right half bright. Orientation 6 turns the left edge up.
    let row = |_| (0..90).flat_map(|x| if x < 45 { [10_u8, 30, 40] } else { [90, 160, 180] });
    let mut image = ImageFile::new(Image::from_raw(90, 60, (0..60).flat_map(row).collect()).unwrap());
    image.metadata.exif = Some(b"II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0\x06\0\0\0\0\0\0\0".to_vec());
    image.write(&run.path("side.png"), &WriteOptions::default()).unwrap();
    run.ok(&["inspect", "side.png", "--plots", "."]);
    let figure = figure(&run, "side.inspect.png");
    let [top, bottom] = [60, 300].map(|y| at(&figure, (0, 0), (208, y))[1]);
    assert!(top < 60 && bottom > 130, "{top} {bottom}");
}

/// An axis without an end would be drawn for ever.
#[test]
fn the_farthest_depth_that_a_number_can_say_is_drawn() {
    let run = Run::new();
    scene(&run.path("a.png"), 3, "blue");
    let (width, height) = ImageFile::read(&run.path("a.png")).unwrap().pixels.size();
    let far = vec![f32::MAX; width * height];
    let map = DepthMap::from_distances(width, height, aquafuse::depth::DepthKind::Metres, far).unwrap();
    depth_file::write(&run.path("z.npy"), &map, &WriteOptions::default()).unwrap();
    run.ok(&["inspect", "a.png", "--depth", "z.npy", "--depth-kind", "metres", "--plots", "."]);
    figure(&run, "a.inspect.png");
}
