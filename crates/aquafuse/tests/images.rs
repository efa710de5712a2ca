//! Laws about whole images: estimation included.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

use aquafuse::depth::{self, DepthKind, DepthMap};
use aquafuse::formation::restore;
use aquafuse::fusion::{Bounded, Incidence, Model, Options, Waters, fuse};
use aquafuse::image::{Encoded, Encoding, Image, ImageError, Linear};
use aquafuse::truth::{NamedWater, OPEN_WATER, Scene, Size, waters};
use aquafuse::waterbody::{self, EstimateOptions, VeilingLight, VeilingLightSource, Waterbody};

const SIZE: Size = Size { width: 96, height: 64 };

fn picture(seed: u64, water: &NamedWater) -> Image<u8> {
    Scene::new(seed, SIZE).seen_through(&water.water).convert()
}

fn estimated(image: &Image<u8>) -> (DepthMap, Waterbody) {
    estimated_by(image, &EstimateOptions::default())
}

fn estimated_by(image: &Image<u8>, options: &EstimateOptions) -> (DepthMap, Waterbody) {
    let z = depth::estimate(image);
    let water = waterbody::estimate::<Encoded>(image, &z, options).unwrap().water;
    (z, water)
}

fn mirrored<T: aquafuse::image::Sample>(image: &Image<T>) -> Image<T> {
    let samples = image.rows().flat_map(|row| row.iter().rev().flatten().copied().collect::<Vec<T>>());
    Image::from_raw(image.width(), image.height(), samples.collect()).unwrap()
}

#[test]
fn the_mirror_image_fuses_to_the_mirror_of_the_fusion() {
    let waters = waters();
    let reference = picture(2, &waters[1]);
    let (_, reference_water) = estimated(&reference);
    for &model in Model::ALL {
        let fused = |content: &Image<u8>, options: &EstimateOptions| {
            let (z, water) = estimated_by(content, options);
            fuse(content, &z, Waters::new(&water, &reference_water), &Options::for_model(model))
                .unwrap()
                .image
        };
        for (seed, water) in waters.iter().enumerate() {
            let content = picture(seed as u64, water);
            for options in [EstimateOptions::default(), EstimateOptions::as_published()] {
                assert_eq!(fused(&mirrored(&content), &options), mirrored(&fused(&content, &options)));
            }
        }
        let content = water_only_in_the_top_corners();
        assert_eq!(
            fused(&mirrored(&content), &EstimateOptions::as_published()),
            mirrored(&fused(&content, &EstimateOptions::as_published()))
        );
    }
}

#[test]
fn the_laws_hold_on_images_with_open_water() {
    let waters = waters();
    let estimated = |image: &Image<u8>| {
        let z = depth::estimate(image);
        let (own, share) =
            waterbody::estimate_with_share::<Encoded>(image, &z, &EstimateOptions::default()).unwrap();
        (z, own, share)
    };
    let (_, reference, _) = estimated(&picture(2, &waters[1]));
    let content = picture(1, &waters[0]);
    for model in [Model::Physical, Model::Exchange] {
        let fused = |content: &Image<u8>, degrees: f32| {
            let (z, own, share) = estimated(content);
            assert!(own.depth_factors.is_some() && !share.is_none(), "open water is in view");
            let incidence = Incidence::from_degrees(degrees).unwrap();
            let options = Options::for_model(model).with_incidence(incidence);
            let [itself, other] = [&own, &reference].map(|water| Bounded::new(&own, water, options));
            [itself, other].map(|bounded| {
                fuse(content, &z, bounded.waters().with_share(&share), &bounded.options).unwrap().image
            })
        };
        let [itself, other] = fused(&content, 0.0);
        assert_eq!(itself, content);
        assert_ne!(other, content);
        assert_eq!(fused(&content, 90.0)[1], content);
        assert_eq!(fused(&mirrored(&content), 0.0)[1], mirrored(&other));
        // The first row is open water: it has nearly the reference's colour now.
        let [own, veil] = [&estimated(&content).1, &reference].map(|found| found.water.veiling_light.rgb());
        for pixel in &other.pixels()[..SIZE.width] {
            for c in 0..3 {
                let left = (f32::from(pixel[c]) / 255.0 - veil[c]).abs();
                assert!(left < 0.2 * (own[c] - veil[c]).abs() + 0.01, "{pixel:?} is not {veil:?}");
            }
        }
    }
}

