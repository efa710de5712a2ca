use super::*;
use crate::depth::DepthModel;
use crate::depth::median;
use crate::image::Image;
use crate::truth::{Scene, Size, waters};
use proptest::prelude::*;

/// A known model in the normal form: d(R = 1, M = 0) = 0, d(0, 1) = 1.
const KNOWN: Eq3 = Eq3::OURS;

/// An image with the colours of a place seen through the water of this number.
fn picture(seed: u64) -> Image<u8> {
    let waters = waters();
    let water = &waters[seed as usize % waters.len()].water;
    Scene::new(seed, Size { width: 96, height: 64 }).seen_through(water).convert()
}

/// What a model says of each pixel, its colours filtered first.
fn depth_of(image: &Image<u8>, model: &Eq3) -> Vec<f32> {
    let plane = |of: fn(&[u8; 3]) -> u8| {
        let bytes: Vec<u8> = image.pixels().iter().map(of).collect();
        median::filtered(image.width(), &bytes)
    };
    let unit = |byte: u8| f64::from(byte) / 255.0;
    let (red, max) = (plane(|&[r, _, _]| r), plane(|&[_, g, b]| g.max(b)));
    red.into_iter().zip(max).map(|(r, m)| model.depth(unit(r), unit(m)) as f32).collect()
}

/// Even numbers in [0, 1), the same each time.
fn even(seed: u64) -> impl Iterator<Item = f32> {
    (0_u64..).map(move |i| {
        let mut x = (seed << 32 | i).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        x = (x ^ (x >> 31)).wrapping_mul(0xD6E8_FEB8_6659_FD93);
        ((x >> 40) as f32) / (1_u64 << 24) as f32
    })
}

/// The largest difference of two models over the colours that images hold.
fn apart(a: &Eq3, b: &Eq3) -> f64 {
    let colours = (0..=10).flat_map(|r| (r..=10).map(move |m| (f64::from(r) / 10.0, f64::from(m) / 10.0)));
    colours.map(|(r, m)| (a.depth(r, m) - b.depth(r, m)).abs()).fold(0.0, f64::max)
}

fn fitted(options: Options, label: impl Fn(u64, Vec<f32>) -> Vec<f32>) -> Fit {
    let mut fitter = Fitter::new(options);
    for seed in 0..10 {
        let image = picture(seed);
        let labels = label(seed, depth_of(&image, &KNOWN));
        fitter.add(&image, &labels).unwrap();
    }
    fitter.solve().unwrap()
}

#[test]
fn a_known_model_is_found_again_from_clean_labels() {
    for scale in [Scale::Shared, Scale::PerImage] {
        let fit = fitted(Options { scale, ..Options::default() }, |_, z| z);
        assert!(apart(&fit.eq3, &KNOWN) < 0.01, "{scale:?}: {fit:?}");
        assert!(
            (fit.eq3.mu[2] - KNOWN.mu[2]).abs() < 0.3 && (fit.eq3.mu[4] - KNOWN.mu[4]).abs() < 0.3,
            "{fit:?}"
        );
        // Smooth open water falls into few cells, and equal ranks there cost a little.
        assert!(fit.rank_score > 0.95 && fit.doubts.is_empty(), "{fit:?}");
        assert!(fit.starts.iter().all(|start| start.reached == fit.starts[0].reached), "{fit:?}");
    }
}

#[test]
fn noise_is_averaged_out() {
    let fit = fitted(Options::default(), |seed, z| {
        z.iter().zip(even(seed)).map(|(z, noise)| z + 0.2 * (noise - 0.5)).collect()
    });
    assert!(apart(&fit.eq3, &KNOWN) < 0.04, "{fit:?}");
}

#[test]
fn a_scale_and_a_shift_of_each_image_change_nothing() {
    let of_their_own = |seed: u64, z: Vec<f32>| -> Vec<f32> {
        z.iter().map(|z| (1.0 + seed as f32) * z + 10.0 * (seed % 3) as f32).collect()
    };
    let fit = fitted(Options::default(), of_their_own);
    assert!(apart(&fit.eq3, &KNOWN) < 0.01, "{fit:?}");
    // One scale for all cannot know that: with a milder mixture it is far off.
    let mild = |seed: u64, z: Vec<f32>| z.iter().map(|z| (1.0 + 0.2 * seed as f32) * z).collect();
    let shared = fitted(Options { scale: Scale::Shared, ..Options::default() }, mild);
    assert!(apart(&shared.eq3, &KNOWN) > 0.05, "{shared:?}");
}

