use super::*;
use crate::truth::{Scene, Size, waters};
use proptest::prelude::*;

/// A synthetic scene, noise included.
fn scene(seed: u64, width: usize, height: usize) -> Image<u8> {
    let water = waters()[seed as usize % waters().len()].water;
    Scene::new(seed, Size { width, height }).seen_through(&water).convert()
}

fn framed(scene: &Image<u8>, margins: Margins, colour: [u8; 3]) -> Image<u8> {
    let (width, height) =
        (scene.width() + margins.left + margins.right, scene.height() + margins.top + margins.bottom);
    let mut image = Image::<u8>::from_raw(width, height, colour.repeat(width * height)).unwrap();
    let area = SceneArea::of(&image, Border::Given(margins)).unwrap();
    area.put_back(scene, &mut image).unwrap();
    image
}

fn found(image: &Image<u8>) -> SceneArea {
    SceneArea::of(image, Border::Auto).unwrap()
}

fn mirrored(image: &Image<u8>) -> Image<u8> {
    let samples = image.rows().flat_map(|row| row.iter().rev().copied().collect::<Vec<_>>()).flatten();
    Image::from_raw(image.width(), image.height(), samples.collect()).unwrap()
}

fn transposed(image: &Image<u8>) -> Image<u8> {
    let (width, height) = image.size();
    let samples = (0..width).flat_map(|x| (0..height).flat_map(move |y| image.pixels()[y * width + x]));
    Image::from_raw(height, width, samples.collect()).unwrap()
}