#[test]
fn a_share_of_another_size_is_an_error() {
    let content = picture(1, &waters()[0]);
    let (z, own) = estimated(&content);
    let share = waterbody::WaterShare::none((1, 1));
    let waters = Waters::new(&own, &own).with_share(&share);
    assert!(fuse(&content, &z, waters, &Options::for_model(Model::Physical)).is_err());
}

/// Red paint with a water-blue left and, of another blue, right corner: nothing far is blue.
fn water_only_in_the_top_corners() -> Image<u8> {
    let colour = |x: usize, y: usize| match (x, y) {
        (0..20, 0..13) => [120, 100, 140],
        (76.., 0..13) => [120, 90, 150],
        _ => [0, 255, 20],
    };
    let samples = (0..64).flat_map(|y| (0..96).flat_map(move |x| colour(x, y))).collect();
    let image = Image::from_raw(96, 64, samples).unwrap();
    let found =
        waterbody::estimate::<Encoded>(&image, &depth::estimate(&image), &EstimateOptions::as_published())
            .unwrap();
    assert_eq!(found.veiling_light_source, VeilingLightSource::TopCorners);
    image
}

#[test]
fn an_image_fused_with_itself_or_at_ninety_degrees_is_the_image() {
    let waters = waters();
    let (content, reference) = (picture(1, &waters[0]), picture(2, &waters[2]));
    let ((z, water), (_, other)) = (estimated(&content), estimated(&reference));
    for &model in Model::ALL {
        let options = Options::for_model(model);
        assert_eq!(fuse(&content, &z, Waters::new(&water, &water), &options).unwrap().image, content);
        let options = options.with_incidence(Incidence::from_degrees(90.0).unwrap());
        assert_eq!(fuse(&content, &z, Waters::new(&water, &other), &options).unwrap().image, content);
    }
}

#[test]
fn with_everything_given_physical_is_the_truth_and_aquafuse_its_closed_form() {
    let waters = waters();
    for (seed, (from, to)) in [(0, 1), (1, 2), (2, 3), (3, 0)].into_iter().enumerate() {
        let scene = Scene::new(seed as u64, SIZE);
        let (scene_water, veil) = (waters[from].water, waters[to].water.veiling_light);
        let reference = Waterbody { veiling_light: veil, ..scene_water };
        let content = scene.seen_through(&scene_water);
        let truth_a = scene.seen_through(&reference);

        let physical = Options::for_model(Model::Physical);
        let fused = fuse(&content, &scene.depth, Waters::new(&scene_water, &reference), &physical).unwrap();
        for (found, truth) in fused.image.as_raw().iter().zip(truth_a.as_raw()) {
            assert!((found - truth.clamp(0.0, 1.0)).abs() < 1e-6, "{found} is not {truth}");
        }

        let aquafuse = Options::for_model(Model::Aquafuse);
        let fused = fuse(&content, &scene.depth, Waters::new(&scene_water, &reference), &aquafuse).unwrap();
        let distances = scene.depth.distances();
        for ((found, before), z) in fused.image.pixels().iter().zip(content.pixels()).zip(distances) {
            for c in 0..3 {
                let factor = (-scene_water.backscatter_coefficient[c] * z).exp();
                let difference = veil.rgb()[c] - scene_water.veiling_light.rgb()[c];
                let closed = before[c] + 0.5_f32.sqrt() * factor * (1.0 - factor) * difference;
                assert!((found[c] - closed.clamp(0.0, 1.0)).abs() < 1e-6);
            }
        }
    }
}

