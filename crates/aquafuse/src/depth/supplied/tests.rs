use super::*;
use crate::image::Image;
use proptest::prelude::*;

const SIDE: usize = 24;

/// An image whose colour depth rises with the row from the bottom, and the level of each pixel.
fn image() -> Image<u8> {
    let pixel = |y: usize| [200 - 8 * y as u8, 100, 100 + 4 * y as u8];
    let rows = (0..SIDE).flat_map(|y| [pixel(SIDE - 1 - y); SIDE].concat());
    Image::from_raw(SIDE, SIDE, rows.collect()).unwrap()
}

/// Distances that rise with it, from 1.
fn distances() -> Vec<f32> {
    (0..SIDE * SIDE).map(|i| 1.0 + (SIDE - 1 - i / SIDE) as f32 / 4.0).collect()
}

fn seen(values: Vec<f32>, kind: SuppliedKind) -> Result<SuppliedDepth, SuppliedError> {
    Supplied::new(SIDE, SIDE, values, kind).unwrap().seen_with(&image(), TopEdge::First)
}

fn kind() -> impl Strategy<Value = SuppliedKind> {
    prop::sample::select(SuppliedKind::ALL)
}

/// Values that any file may hold, valid or not.
fn anything() -> impl Strategy<Value = Vec<f32>> {
    prop::collection::vec(any::<f32>(), SIDE * SIDE)
}

/// Valid values of any kind.
fn valid_values() -> impl Strategy<Value = Vec<f32>> {
    prop::collection::vec(0.001..1.0_f32, SIDE * SIDE)
}

proptest! {
    #[test]
    fn whatever_the_values_are_the_answer_is_depth_or_an_error(values in anything(), kind in kind()) {
        if let Ok(found) = seen(values, kind) {
            prop_assert!(found.depth.distances().iter().all(|z| z.is_finite() && *z >= 0.0));
        }
    }

    #[test]
    fn labels_are_the_valid_distances_of_fusion_and_nothing_else(values in anything(), kind in kind()) {
        let map = Supplied::new(SIDE, SIDE, values.clone(), kind).unwrap();
        let Ok(labels) = map.labels(&image()) else { return Ok(()) };
        let invalid = values.iter().map(|&value| !kind.is_valid(value));
        prop_assert!(labels.iter().zip(invalid).all(|(label, invalid)| label.is_nan() == invalid));
        let Ok(seen) = map.seen_with(&image(), TopEdge::First) else { return Ok(()) };
        let known = labels.iter().zip(seen.depth.distances()).filter(|(label, _)| !label.is_nan());
        prop_assert!(known.into_iter().all(|(label, z)| *label == z));
    }

    #[test]
    fn every_kind_keeps_the_order_it_declares(values in valid_values(), kind in kind()) {
        let z = seen(values.clone(), kind).unwrap().depth.distances();
        let nearer_is_larger = matches!(kind, SuppliedKind::Inverse | SuppliedKind::Disparity);
        for (a, b) in values.windows(2).map(|pair| (pair[0], pair[1])).zip(z.windows(2)).map(|(v, z)| {
            if (v.0 < v.1) == nearer_is_larger { (z[0], z[1]) } else { (z[1], z[0]) }
        }) {
            prop_assert!(a >= b, "{a} < {b}");
        }
    }

    #[test]
    fn metres_and_millimetres_are_one_map(values in valid_values(), holes in prop::collection::vec(any::<bool>(), SIDE * SIDE)) {
        let metres: Vec<f32> = values.iter().zip(&holes).map(|(z, hole)| if *hole { 0.0 } else { *z }).collect();
        let millimetres = metres.iter().map(|z| z * 1000.0).collect();
        let (a, b) = (seen(metres, SuppliedKind::Metres).unwrap(), seen(millimetres, SuppliedKind::Millimetres).unwrap());
        for (a, b) in a.depth.distances().iter().zip(b.depth.distances()) {
            prop_assert!((a - b).abs() <= 1e-5 * a, "{a} {b}");
        }
    }

    #[test]
    fn the_scale_of_what_has_none_cancels(
        values in valid_values(), power in -8..8_i32, shift in 0.0..4.0_f32,
    ) {
        let scale = 2.0_f32.powi(power);
        let z = |law: &dyn Fn(f32) -> f32, kind| {
            seen(values.iter().map(|&v| law(v)).collect(), kind).unwrap().depth.distances()
        };
        // Powers of two change no digit.
        prop_assert_eq!(z(&|v| v, SuppliedKind::Disparity), z(&|v| v * scale, SuppliedKind::Disparity));
        let shifted = z(&|v| v * scale + shift * scale, SuppliedKind::Inverse);
        for (a, b) in z(&|v| v, SuppliedKind::Inverse).iter().zip(shifted) {
            prop_assert!((a - b).abs() < 1e-4, "{a} {b}");
        }
    }

    #[test]
    fn the_unit_of_holes_cancels(
        holes in prop::collection::vec(0..4_u8, SIDE * SIDE), power in -8..8_i32,
    ) {
        let scale = 2.0_f32.powi(power);
        let punched = |scale: f32| -> Vec<f32> {
            distances().iter().zip(&holes).map(|(z, hole)| if *hole == 0 { f32::NAN } else { z * scale }).collect()
        };
        let (one, scaled) = (seen(punched(1.0), SuppliedKind::Metres).unwrap(), seen(punched(scale), SuppliedKind::Metres).unwrap());
        prop_assert_eq!(one.report, scaled.report);
        for (a, b) in one.depth.distances().iter().zip(scaled.depth.distances()) {
            prop_assert!((a * scale - b).abs() <= 1e-6 * b, "{a} {b}");
        }
    }

    #[test]
    fn what_was_measured_is_not_touched(holes in prop::collection::vec(0..4_u8, SIDE * SIDE)) {
        let values: Vec<f32> =
            distances().iter().zip(&holes).map(|(z, hole)| if *hole == 0 { f32::INFINITY } else { *z }).collect();
        let found = seen(values.clone(), SuppliedKind::Metres).unwrap();
        prop_assert_eq!(found.report.invalid, holes.iter().filter(|hole| **hole == 0).count() as u64);
        for (given, z) in values.iter().zip(found.depth.distances()) {
            prop_assert!(!given.is_finite() || *given == z);
        }
    }

    #[test]
    fn holes_lie_within_what_was_measured_or_beyond_as_open_water(
        values in valid_values(), holes in prop::collection::vec(any::<bool>(), SIDE * SIDE),
    ) {
        let punched: Vec<f32> = values.iter().zip(&holes).map(|(z, hole)| if *hole { -1.0 } else { *z }).collect();
        let z = seen(punched, SuppliedKind::Relative).unwrap().depth;
        prop_assert!(z.distances().iter().all(|z| (0.0..=1.0).contains(z)));
        let measured = z.measured_to();
        prop_assert_eq!(measured.is_finite(), holes.contains(&true));
    }
}

