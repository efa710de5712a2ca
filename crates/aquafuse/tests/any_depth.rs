//! Whatever stands in a depth map, every pixel that comes out is finite and in range.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

use aquafuse::depth::{DepthMap, DepthModel, Supplied, SuppliedKind};
use aquafuse::formation::{RestoreOptions, restore};
use aquafuse::fusion::{Bounded, Gain, Model, Options, fuse};
use aquafuse::image::{Image, TopEdge};
use aquafuse::waterbody::{EstimateOptions, estimate};
use proptest::prelude::*;

const SIZE: (usize, usize) = (12, 9);
const PIXELS: usize = SIZE.0 * SIZE.1;

/// What no camera measures among what one does.
fn distance() -> impl Strategy<Value = f32> {
    prop_oneof![
        4 => 0.0..30.0_f32,
        2 => any::<f32>(),
        1 => prop::sample::select(vec![
            f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, f32::MIN, f32::MIN_POSITIVE, 1e-44, -0.0, 0.0, 1.0, 65535.0,
        ]),
    ]
}

fn images() -> impl Strategy<Value = [Image<u8>; 2]> {
    let image = || prop::collection::vec(any::<u8>(), 3 * PIXELS);
    (image(), image())
        .prop_map(|(a, b)| [a, b].map(|samples| Image::from_raw(SIZE.0, SIZE.1, samples).unwrap()))
}

fn check(content: &Image<u8>, reference: &Image<u8>, depth: &DepthMap) {
    let z = DepthModel::default().estimate(reference);
    let other = estimate(reference, &z, &EstimateOptions::default()).unwrap();
    let own = estimate(content, depth, &EstimateOptions::default()).unwrap();
    let floats = content.to_unit();
    for &model in Model::ALL {
        for gain in [0.0, 1.0, 1e30] {
            let options = Options::for_model(model).with_gain(Gain::new(gain).unwrap());
            let bounded = Bounded::new(&own, &other, options);
            let fused = fuse(&floats, depth, bounded.waters(), &bounded.options).unwrap().image;
            assert!(fused.as_raw().iter().all(|value| (0.0..=1.0).contains(value)), "{}", model.name());
        }
    }
    let clear = restore(&floats, depth, &own.water, &RestoreOptions::default()).unwrap();
    assert!(clear.as_raw().iter().all(|value| value.is_finite()));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn any_supplied_depth_gives_finite_pixels_or_a_named_error(
        [content, reference] in images(),
        values in prop::collection::vec(distance(), PIXELS),
        kind in prop::sample::select(SuppliedKind::ALL),
    ) {
        let supplied = Supplied::new(SIZE.0, SIZE.1, values, kind).unwrap();
        match supplied.seen_with(&content, TopEdge::First) {
            Ok(found) => check(&content, &reference, &found.depth),
            Err(error) => prop_assert!(error.to_string().len() > 10),
        }
    }

    #[test]
    fn any_depth_from_colour_gives_finite_pixels(
        [content, reference] in images(),
        model in prop::sample::select(DepthModel::ALL),
    ) {
        check(&content, &reference, &model.estimate(&content));
        let fine = content.convert::<u16>();
        check(&content, &reference, &model.estimate(&fine));
    }
}
