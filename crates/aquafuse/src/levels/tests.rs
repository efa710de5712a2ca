use super::*;
use crate::depth;
use crate::formation::{BoundedRestoration, RestoreOptions, restore_mut};
use crate::image::{Encoded, Image};
use crate::simd::Level;
use crate::truth::{Scene, Size, waters};
use crate::waterbody;

/// A reef in a water, of a width that no block divides.
fn seen(water: usize) -> Image<u8> {
    let scene = Scene::new(3, Size { width: 101, height: 67 });
    scene.seen_through(&waters()[water].water).convert()
}

fn levelled<T: Sample>(image: &Image<T>, options: &LevelsOptions) -> Image<T> {
    let mut levelled = image.clone();
    Levels::of(image, options).apply(&mut levelled);
    levelled
}

fn mirrored(image: &Image<u8>) -> Image<u8> {
    let (width, height) = image.size();
    let rows = image.pixels().chunks(width).flat_map(|row| row.iter().rev().copied());
    Image::from_raw(width, height, rows.flatten().collect()).unwrap()
}

/// How far red leads green and blue.
fn lead([red, green, blue]: [u8; 3]) -> i32 {
    i32::from(red) - i32::from(green.max(blue))
}

#[test]
fn at_strength_0_nothing_changes() {
    let none = LevelsOptions::default().with_strength(0.0);
    assert_eq!(levelled(&seen(0), &none), seen(0));
}

#[test]
fn with_neither_white_nor_exposure_nothing_changes() {
    let none = LevelsOptions::default().with_white(Setting::None).with_exposure(Setting::None);
    assert!(none.sets_nothing());
    assert_eq!(levelled(&seen(1), &none), seen(1));
}

#[test]
fn the_mirror_image_becomes_the_mirror_image() {
    for water in 0..waters().len() {
        let image = seen(water);
        let options = LevelsOptions::default();
        assert_eq!(levelled(&mirrored(&image), &options), mirrored(&levelled(&image, &options)));
    }
}

#[test]
fn every_instruction_set_gives_the_same_bits() {
    let image = seen(2);
    let all = |options: &LevelsOptions| {
        let (words, floats) = (image.convert::<u16>(), image.convert::<f32>());
        (levelled(&image, options), levelled(&words, options), levelled(&floats, options))
    };
    let options = LevelsOptions::default();
    let plain = Level::Plain.force(|| all(&options));
    for level in Level::all() {
        assert_eq!(level.force(|| all(&options)), plain, "{level:?}");
    }
}

#[test]
fn bytes_become_what_floats_become() {
    for water in 0..waters().len() {
        let image = seen(water);
        let bytes = levelled(&image, &LevelsOptions::default());
        let floats = levelled(&image.convert::<f32>(), &LevelsOptions::default()).convert::<u8>();
        for (byte, float) in bytes.as_raw().iter().zip(floats.as_raw()) {
            assert!(byte.abs_diff(*float) <= 1, "{byte} is not {float}");
        }
    }
}

#[test]
fn red_leads_nowhere_where_it_did_not() {
    for water in 0..waters().len() {
        let image = seen(water);
        let levelled = levelled(&image, &LevelsOptions::default());
        for (&before, &after) in image.pixels().iter().zip(levelled.pixels()) {
            assert!(lead(before) > 20 || lead(after) <= 20, "{before:?} became {after:?}");
        }
    }
}

#[test]
fn a_cast_goes_and_grey_stays_grey() {
    // Grey things behind a veil of one distance: levels of each channel are what undoes it.
    let grey = |i: usize| (i * 37 % 200) as f32 / 255.0;
    let samples = |veil: [f32; 3], left: [f32; 3]| {
        let value = move |i: usize, c: usize| grey(i) * left[c] + veil[c];
        Image::<f32>::from_raw(64, 32, (0..6144).map(|k| value(k / 3, k % 3)).collect()).unwrap()
    };
    let off = |image: &Image<f32>| {
        let off = |[red, green, blue]: &[f32; 3]| (red - green).abs().max((blue - green).abs());
        image.pixels().iter().map(off).fold(0.0, f32::max)
    };
    let seen = samples([0.05, 0.3, 0.4], [0.3, 0.5, 0.4]);
    let found = levelled(&seen, &LevelsOptions::default());
    assert!(off(&found) < 0.25 * off(&seen), "{} of {}", off(&found), off(&seen));
}

#[test]
fn without_white_balance_all_channels_have_one_curve() {
    let levels = Levels::of(&seen(0), &LevelsOptions::default().with_white(Setting::None));
    assert_eq!((levels.red_from_green, levels.colour), (0.0, 1.0));
    for of in [levels.black, levels.gain, levels.exponent] {
        assert_eq!(of, [of[0]; 3]);
    }
}

#[test]
fn an_image_without_contrast_has_levels() {
    for value in [0, 7, 255] {
        let flat = Image::<u8>::from_raw(5, 4, vec![value; 60]).unwrap();
        let levels = Levels::of(&flat, &LevelsOptions::default());
        assert!(levels.gain.iter().chain(&levels.exponent).all(|value| value.is_finite()), "{levels:?}");
    }
}

#[test]
fn an_image_gets_the_lightness_that_is_asked_for() {
    let mut image = seen(0);
    let wanted = lightness(&image) + 0.1;
    Levels::of_lightness(&image, wanted).apply(&mut image);
    assert!((lightness(&image) - wanted).abs() < 0.01, "{} is not {wanted}", lightness(&image));
}

#[test]
fn a_restoration_with_levels_that_set_nothing_is_equation_2() {
    let image = seen(0);
    let z = depth::estimate(&image);
    let found = waterbody::estimate::<Encoded>(&image, &z, &Default::default()).unwrap();
    let bounded = BoundedRestoration::new(&image, &z, &found, &RestoreOptions::default()).unwrap();
    let none = LevelsOptions::default().with_white(Setting::None).with_exposure(Setting::None);
    let (mut alone, mut in_one) = (image.clone(), image.clone());
    restore_mut(&mut alone, &z, &bounded.water, &bounded.options).unwrap();
    let levels = bounded.levels(&image, &z, &none).unwrap();
    bounded.restore_and_level_mut(&mut in_one, &z, &levels).unwrap();
    for (alone, in_one) in alone.as_raw().iter().zip(in_one.as_raw()) {
        assert!(alone.abs_diff(*in_one) <= 1, "{alone} is not {in_one}");
    }
}

#[test]
fn where_red_was_far_behind_no_restoration_makes_it_lead() {
    /// Red is given back and more.
    struct Reddened;

    impl Before for Reddened {
        const LEAD_FROM_BEHIND: f32 = 0.0;

        fn at(&self, _: usize, _: usize, [red, green, blue]: [f32; 3]) -> [f32; 3] {
            [3.0 * red, green, blue]
        }
    }
    let mut nearly_led = 0;
    for water in 0..waters().len() {
        let image = seen(water);
        let mut restored = image.clone();
        Levels::of_restored(image.view(), &LevelsOptions::default(), true, &Reddened)
            .apply_restored(restored.view_mut(), &Reddened);
        for (&before, &after) in image.pixels().iter().zip(restored.pixels()) {
            assert!(lead(before) > -20 || lead(after) <= 1, "{before:?} became {after:?}");
            nearly_led += usize::from(lead(before) <= -20 && lead(after) >= 0);
        }
    }
    assert!(nearly_led > 100, "only {nearly_led} pixels put it to the test");
}