#[test]
fn a_map_keeps_more_than_twelve_bits() {
    let values: Vec<f32> = (0..SIDE * SIDE).map(|i| 1.0 + i as f32).collect();
    let map = Supplied::new(SIDE, SIDE, values, SuppliedKind::Relative).unwrap().with_full_range(65535.0);
    let z = map.seen_with(&image(), TopEdge::First).unwrap().depth.distances();
    assert!(z.windows(2).all(|pair| pair[0] < pair[1]));
    assert_eq!(z[65], 66.0 / 65535.0);
}

#[test]
fn open_water_without_depth_is_farther_than_all_that_was_measured() {
    let mut values = distances();
    // The upper third, as structure from motion leaves it.
    values[..SIDE * SIDE / 3].fill(0.0);
    let z = seen(values, SuppliedKind::Metres).unwrap().depth;
    let farthest = z.at(0, SIDE / 3);
    assert!(z.at(0, 0) >= 1.9 * farthest, "{} {farthest}", z.at(0, 0));
    assert!((0..SIDE / 3).all(|y| z.at(5, y) >= 0.95 * farthest));
}

#[test]
fn open_water_has_a_share_where_nothing_was_measured_and_none_where_it_was() {
    use crate::image::Encoded;
    use crate::truth::{Scene, Size, waters};
    use crate::waterbody::estimate_with_share;
    let scene = Scene::new(1, Size { width: 96, height: 64 });
    let image: Image<u8> = scene.seen_through(&waters()[0].water).convert();
    let holes =
        scene.depth.distances().into_iter().enumerate().map(|(i, z)| if i / 96 < 20 { 0.0 } else { z });
    let map = Supplied::new(96, 64, holes.collect(), SuppliedKind::Metres).unwrap();
    let z = map.seen_with(&image, TopEdge::First).unwrap().depth;
    let (_, share) = estimate_with_share::<Encoded>(&image, &z, &Default::default()).unwrap();
    let at = |x: usize, y: usize| share.at(x, y, image.pixels()[96 * y + x].map(|v| f32::from(v) / 255.0));
    assert!(at(48, 2) > 0.5, "{}", at(48, 2));
    assert!((40..64).all(|y| at(48, y) < 0.05));
}

