use super::*;
use crate::image::Image;
use crate::truth::{Scene, Size, waters};

/// A small image and what the network's own Python makes of it, written with the weights.
const FIXTURE: &[u8] = include_bytes!("fixture.bin");
const FIXTURE_SIZE: (usize, usize) = (96, 64);

fn seen(number: usize, width: usize, height: usize) -> Image<u8> {
    let scene = Scene::new(number as u64, Size { width, height });
    scene.seen_through(&waters()[number % 5].water).convert()
}

#[test]
fn it_computes_what_it_was_trained_as() {
    let (width, height) = FIXTURE_SIZE;
    let (bytes, floats) = FIXTURE.split_at(3 * width * height);
    let pixels = bytes.as_chunks::<3>().0.iter().map(|pixel| pixel.map(|value| f32::from(value) / 255.0));
    let maps = run(&Small { width, height, pixels: pixels.collect() }, Level::best());
    let expected: Vec<f32> = floats.as_chunks::<4>().0.iter().map(|four| f32::from_le_bytes(*four)).collect();
    let places = width / 2 * (height / 2);
    assert_eq!(expected.len(), OUTPUTS * places);
    let mut spread = 0.0_f32;
    for (place, channel) in (0..places).flat_map(|place| (0..OUTPUTS).map(move |channel| (place, channel))) {
        let own = maps.row(place / (width / 2))[place % (width / 2) * OUTPUTS + channel];
        let theirs = expected[channel * places + place];
        assert!(
            (own - theirs).abs() < 2e-3 * (1.0 + theirs.abs()),
            "{place} {channel}: {own} is not {theirs}"
        );
        spread = spread.max((theirs - expected[channel * places]).abs());
    }
    assert!(spread > 1.0, "a fixture that is flat proves nothing");
}

#[test]
fn vectors_and_threads_change_no_bit() {
    let image = seen(1, 200, 120);
    let plain = Sight::by(Level::Plain, image.view(), TopEdge::First);
    for level in Level::all() {
        assert_eq!(Sight::by(level, image.view(), TopEdge::First), plain);
    }
    assert_eq!(crate::on_this_thread(|| Sight::of(&image, TopEdge::First)), plain);
}

#[test]
fn the_mirror_image_is_seen_mirrored() {
    for (width, height) in [(160, 120), (161, 97), (75, 130)] {
        let image = seen(2, width, height);
        let pixels = image.pixels().chunks(width).flat_map(|row| row.iter().rev().copied());
        let mirror = Image::from_raw(width, height, pixels.flatten().collect()).unwrap();
        let [own, mirrored] = [&image, &mirror].map(|image| Sight::of(image, TopEdge::First));
        let columns = own.size().0;
        let back: Vec<u16> =
            mirrored.water.chunks(columns).flat_map(|row| row.iter().rev().copied()).collect();
        assert_eq!(back, own.water, "{width} x {height}");
    }
}

#[test]
fn an_image_stored_on_its_side_is_seen_as_it_is_upright() {
    let image = seen(3, 160, 120);
    let own = Sight::of(&image, TopEdge::First);
    // Stored a quarter turned: the first row is the last column.
    let turned = (0..160).flat_map(|y| (0..120).map(move |x| (y, 119 - x)));
    let pixels: Vec<u8> = turned.flat_map(|(column, row)| image.pixels()[row * 160 + column]).collect();
    let turned = Sight::of(&Image::from_raw(120, 160, pixels).unwrap(), TopEdge::Right);
    assert_eq!(turned.size(), (own.size().1, own.size().0));
    let (columns, rows) = own.size();
    for (x, y) in (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y))) {
        let there = turned.water[x * rows + (rows - 1 - y)];
        assert_eq!(there, own.water[y * columns + x]);
    }
}

#[test]
fn shares_between_borders_are_means() {
    let sight = Sight { size: (4, 2), water: vec![0, 65535, 0, 65535, 65535, 0, 0, 0], ln_z: vec![0; 8] };
    let part = |columns: &[usize], rows: &[usize]| -> Vec<f32> {
        sight
            .logits_between(columns, rows)
            .into_iter()
            .map(|logit| (logit - RANGE[0]) / (RANGE[1] - RANGE[0]))
            .collect()
    };
    let are = |found: Vec<f32>, wanted: &[f32]| {
        assert_eq!(found.len(), wanted.len());
        assert!(found.iter().zip(wanted).all(|(found, wanted)| (found - wanted).abs() < 1e-6), "{found:?}");
    };
    are(part(&[0, 40], &[0, 20]), &[3.0 / 8.0]);
    are(part(&[0, 10, 20, 30, 40], &[0, 10, 20]), &[0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
    // Three cells over four places: each is one place and a third.
    are(part(&[0, 4, 8, 12], &[0, 6]), &[0.5 * (0.25 + 0.75), 0.5 * 0.5, 0.5 * 0.75]);
}

#[test]
fn open_water_of_truth_scenes_is_found() {
    let (mut both, mut either) = (0, 0);
    for number in 300..312 {
        let scene = Scene::new(number, Size { width: 160, height: 120 });
        let image: Image<u8> = scene.seen_through(&waters()[number as usize % 5].water).convert();
        let sight = Sight::of(&image, TopEdge::First);
        let (columns, rows) = sight.size();
        for (x, y) in (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y))) {
            let is = scene.depth.at((2 * x + 1) * 160 / (2 * columns), (2 * y + 1) * 120 / (2 * rows)) > 50.0;
            let said = sight.water[y * columns + x] > 32767;
            both += usize::from(is && said);
            either += usize::from(is || said);
        }
    }
    assert!(both as f64 > 0.8 * either as f64, "intersection over union {}", both as f64 / either as f64);
}