#[test]
fn with_everything_given_exchange_is_the_scene_in_the_whole_other_water() {
    let waters = waters();
    for (seed, (from, to)) in [(0, 1), (1, 2), (2, 3), (3, 4), (4, 0)].into_iter().enumerate() {
        let scene = Scene::new(seed as u64, SIZE);
        let (own, other) = (waters[from].water, waters[to].water);
        let truth_b = scene.seen_through(&other);
        let exchanged = Waters::new(&own, &other);
        let options = Options::for_model(Model::Exchange).with_max_gain(8.0);
        let fused = fuse(&scene.seen_through(&own), &scene.depth, exchanged, &options).unwrap().image;
        let mut bounded = 0;
        for ((found, truth), z) in fused.pixels().iter().zip(truth_b.pixels()).zip(scene.depth.distances()) {
            for c in 0..3 {
                let gain =
                    (own.attenuation[c].optical_depth(z) - other.attenuation[c].optical_depth(z)).exp();
                if gain > options.max_gain {
                    bounded += 1;
                } else {
                    let truth = truth[c].clamp(0.0, 1.0);
                    assert!((found[c] - truth).abs() < 1e-5, "{} is not {truth} at {z}", found[c]);
                }
            }
        }
        // In thick water the bound acts on what is far; a test of such values alone would be none.
        assert!(bounded < fused.as_raw().len() / 2, "{bounded}");
    }
}

#[test]
fn bytes_are_the_exact_fusion_rounded_once() {
    let waters = waters();
    let scene = Scene::new(5, SIZE);
    let (own, other) = (waters[1].water, waters[0].water);
    let bytes: Image<u8> = scene.seen_through(&own).convert();
    for &model in Model::ALL {
        let options = Options::for_model(model);
        let exact =
            fuse(&bytes.convert::<f32>(), &scene.depth, Waters::new(&own, &other), &options).unwrap().image;
        let fused = fuse(&bytes, &scene.depth, Waters::new(&own, &other), &options).unwrap().image;
        for (byte, exact) in fused.as_raw().iter().zip(exact.as_raw()) {
            assert!((f32::from(*byte) - 255.0 * exact).abs() <= 0.5 + 1e-3);
        }
    }
}

#[test]
fn clipping_is_counted() {
    let z = DepthMap::from_levels(2, 1, vec![255, 255]).unwrap();
    let content = Image::<u8>::from_raw(2, 1, vec![250, 100, 100, 100, 100, 100]).unwrap();
    let dark = Waterbody {
        veiling_light: VeilingLight::<Encoded>::new([0.0; 3]),
        backscatter_coefficient: [50.0; 3],
        attenuation: waters()[0].water.attenuation,
    };
    let bright = Waterbody { veiling_light: VeilingLight::new([0.5, 0.0, 0.0]), ..dark };
    let fused =
        fuse(&content, &z, Waters::new(&dark, &bright), &Options::for_model(Model::Physical)).unwrap();
    assert_eq!(fused.clipping.values, [1, 0, 0]);
    assert_eq!(fused.image.pixels(), [[255, 100, 100], [228, 100, 100]]);
}

#[test]
fn sizes_that_differ_are_an_error() {
    let content = picture(1, &waters()[0]);
    let z = DepthMap::from_levels(1, 1, vec![0]).unwrap();
    assert!(matches!(
        waterbody::estimate::<Encoded>(&content, &z, &EstimateOptions::default()),
        Err(ImageError::Mismatch { left: (96, 64), right: (1, 1) })
    ));
    let water = waters()[0].water;
    assert!(fuse(&content, &z, Waters::new(&water, &water), &Options::default()).is_err());
}

#[test]
fn an_image_of_one_pixel_has_water_too() {
    let content = Image::<u8>::from_raw(1, 1, vec![10, 20, 30]).unwrap();
    let (z, water) = estimated(&content);
    assert!(water.backscatter_coefficient.iter().all(|b| b.is_finite() && *b >= 0.0));
    assert!(fuse(&content, &z, Waters::new(&water, &water), &Options::default()).is_ok());
}

