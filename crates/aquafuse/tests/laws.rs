//! The laws of the method: what must hold for every image, water and setting, before clipping.
//!
//! Each test is one sentence of the design. Changes are compared in floating point, because a law about
//! sums would otherwise be blurred by the rounding of pixels.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

use aquafuse::depth::{DepthKind, DepthMap};
use aquafuse::formation::{RestoreOptions, form, restore};
use aquafuse::fusion::{Gain, Incidence, Model, Options, TransferLaw, Waters, fuse};
use aquafuse::image::Image;
use aquafuse::waterbody::{Attenuation, DepthFactors, VeilingLight, Waterbody};
use proptest::prelude::*;

/// A few roundings of numbers of size 1.
const ROUNDING: f32 = 4.0 * f32::EPSILON;

fn colour() -> impl Strategy<Value = [f32; 3]> {
    prop::array::uniform3(0.0..=1.0_f32)
}

/// β_D curves that are constant, that bend, and that are held from somewhere within the depths tried.
fn attenuation() -> impl Strategy<Value = Attenuation> {
    let weight = || 0.01..1.5_f32;
    (weight(), 0.0..1.0_f32, weight(), 0.0..1.0_f32, 0.5..8.0_f32).prop_map(|(mu5, fall, mu7, rise, end)| {
        // Falling no faster than e^(-z / end), the optical depth never falls.
        Attenuation::new([mu5, -fall / end, mu7, 0.1 * rise / end], end).unwrap()
    })
}

fn waterbody() -> impl Strategy<Value = Waterbody> {
    (colour(), prop::array::uniform3(0.01..3.0_f32), prop::array::uniform3(attenuation())).prop_map(
        |(veil, backscatter_coefficient, attenuation)| Waterbody {
            veiling_light: VeilingLight::new(veil),
            backscatter_coefficient,
            attenuation,
        },
    )
}

/// Tables of F, which never rise.
fn depth_factors() -> impl Strategy<Value = DepthFactors> {
    prop::collection::vec((0.01..0.5_f32, colour()), 1..=32).prop_map(|steps| {
        let (mut z, mut least) = (0.0, [1.0_f32; 3]);
        let knots: Vec<_> = steps
            .into_iter()
            .map(|(step, factor)| {
                z += step;
                least = [0, 1, 2].map(|c| least[c].min(factor[c]));
                (z, least)
            })
            .collect();
        DepthFactors::from_knots(&knots).unwrap()
    })
}

fn model() -> impl Strategy<Value = Model> {
    prop::sample::select(Model::ALL)
}

/// A model that adds to all pixels of one depth the same.
fn shift_model() -> impl Strategy<Value = Model> {
    let shifts: Vec<Model> = Model::ALL.iter().copied().filter(|model| model.is_shift()).collect();
    prop::sample::select(shifts)
}

fn degrees() -> impl Strategy<Value = f32> {
    0.0..=90.0_f32
}

fn options(model: Model, degrees: f32, gain: f32) -> Options {
    let incidence = Incidence::from_degrees(degrees).unwrap();
    Options::for_model(model).with_incidence(incidence).with_gain(Gain::new(gain).unwrap())
}

fn law(content: &Waterbody, reference: &Waterbody, options: &Options) -> TransferLaw {
    TransferLaw::new(Waters::new(content, reference), options)
}

/// What a model that is a shift adds at `z`.
fn shift(content: &Waterbody, reference: &Waterbody, options: &Options, z: f32) -> [f32; 3] {
    let change = law(content, reference, options).at(z);
    assert_eq!(change.gain, [1.0; 3]);
    change.offset
}

fn with_veil(water: &Waterbody, veil: [f32; 3]) -> Waterbody {
    Waterbody { veiling_light: VeilingLight::new(veil), ..*water }
}