#[test]
fn a_fifth_of_wrong_labels_hardly_moves_the_fit() {
    // Wrong pixels here and there.
    let scattered = fitted(Options::default(), |seed, z| {
        z.iter().zip(even(seed)).map(|(&z, chance)| if chance < 0.2 { 5.0 } else { z }).collect()
    });
    assert!(apart(&scattered.eq3, &KNOWN) < 0.03, "{scattered:?}");
    // A block of each image that is wrong as a whole, a fifth of it.
    let shifted = |seed: u64, z: Vec<f32>| -> Vec<f32> {
        let (left, top) = (7 * seed as usize % 53, 5 * seed as usize % 35);
        let inside = |i: usize| (left..left + 43).contains(&(i % 96)) && (top..top + 28).contains(&(i / 96));
        z.iter().enumerate().map(|(i, &z)| if inside(i) { z + 1.0 } else { z }).collect()
    };
    let robust = apart(&fitted(Options::default(), shifted).eq3, &KNOWN);
    let squares = apart(&fitted(Options { huber: 1e9, ..Options::default() }, shifted).eq3, &KNOWN);
    assert!(robust < 0.1 && robust < 0.7 * squares, "{robust} and {squares}");
}

#[test]
fn the_order_of_labels_is_learnt_whatever_their_unit() {
    let with = |label: fn(f32) -> f32| {
        let options = Options { target: Target::Order, ..Options::default() };
        fitted(options, |_, z| z.into_iter().map(label).collect())
    };
    let (even, bent) = (with(|z| z), with(|z| 3.0 + (4.0 * z).exp()));
    // Rounding makes a few labels equal that were not.
    assert!(apart(&even.eq3, &bent.eq3) < 1e-3 && (even.rank_score - bent.rank_score).abs() < 1e-6);
    assert!(even.rank_score > 0.95, "{even:?}");
}

#[test]
fn an_image_in_two_halves_counts_as_one() {
    let weighted = |copies: &[f64]| {
        let mut fitter = Fitter::default();
        for seed in 0..3 {
            let image = picture(seed);
            let labels: Vec<f32> =
                depth_of(&image, &KNOWN).iter().zip(even(seed)).map(|(z, n)| z + n).collect();
            for &weight in if seed == 0 { copies } else { &[1.0] } {
                fitter.add_weighted(&image, &labels, weight).unwrap();
            }
        }
        fitter.solve().unwrap()
    };
    let (whole, halves, twice) = (weighted(&[1.0]), weighted(&[0.5, 0.5]), weighted(&[1.0, 1.0]));
    assert!(apart(&whole.eq3, &halves.eq3) < 1e-3 && apart(&whole.eq3, &twice.eq3) > 1e-3);
}

#[test]
fn the_order_of_images_changes_no_bit() {
    let mut fitters = [Fitter::default(), Fitter::default(), Fitter::default()];
    let orders: [&[u64]; 2] = [&[0, 1, 2, 3, 4], &[3, 0, 4, 2, 1]];
    for (fitter, order) in fitters.iter_mut().zip(orders) {
        for &seed in order {
            let image = picture(seed);
            let labels: Vec<f32> =
                depth_of(&image, &KNOWN).iter().zip(even(seed)).map(|(z, noise)| z + 0.3 * noise).collect();
            fitter.add(&image, &labels).unwrap();
        }
    }
    let [one, other, mut merged] = fitters;
    merged.merge(one.clone());
    let (one, other, merged) = (one.solve().unwrap(), other.solve().unwrap(), merged.solve().unwrap());
    assert_eq!((one.eq3, one.loss, &one.starts), (other.eq3, other.loss, &other.starts));
    let reordered: Vec<f64> = orders[1].iter().map(|&seed| one.rank_scores[seed as usize]).collect();
    assert_eq!(reordered, other.rank_scores);
    assert_eq!(one, merged);
}