#[test]
fn holes_on_the_ground_get_the_distance_of_their_colour() {
    let mut values = distances();
    // Lower down all colours are as near as can be.
    let hole = 8 * SIDE + 3;
    let removed = std::mem::replace(&mut values[hole], f32::NAN);
    let found = seen(values, SuppliedKind::Metres).unwrap();
    assert!((found.depth.at(3, 8) - removed).abs() < 0.3, "{} {removed}", found.depth.at(3, 8));
    assert_eq!(found.report.invalid, 1);
}

#[test]
fn nothing_is_told_from_next_to_nothing() {
    let mut values = vec![0.0; SIDE * SIDE];
    values[..99].copy_from_slice(&distances()[..99]);
    let error = seen(values, SuppliedKind::Metres).unwrap_err();
    assert_eq!(error, SuppliedError::TooFewValid { valid: 99, pixels: 576, least: 100 });
}

#[test]
fn zero_is_valid_where_it_means_something() {
    for (kind, valid) in SuppliedKind::ALL.iter().copied().zip([false, false, true, true, false]) {
        assert_eq!((kind.is_valid(0.0), kind.is_valid(-0.0)), (valid, valid), "{kind:?}");
        assert!(
            [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1e-9].iter().all(|value| !kind.is_valid(*value))
        );
    }
}

#[test]
fn relative_depth_above_one_and_a_map_without_order_are_refused() {
    let mut values = vec![0.5; SIDE * SIDE];
    values[SIDE + 2] = 1.5;
    let error = seen(values.clone(), SuppliedKind::Relative).unwrap_err();
    assert_eq!(error, SuppliedError::AboveOne { x: 2, y: 1, value: 1.5 });
    values[SIDE + 2] = 0.5;
    assert_eq!(seen(values.clone(), SuppliedKind::Inverse).unwrap_err(), SuppliedError::Flat { value: 0.5 });
    assert!(seen(values, SuppliedKind::Relative).unwrap().report.agreement.is_none());
}

#[test]
fn a_map_of_another_size_is_refused() {
    let map = Supplied::new(2, 3, vec![1.0; 6], SuppliedKind::Metres).unwrap();
    let image = Image::from_raw(3, 2, vec![9; 18]).unwrap();
    let said = map.seen_with(&image, TopEdge::First).unwrap_err().to_string();
    assert_eq!(said, "the map is 2x3, the image 3x2; turned by 90° it would fit");
}

#[test]
fn a_map_turned_round_is_told_whichever_edge_is_up() {
    let turned: Vec<f32> = distances().iter().map(|z| 20.0 - z).collect();
    let report = |values: &[f32], top| {
        let map = Supplied::new(SIDE, SIDE, values.to_vec(), SuppliedKind::Metres).unwrap();
        map.seen_with(&image(), top).unwrap().report
    };
    assert!(!report(&distances(), TopEdge::First).looks_inverted());
    assert!(report(&turned, TopEdge::First).looks_inverted());
    // Seen the other way up, height speaks for the turned map and outweighs colour.
    assert!(report(&distances(), TopEdge::Last).looks_inverted());
    assert!(!report(&turned, TopEdge::Last).looks_inverted());
}

#[test]
fn a_map_without_any_valid_value_has_no_labels_and_is_no_depth() {
    for &kind in SuppliedKind::ALL {
        let map = Supplied::new(SIDE, SIDE, vec![f32::NAN; SIDE * SIDE], kind).unwrap();
        assert!(map.labels(&image()).unwrap().iter().all(|label| label.is_nan()));
        assert!(matches!(map.seen_with(&image(), TopEdge::First), Err(SuppliedError::TooFewValid { .. })));
    }
}