proptest! {
    #[test]
    fn at_ninety_degrees_nothing_is_fused(
        scene in waterbody(), other in waterbody(), model in model(), gain in 0.0..4.0_f32, z in 0.0..10.0_f32,
        seen in colour(),
    ) {
        prop_assert_eq!(law(&scene, &other, &options(model, 90.0, gain)).at(z).of(seen), seen);
    }

    #[test]
    fn ones_own_water_changes_nothing(
        scene in waterbody(), model in model(), degrees in degrees(), z in 0.0..1e4_f32, seen in colour(),
    ) {
        prop_assert_eq!(law(&scene, &scene, &options(model, degrees, 1.0)).at(z).of(seen), seen);
    }

    #[test]
    fn at_the_camera_nothing_changes(
        scene in waterbody(), other in waterbody(), model in model(), degrees in degrees(), gain in 0.0..4.0_f32,
        seen in colour(),
    ) {
        prop_assert_eq!(law(&scene, &other, &options(model, degrees, gain)).at(0.0).of(seen), seen);
    }

    #[test]
    fn the_shift_is_affine_in_the_gain(
        scene in waterbody(), other in waterbody(), model in shift_model(), degrees in degrees(),
        gain in 0.0..4.0_f32, z in 0.0..10.0_f32,
    ) {
        let at = |gain: f32| shift(&scene, &other, &options(model, degrees, gain), z);
        let (none, one, found) = (at(0.0), at(1.0), at(gain));
        for c in 0..3 {
            prop_assert!((none[c] + gain * (one[c] - none[c]) - found[c]).abs() < 4.0 * ROUNDING);
        }
    }

    #[test]
    fn the_shift_falls_with_the_angle(
        scene in waterbody(), other in waterbody(), model in shift_model(), a in degrees(), b in degrees(),
        z in 0.0..10.0_f32,
    ) {
        let at = |degrees| shift(&scene, &other, &options(model, degrees, 1.0), z);
        let (more, less) = (at(a.min(b)), at(a.max(b)));
        for c in 0..3 {
            prop_assert!(less[c].abs() <= more[c].abs());
        }
    }

    #[test]
    fn the_laws_of_physical_hold_with_a_table_of_depth_factors(
        scene in waterbody(), other in waterbody(), factors in depth_factors(), degrees in degrees(),
        gain in 0.0..4.0_f32, z in 0.0..20.0_f32, seen in colour(),
    ) {
        let at = |reference: &Waterbody, degrees: f32, gain: f32, z: f32| {
            let waters = Waters::new(&scene, reference).with_depth_factors(Some(&factors));
            TransferLaw::new(waters, &options(Model::Physical, degrees, gain)).at(z)
        };
        prop_assert_eq!(at(&other, degrees, gain, 0.0).of(seen), seen);
        prop_assert_eq!(at(&other, 90.0, gain, z).of(seen), seen);
        prop_assert_eq!(at(&scene, degrees, 1.0, z).of(seen), seen);
        let cosine = degrees.to_radians().cos();
        let [none, one, found] = [0.0, 1.0, gain].map(|gain| at(&other, degrees, gain, z).offset);
        let full = at(&other, 0.0, gain, z).offset;
        for c in 0..3 {
            let [own, veil] = [&scene, &other].map(|water| water.veiling_light.rgb()[c]);
            prop_assert!((none[c] + gain * (one[c] - none[c]) - found[c]).abs() < 4.0 * ROUNDING);
            prop_assert!(found[c].abs() <= cosine * (gain * veil - own).abs() + ROUNDING);
            prop_assert!((found[c] - cosine * full[c]).abs() < 4.0 * ROUNDING);
            let expected = cosine * (1.0 - factors.at(z)[c]) * (gain * veil - own);
            prop_assert!((found[c] - expected).abs() < 4.0 * ROUNDING);
        }
    }

    #[test]
    fn the_laws_hold_with_a_share_of_water(
        scene in waterbody(), other in waterbody(), factors in depth_factors(), degrees in degrees(),
        gain in 0.0..4.0_f32, z in 0.0..20.0_f32, nearer in 0.0..1.0_f32, w in 0.0..=1.0_f32, seen in colour(),
    ) {
        for model in [Model::Physical, Model::Relight, Model::Exchange] {
            let law = |reference: &Waterbody, degrees: f32, gain: f32| {
                let waters = Waters::new(&scene, reference).with_depth_factors(Some(&factors));
                TransferLaw::new(waters, &options(model, degrees, gain))
            };
            let at = |law: &TransferLaw, z: f32, w: f32| law.in_share(law.at(z), w);
            let towards = law(&other, degrees, gain);
            prop_assert_eq!(at(&towards, 0.0, 0.0).of(seen), seen);
            prop_assert_eq!(at(&towards, z, 0.0), towards.at(z));
            prop_assert_eq!(at(&law(&other, 90.0, gain), z, w).of(seen), seen);
            for (found, seen) in at(&law(&scene, degrees, 1.0), z, w).of(seen).into_iter().zip(seen) {
                prop_assert!((found - seen).abs() < 4.0 * ROUNDING);
            }
            // Open water of the content's colour becomes the reference's, at any depth.
            let own = scene.veiling_light.rgb();
            for (found, veil) in at(&law(&other, 0.0, 1.0), z, 1.0).of(own).into_iter().zip(other.veiling_light.rgb()) {
                prop_assert!((found - veil).abs() < 16.0 * ROUNDING, "{} is not {}", found, veil);
            }
        }
        // `physical`: F = (1 - w) F' never rises with z, and equal F is equal shift.
        let waters = Waters::new(&scene, &other).with_depth_factors(Some(&factors));
        let law = TransferLaw::new(waters, &options(Model::Physical, degrees, gain));
        let [near, far] = [nearer * z, z].map(|z| law.in_share(law.at(z), w).offset);
        let cosine = degrees.to_radians().cos();
        for c in 0..3 {
            let [own, veil] = [&scene, &other].map(|water| water.veiling_light.rgb()[c]);
            prop_assert!(near[c].abs() <= far[c].abs() + 4.0 * ROUNDING);
            let expected = cosine * (1.0 - (1.0 - w) * factors.at(z)[c]) * (gain * veil - own);
            prop_assert!((far[c] - expected).abs() < 8.0 * ROUNDING);
        }
    }

    #[test]
    fn only_physical_reads_a_table_of_depth_factors(
        scene in waterbody(), other in waterbody(), factors in depth_factors(), degrees in degrees(),
        z in 0.0..20.0_f32,
    ) {
        for model in [Model::Aquafuse, Model::Exchange] {
            let waters = Waters::new(&scene, &other);
            let with = waters.with_depth_factors(Some(&factors));
            let options = options(model, degrees, 1.0);
            prop_assert_eq!(TransferLaw::new(with, &options).at(z), TransferLaw::new(waters, &options).at(z));
        }
    }

    #[test]
    fn the_unit_of_depth_cancels(
        scene in waterbody(), other in waterbody(), model in shift_model(), degrees in degrees(),
        unit in 0.01..100.0_f32, z in 0.0..10.0_f32,
    ) {
        let scaled = Waterbody { backscatter_coefficient: scene.backscatter_coefficient.map(|b| b / unit), ..scene };
        let options = options(model, degrees, 1.0);
        let (one, other) = (shift(&scene, &other, &options, z), shift(&scaled, &other, &options, z * unit));
        for c in 0..3 {
            prop_assert!((one[c] - other[c]).abs() < 16.0 * ROUNDING);
        }
    }

    #[test]
    fn attenuation_has_no_effect(
        scene in waterbody(), other in waterbody(), third in waterbody(), model in shift_model(), z in 0.0..10.0_f32,
    ) {
        let changed = |water: &Waterbody| Waterbody { attenuation: third.attenuation, ..*water };
        let options = Options::for_model(model);
        let (before, after) =
            (shift(&scene, &other, &options, z), shift(&changed(&scene), &changed(&other), &options, z));
        prop_assert_eq!(before, after);
    }

    #[test]
    fn the_shift_is_bounded(
        scene in waterbody(), other in waterbody(), degrees in degrees(), gain in 0.0..4.0_f32, z in 0.0..10.0_f32,
    ) {
        for (model, most) in [(Model::Aquafuse, 0.25), (Model::Physical, 1.0)] {
            let options = options(model, degrees, gain);
            let added = shift(&scene, &other, &options, z);
            for c in 0..3 {
                let difference = gain * other.veiling_light.rgb()[c] - scene.veiling_light.rgb()[c];
                let bound = most * options.incidence.cosine() * difference.abs();
                prop_assert!(added[c].abs() <= bound + ROUNDING);
            }
        }
    }

    #[test]
    fn the_fused_veil_peaks_at_an_optical_depth_of_ln_2(scene in waterbody(), other in waterbody(), z in 0.0..10.0_f32) {
        let added = |z| shift(&scene, &other, &Options::for_model(Model::Aquafuse), z);
        for c in 0..3 {
            let peak = added(2.0_f32.ln() / scene.backscatter_coefficient[c])[c];
            prop_assert!(added(z)[c].abs() <= peak.abs() + ROUNDING);
        }
    }

    #[test]
    fn without_gain_the_content_loses_its_own_backscatter(
        scene in waterbody(), other in waterbody(), degrees in degrees(), z in 0.0..10.0_f32,
    ) {
        let (backscatter, factor) = (scene.backscatter(z), scene.depth_factor(z));
        for model in [Model::Aquafuse, Model::Physical] {
            let options = options(model, degrees, 0.0);
            let added = shift(&scene, &other, &options, z);
            for c in 0..3 {
                let lost = options.incidence.cosine() * backscatter[c];
                let lost = if model == Model::Aquafuse { lost * factor[c] } else { lost };
                prop_assert!((added[c] + lost).abs() < ROUNDING);
            }
        }
    }

    #[test]
    fn fusing_back_inverts(
        scene in waterbody(), other in waterbody(), model in shift_model(), degrees in degrees(), z in 0.0..10.0_f32,
    ) {
        // The content's depth and coefficients are held, the veils exchanged.
        let options = options(model, degrees, 1.0);
        let fused = with_veil(&scene, other.veiling_light.rgb());
        let (there, back) = (shift(&scene, &other, &options, z), shift(&fused, &scene, &options, z));
        for c in 0..3 {
            prop_assert_eq!(there[c] + back[c], 0.0);
        }
    }

    #[test]
    fn equal_depth_gets_an_equal_shift(
        scene in waterbody(), other in waterbody(), model in shift_model(), level: u8, a: [u8; 3], b: [u8; 3],
    ) {
        let content = Image::<f32>::from_raw(2, 1, [a, b].concat().iter().map(|&v| 0.4 + f32::from(v) / 1275.0).collect()).unwrap();
        let depth = DepthMap::from_levels(2, 1, vec![level; 2]).unwrap();
        // A quarter of the way, so that nothing clips.
        let other = with_veil(&other, std::array::from_fn(|c| {
            0.75 * scene.veiling_light.rgb()[c] + 0.25 * other.veiling_light.rgb()[c]
        }));
        let fused = fuse(&content, &depth, Waters::new(&scene, &other), &Options::for_model(model)).unwrap();
        prop_assert_eq!(fused.clipping.values, [0; 3]);
        let moved = |pixel: usize, c: usize| fused.image.pixels()[pixel][c] - content.pixels()[pixel][c];
        for c in 0..3 {
            prop_assert!((moved(0, c) - moved(1, c)).abs() < ROUNDING);
        }
    }

    #[test]
    fn water_of_no_thickness_is_not_seen(clear in colour(), water in waterbody()) {
        let image = Image::<f32>::from_raw(1, 1, clear.to_vec()).unwrap();
        let depth = DepthMap::from_distances(1, 1, DepthKind::Metres, vec![0.0]).unwrap();
        prop_assert_eq!(form(&image, &depth, &water).unwrap(), image);
    }

    #[test]
    fn far_away_only_the_veiling_light_is_left(clear in colour(), water in waterbody()) {
        let image = Image::<f32>::from_raw(1, 1, clear.to_vec()).unwrap();
        let depth = DepthMap::from_distances(1, 1, DepthKind::Metres, vec![1e5]).unwrap();
        prop_assert_eq!(form(&image, &depth, &water).unwrap().pixels()[0], water.veiling_light.rgb());
    }

    #[test]
    fn restoring_undoes_forming_within_the_bound(clear in colour(), water in waterbody(), z in 0.0..10.0_f32) {
        let image = Image::<f32>::from_raw(1, 1, clear.to_vec()).unwrap();
        let depth = DepthMap::from_distances(1, 1, DepthKind::Metres, vec![z]).unwrap();
        let options = RestoreOptions::default();
        let restored = restore(&form(&image, &depth, &water).unwrap(), &depth, &water, &options).unwrap();
        for c in 0..3 {
            let gain = water.attenuation[c].optical_depth(z).exp();
            let found = restored.pixels()[0][c];
            if gain <= options.max_gain[c] {
                prop_assert!((found - clear[c]).abs() < gain * 4.0 * ROUNDING, "{found} for {} at gain {gain}", clear[c]);
            } else {
                // The bound leaves the scene darker, never brighter.
                prop_assert!(found <= clear[c] + 4.0 * ROUNDING * options.max_gain[c]);
            }
        }
    }

    #[test]
    fn exchange_is_restoring_and_forming_within_the_bound(
        scene in waterbody(), other in waterbody(), seen in colour(), gain in 0.0..4.0_f32, z in 0.0..10.0_f32,
    ) {
        // The gain is put into the reference here, and a veil above 1 is no `VeilingLight`.
        let brightest = other.veiling_light.rgb().into_iter().fold(0.0, f32::max);
        let gain = gain.min(brightest.recip());
        let brighter = with_veil(&other, other.veiling_light.rgb().map(|veil| gain * veil));
        let image = Image::<f32>::from_raw(1, 1, seen.to_vec()).unwrap();
        let depth = DepthMap::from_distances(1, 1, DepthKind::Metres, vec![z]).unwrap();
        let bound = RestoreOptions::default();
        let clear = restore(&image, &depth, &scene, &bound).unwrap();
        let expected = form(&clear, &depth, &brighter).unwrap().pixels()[0];
        let options = options(Model::Exchange, 0.0, gain).with_max_gain(bound.max_gain[0]);
        let found = law(&scene, &other, &options).at(z).of(seen);
        for c in 0..3 {
            // Where e^τ1 is within its bound, so is e^(τ1 - τ2).
            if scene.attenuation[c].optical_depth(z).exp() <= bound.max_gain[c] {
                prop_assert!((found[c] - expected[c]).abs() < 8.0 * bound.max_gain[c] * ROUNDING, "{} is not {}", found[c], expected[c]);
            }
        }
    }

    #[test]
    fn exchange_lies_between_the_content_and_its_whole_effect(
        scene in waterbody(), other in waterbody(), seen in colour(), degrees in degrees(), z in 0.0..10.0_f32,
    ) {
        let fused = |degrees| law(&scene, &other, &options(Model::Exchange, degrees, 1.0)).at(z).of(seen);
        let cosine = Incidence::from_degrees(degrees).unwrap().cosine();
        let (whole, part) = (fused(0.0), fused(degrees));
        for c in 0..3 {
            prop_assert!((part[c] - (seen[c] + cosine * (whole[c] - seen[c]))).abs() < 4.0 * ROUNDING);
        }
    }

    #[test]
    fn no_model_turns_the_order_of_values_round_nor_lets_noise_explode(
        scene in waterbody(), other in waterbody(), model in model(), degrees in degrees(), gain in 0.0..4.0_f32,
        max_gain in 0.0..10.0_f32, z in 0.0..1e4_f32,
    ) {
        let options = options(model, degrees, gain).with_max_gain(max_gain);
        let bound = max_gain.max(1.0);
        let change = law(&scene, &other, &options).at(z);
        prop_assert!(change.gain.iter().all(|gain| (0.0..=bound + ROUNDING * bound).contains(gain)), "{:?}", change.gain);
    }

    #[test]
    fn the_unit_of_depth_cancels_from_exchange(
        scene in waterbody(), other in waterbody(), seen in colour(), unit in 0.01..100.0_f32, z in 0.0..10.0_f32,
    ) {
        let scaled = |water: &Waterbody| Waterbody {
            backscatter_coefficient: water.backscatter_coefficient.map(|b| b / unit),
            attenuation: water.attenuation.map(|curve| {
                Attenuation::new(curve.mu().map(|mu| mu / unit), curve.held_beyond() * unit).unwrap()
            }),
            ..*water
        };
        let options = Options::for_model(Model::Exchange);
        let one = law(&scene, &other, &options).at(z).of(seen);
        let two = law(&scaled(&scene), &scaled(&other), &options).at(z * unit).of(seen);
        for c in 0..3 {
            // An error of τ, which is about 30 at most here, is one of g in proportion.
            prop_assert!((one[c] - two[c]).abs() < 32.0 * options.max_gain * ROUNDING, "{} is not {}", one[c], two[c]);
        }
    }

    #[test]
    fn whatever_is_fused_lies_in_the_range(
        scene in waterbody(), other in waterbody(), model in model(), gain in 0.0..=f32::MAX,
        seen in prop::array::uniform3(-f32::MAX..=f32::MAX), z in 0.0..=f32::MAX,
    ) {
        let image = Image::<f32>::from_raw(1, 1, seen.to_vec()).unwrap();
        let depth = DepthMap::from_distances(1, 1, DepthKind::Metres, vec![z]).unwrap();
        let options = options(model, 0.0, gain);
        let fused = fuse(&image, &depth, Waters::new(&scene, &other), &options).unwrap();
        prop_assert!(fused.image.as_raw().iter().all(|value| (0.0..=1.0).contains(value)));
    }
}
