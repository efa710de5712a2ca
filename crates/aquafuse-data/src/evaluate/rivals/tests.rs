use super::*;
use proptest::prelude::*;

fn image(pixels: &[[u8; 3]]) -> Image<u8> {
    Image::from_raw(pixels.len(), 1, pixels.concat()).unwrap()
}

fn transferred(rival: Rival, content: &Image<u8>, reference: &Image<u8>) -> Vec<[f32; 3]> {
    rival.transfer(content, &Palette::of(content), &Palette::of(reference))
}

fn pixels() -> impl Strategy<Value = Vec<[u8; 3]>> {
    prop::collection::vec(any::<[u8; 3]>(), 12..60)
}

fn mean(values: &[[f32; 3]]) -> [f64; 3] {
    std::array::from_fn(|c| values.iter().map(|v| f64::from(v[c])).sum::<f64>() / values.len() as f64)
}

fn covariance(values: &[[f32; 3]]) -> [[f64; 3]; 3] {
    let mean = mean(values);
    let off = |v: &[f32; 3], c: usize| f64::from(v[c]) - mean[c];
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            values.iter().map(|v| off(v, i) * off(v, j)).sum::<f64>() / values.len() as f64
        })
    })
}

fn units(image: &Image<u8>) -> Vec<[f32; 3]> {
    image.to_unit().pixels().to_vec()
}

proptest! {
    #[test]
    fn an_image_given_its_own_colours_is_itself(pixels in pixels()) {
        let image = image(&pixels);
        for rival in Rival::ALL {
            for (made, pixel) in transferred(rival, &image, &image).iter().zip(units(&image)) {
                for c in 0..3 {
                    // Reinhard's two matrices are each other's inverse to two digits, and black is half a step there.
                    let most = if rival == Rival::Reinhard { 0.01 } else { 1e-6 };
                    prop_assert!((made[c] - pixel[c]).abs() < most, "{} makes {made:?} of {pixel:?}", rival.name());
                }
            }
        }
    }

    #[test]
    fn monge_kantorovich_maps_mean_and_covariance_exactly(content in pixels(), reference in pixels()) {
        let (content, reference) = (image(&content), image(&reference));
        let (made, wanted) = (transferred(Rival::MongeKantorovich, &content, &reference), units(&reference));
        let (mean_made, mean_wanted) = (mean(&made), mean(&wanted));
        let (spread, expected) = (covariance(&made), covariance(&wanted));
        for i in 0..3 {
            prop_assert!((mean_made[i] - mean_wanted[i]).abs() < 1e-5);
            for j in 0..3 {
                prop_assert!((spread[i][j] - expected[i][j]).abs() < 1e-4, "{spread:?} is not {expected:?}");
            }
        }
    }

    #[test]
    fn monge_kantorovich_is_the_map_of_least_effort(content in pixels(), reference in pixels()) {
        // A linear map of least effort is symmetric and turns nothing round: pixels move along with their colour.
        let (content, reference) = (image(&content), image(&reference));
        let made = transferred(Rival::MongeKantorovich, &content, &reference);
        let (before, from, to) = (units(&content), mean(&units(&content)), mean(&made));
        for (a, b) in before.iter().zip(&made) {
            let along: f64 =
                (0..3).map(|c| (f64::from(a[c]) - from[c]) * (f64::from(b[c]) - to[c])).sum();
            prop_assert!(along > -1e-6);
        }
    }

    #[test]
    fn histogram_matching_gives_the_distribution_of_the_reference(content in pixels(), repeats in 1..4_usize) {
        // The reference: the content's pixels in another order and colour, each as often as the others.
        let shifted: Vec<[u8; 3]> =
            content.iter().rev().map(|pixel| pixel.map(|value| 255 - value / 3)).collect();
        let (content, reference) = (image(&content), image(&shifted.repeat(repeats)));
        let made = transferred(Rival::Histogram, &content, &reference);
        for c in 0..3 {
            let sorted = |values: Vec<[f32; 3]>| {
                let mut of: Vec<f32> = values.iter().map(|v| v[c]).collect();
                of.sort_by(f32::total_cmp);
                of
            };
            // No pixel lies beyond the reference, and the highest value is as high.
            let (made, wanted) = (sorted(made.clone()), sorted(units(&reference)));
            prop_assert!(made[0] >= wanted[0] - 1e-6);
            prop_assert!((made[made.len() - 1] - wanted[wanted.len() - 1]).abs() < 1e-6);
        }
    }

    #[test]
    fn histogram_matching_maps_each_rank_to_the_value_of_that_rank(content in prop::collection::hash_set(any::<u8>(), 8)) {
        // Eight values that occur once each, of both: ranks answer each other one by one.
        let own: Vec<[u8; 3]> = content.iter().map(|&value| [value; 3]).collect();
        let reference: Vec<[u8; 3]> = (0..8).map(|i| [20 + 25 * i; 3]).collect();
        let made = transferred(Rival::Histogram, &image(&own), &image(&reference));
        for (pixel, made) in own.iter().zip(made) {
            let rank = own.iter().filter(|other| other[0] < pixel[0]).count() as f32;
            prop_assert!((made[0] - (20.0 + 25.0 * rank) / 255.0).abs() < 1e-6);
        }
    }

    #[test]
    fn gray_world_gives_the_mean_of_the_reference(content in pixels(), reference in pixels()) {
        let (content, reference) = (image(&content), image(&reference));
        let (made, wanted) = (mean(&transferred(Rival::GrayWorld, &content, &reference)), mean(&units(&reference)));
        let own = mean(&units(&content));
        for c in (0..3).filter(|&c| own[c] > 0.0) {
            prop_assert!((made[c] - wanted[c]).abs() < 1e-5);
        }
    }
}

#[test]
fn a_flat_image_takes_the_mean_and_nothing_breaks() {
    let (flat, other) = (image(&[[90, 90, 90]; 9]), image(&[[10, 60, 110], [30, 80, 130]]));
    for rival in Rival::ALL {
        for values in [transferred(rival, &flat, &other), transferred(rival, &other, &flat)] {
            assert!(values.as_flattened().iter().all(|value| value.is_finite()), "{}", rival.name());
        }
    }
    let made = transferred(Rival::MongeKantorovich, &flat, &other)[0];
    assert!((0..3).all(|c| (made[c] - [20.0, 70.0, 120.0][c] / 255.0).abs() < 1e-6), "{made:?}");
}