/// A scene in the circle of a fish-eye.
fn round(seed: u64, middle: [f64; 2], radius: f64) -> Image<u8> {
    let mut image = scene(seed, 160, 120);
    let width = image.width();
    for (i, pixel) in image.pixels_mut().iter_mut().enumerate() {
        let (x, y) = ((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
        if (x - middle[0]).hypot(y - middle[1]) > radius {
            *pixel = [2, 2, 2];
        }
    }
    image
}

#[test]
fn bars_of_any_colour_are_found_at_each_side() {
    let (one, two) = ([0, 0, 9, 0], [12, 3, 7, 22]);
    for (i, &grey) in [0, 16, 114, 255].iter().enumerate() {
        for [top, right, bottom, left] in [[8, 0, 8, 0], [0, 11, 0, 11], one, two] {
            let margins = Margins { top, right, bottom, left };
            let image = framed(&scene(i as u64, 96, 64), margins, [grey; 3]);
            assert_eq!(found(&image).margins(), margins, "{grey}");
            assert!(!found(&image).has_outline());
        }
    }
}

#[test]
fn a_bar_with_text_is_found_whole() {
    let margins = Margins { top: 12, ..Margins::default() };
    let mut image = framed(&scene(1, 96, 64), margins, [0; 3]);
    // Letters of 6 rows and strokes of one column, over half of the width.
    let width = image.width();
    (3..9)
        .flat_map(|y| (2..50).step_by(3).map(move |x| (x, y)))
        .for_each(|(x, y)| image.pixels_mut()[y * width + x] = [255; 3]);
    assert_eq!(found(&image).margins(), margins);
}

#[test]
fn bars_within_bars_are_found_too() {
    let inner = framed(&scene(3, 96, 64), Margins { top: 8, bottom: 8, ..Margins::default() }, [16; 3]);
    let image = framed(&inner, Margins { left: 10, right: 10, ..Margins::default() }, [0; 3]);
    assert_eq!(found(&image).margins().to_string(), "8,10,8,10");
}

#[test]
fn a_scene_without_a_border_is_left_whole() {
    for seed in 0..12 {
        assert!(found(&scene(seed, 128, 96)).is_whole(), "{seed}");
    }
    for (width, height) in [(1, 1), (1, 40), (40, 1), (15, 80)] {
        assert!(found(&scene(0, width, height)).is_whole());
        let flat = Image::<u8>::from_raw(width, height, vec![7; 3 * width * height]).unwrap();
        assert!(found(&flat).is_whole());
    }
}

/// The water is even to the last bit, and nothing in it ends at a straight line.
#[test]
fn flat_open_water_at_the_side_is_no_border() {
    let mut image = scene(5, 128, 96);
    for (i, pixel) in image.pixels_mut().iter_mut().enumerate() {
        let (x, y) = (i % 128, i / 128);
        let horizon = (36.0 + (x as f64 / 9.0).sin() * 6.0) as usize;
        if y < horizon {
            *pixel = [20, 90, 140];
        }
    }
    assert!(found(&image).is_whole(), "{}", found(&image).margins());
}

#[test]
fn the_circle_of_a_fish_eye_is_found() {
    for (seed, middle, radius) in [(0, [80.0, 60.0], 55.0), (1, [78.0, 61.5], 66.0), (2, [80.0, 60.0], 85.0)]
    {
        let area = found(&round(seed, middle, radius));
        assert!(area.has_outline(), "{radius}");
        for (x, y) in (0..120).flat_map(|y| (0..160).map(move |x| (x, y))) {
            let distance = (x as f64 + 0.5 - middle[0]).hypot(y as f64 + 0.5 - middle[1]);
            if distance > radius + 0.5 || distance < radius - 2.5 {
                assert_eq!(area.contains(x, y), distance < radius, "{x}, {y}: {distance} of {radius}");
            }
        }
    }
}

#[test]
fn outside_of_its_outline_a_scene_is_filled_with_scene() {
    let image = round(4, [80.0, 60.0], 50.0);
    let area = found(&image);
    let scene = area.cut(&image);
    assert!(scene.pixels().iter().all(|pixel| *pixel != [2; 3]));
    let mut back = image.clone();
    area.put_back(&scene, &mut back).unwrap();
    assert_eq!(back, image);
}

#[test]
fn what_is_transparent_is_left_out() {
    let image = scene(6, 40, 30);
    let area = SceneArea::whole((40, 30)).only(|x, y| x >= 4 && !(10..12).contains(&y) && y < 28);
    assert_eq!(area.margins().to_string(), "0,0,2,4");
    assert!(area.has_outline() && !area.contains(20, 10) && area.contains(39, 12));
    let mut written = image.clone();
    let black = Image::<u8>::from_raw(36, 28, vec![0; 36 * 28 * 3]).unwrap();
    area.put_back(&black, &mut written).unwrap();
    for (i, (before, after)) in image.pixels().iter().zip(written.pixels()).enumerate() {
        assert_eq!(*after, if area.contains(i % 40, i / 40) { [0; 3] } else { *before });
    }
    // Of a picture that is transparent everywhere nothing is left out.
    assert!(SceneArea::whole((4, 3)).only(|_, _| false).is_whole());
}

#[test]
fn a_border_that_leaves_nothing_is_refused() {
    let image = scene(0, 20, 10);
    let margins = Margins { left: 12, right: 8, ..Margins::default() };
    let error = SceneArea::of(&image, Border::Given(margins)).unwrap_err();
    assert!(error.to_string().starts_with("a border of 0,8,0,12 "), "{error}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    /// The mirror image has the mirrored border, and so has the image turned; bars, text and circles alike.
    #[test]
    fn a_mirrored_or_turned_image_has_its_border_mirrored_or_turned(
        seed in 0..6_u64, sides in [0..20_usize, 0..20_usize, 0..20_usize, 0..20_usize], grey: u8, circle: bool,
        middle in (70.0..90.0_f64, 50.0..70.0_f64), radius in 45.0..90.0_f64,
    ) {
        let [top, right, bottom, left] = sides;
        let margins = Margins { top, right, bottom, left };
        let inner = if circle { round(seed, middle.into(), radius) } else { scene(seed, 160, 120) };
        let image = framed(&inner, margins, [grey; 3]);
        let area = found(&image);
        let (mirror, turned) = (found(&mirrored(&image)), found(&transposed(&image)));
        let (width, height) = image.size();
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            prop_assert_eq!(area.contains(x, y), mirror.contains(width - 1 - x, y));
            prop_assert_eq!(area.contains(x, y), turned.contains(y, x));
        }
        prop_assert_eq!(mirror.cut(&mirrored(&image)), mirrored(&area.cut(&image)));
    }
}