#[test]
fn with_depth_given_the_veil_is_read_and_the_growth_where_it_shows() {
    // A first bound, not the last word. Where the veil is hardly brighter than a shadow, its growth with
    // distance can hardly be seen, and the estimate leans on the expected one: red in blue, all of deep water.
    for named in waters() {
        for seed in 0..4 {
            let scene = Scene::new(seed, SIZE);
            let image: Image<u8> = scene.seen_through(&named.water).convert();
            let found = waterbody::estimate::<Encoded>(&image, &scene.depth, &EstimateOptions::default())
                .unwrap()
                .water;
            for c in 0..3 {
                let (truth, read) = (named.water.veiling_light.rgb()[c], found.veiling_light.rgb()[c]);
                assert!((truth - read).abs() < 0.01, "{} {seed} {c}: {read} for {truth}", named.name);
                let growth = found.backscatter_coefficient[c] / named.water.backscatter_coefficient[c];
                let shows = truth > 0.25;
                assert!(!shows || (0.5..2.0).contains(&growth), "{} {seed} {c}: β_B x {growth}", named.name);
            }
        }
    }
}

#[test]
fn the_unit_of_depth_cancels_from_estimation_to_image() {
    let waters = waters();
    let scene = Scene::new(2, SIZE);
    let image: Image<u8> = scene.seen_through(&waters[1].water).convert();
    let made = |unit: f32| {
        let distances = scene.depth.distances().into_iter().map(|z| z * unit).collect();
        let z = DepthMap::from_distances(SIZE.width, SIZE.height, DepthKind::Metres, distances).unwrap();
        let own = waterbody::estimate::<Encoded>(&image, &z, &EstimateOptions::default()).unwrap().water;
        let exchanged = Waters::new(&own, &waters[0].water);
        let fused = fuse(&image, &z, exchanged, &Options::for_model(Model::Physical)).unwrap().image;
        (fused, restore(&image, &z, &own, &Default::default()).unwrap())
    };
    let (fused, restored) = made(1.0);
    for unit in [1000.0, 0.37] {
        let (other_fused, other_restored) = made(unit);
        let steps = fused.as_raw().iter().zip(other_fused.as_raw()).map(|(a, b)| a.abs_diff(*b)).max();
        assert!(steps <= Some(1), "an image differs by {steps:?} in units of {unit}");
        let worst = restored.as_raw().iter().zip(other_restored.as_raw()).map(|(a, b)| (a - b).abs());
        assert!(worst.fold(0.0, f32::max) < 0.02, "restoration knows the unit {unit}");
    }
}

#[test]
fn linear_light_has_its_own_water_and_its_own_truth() {
    let waters = waters();
    let scene = Scene::new(1, SIZE);
    let image: Image<u8> = scene.seen_through(&waters[0].water).convert();
    let encoded =
        waterbody::estimate::<Encoded>(&image, &scene.depth, &EstimateOptions::default()).unwrap().water;
    let linear =
        waterbody::estimate::<Linear>(&image, &scene.depth, &EstimateOptions::default()).unwrap().water;
    for c in 0..3 {
        let converted = Linear::from_encoded(encoded.veiling_light.rgb()[c]);
        assert!((linear.veiling_light.rgb()[c] - converted).abs() < 1e-6);
    }
    let brighter = Waterbody { veiling_light: VeilingLight::new([0.1, 0.3, 0.5]), ..linear };
    let content = image.to_linear();
    let exchanged = Waters::new(&linear, &brighter);
    let fused = fuse(&content, &scene.depth, exchanged, &Options::for_model(Model::Physical)).unwrap().image;
    // Open water is exchanged but for what the fitted curve leaves of it at that distance, in linear light.
    let left = linear.depth_factor(OPEN_WATER)[2];
    assert!(left < 0.01, "{left}");
    let expected = content.pixels()[0][2] + (1.0 - left) * (0.5 - linear.veiling_light.rgb()[2]);
    assert!((fused.pixels()[0][2] - expected).abs() < 1e-5);
}