#[test]
fn what_is_kept_does_not_grow_with_the_pixels() {
    for size in [8, 64, 1024] {
        let samples: Vec<u8> = even(1).take(3 * size * size).map(|value| (256.0 * value) as u8).collect();
        let mut fitter = Fitter::default();
        fitter
            .add(
                &Image::<u8>::from_raw(size, size, samples).unwrap(),
                &even(2).take(size * size).collect::<Vec<_>>(),
            )
            .unwrap();
        let kept = &fitter.images[0].cells;
        assert!(kept.len() <= 4096 && kept.capacity() <= 4096 && size_of_val(&kept[0]) == 20);
    }
}

#[test]
fn labels_of_a_linear_model_are_reported_and_their_coefficients_bounded() {
    let mut fitter = Fitter::default();
    for seed in 0..5 {
        let image = picture(seed);
        let levels = DepthModel::Ulap.estimate_unfiltered(&image);
        let levels = median::filtered(image.width(), levels.levels().unwrap());
        let labels: Vec<f32> = levels.iter().map(|&level| f32::from(level) / 255.0).collect();
        fitter.add(&image, &labels).unwrap();
    }
    let fit = fitter.solve().unwrap();
    assert_eq!(fit.doubts, [Doubt::Straight { red: true }, Doubt::Straight { red: false }], "{fit:?}");
    assert!(fit.eq3.mu.iter().all(|mu| mu.abs() < 30.0) && fit.rank_score > 0.9, "{fit:?}");
}

#[test]
fn labels_the_wrong_way_round_are_refused() {
    let mut fitter = Fitter::default();
    assert_eq!(fitter.solve(), Err(FitError::NoImages));
    let image = picture(1);
    let nearness: Vec<f32> = depth_of(&image, &KNOWN).iter().map(|z| 1.0 - z).collect();
    fitter.add(&image, &nearness).unwrap();
    assert_eq!(fitter.solve(), Err(FitError::Backwards { images: 1 }));
    // Among right ones, it is told.
    for seed in 2..5 {
        let image = picture(seed);
        fitter.add(&image, &depth_of(&image, &KNOWN)).unwrap();
    }
    assert_eq!(fitter.solve().unwrap().doubts, [Doubt::Backwards { images: 1 }]);
}

#[test]
fn labels_that_say_nothing_are_refused() {
    let image = picture(1);
    let mut fitter = Fitter::default();
    assert!(matches!(fitter.add(&image, &[1.0; 4]), Err(LabelError::Size(_))));
    let mut labels = vec![f32::NAN; image.pixels().len()];
    labels[7] = 3.0;
    assert_eq!(fitter.add(&image, &labels), Err(LabelError::Few { found: 1, least: 30 }));
    labels.fill(2.0);
    assert_eq!(fitter.add(&image, &labels), Err(LabelError::Flat { value: 2.0 }));
    assert_eq!(fitter.images(), 0);
}

#[test]
fn the_rank_score_of_the_cells_is_that_of_the_pixels() {
    let image = picture(3);
    let scene = Scene::new(3, Size { width: 96, height: 64 });
    let labels = scene.depth.distances();
    let mut fitter = Fitter::default();
    fitter.add(&image, &labels).unwrap();
    let plain = crate::metrics::spearman(&depth_of(&image, &KNOWN), &labels).unwrap();
    let [found] = fitter.rank_scores(&KNOWN)[..] else { panic!("one image has one score") };
    assert!((found - plain).abs() < 0.01, "{found} and {plain}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]
    #[test]
    fn whatever_the_labels_the_laws_hold_and_depth_spans_its_range(
        labels in prop::collection::vec(-3.0..900.0_f32, 400),
        samples in prop::collection::vec(any::<u8>(), 1200),
    ) {
        let mut fitter = Fitter::default();
        fitter.add(&Image::<u8>::from_raw(20, 20, samples).unwrap(), &labels).unwrap();
        if let Ok(fit) = fitter.solve() {
            let [_, mu1, mu2, mu3, mu4] = fit.eq3.mu;
            prop_assert!(mu1 * mu2 <= 0.0 && mu3 * mu4 >= 0.0);
            prop_assert!(fit.eq3.depth(1.0, 0.0).abs() < 1e-9 && (fit.eq3.depth(0.0, 1.0) - 1.0).abs() < 1e-9);
        }
    }
}
