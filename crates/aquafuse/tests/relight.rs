//! The laws of `relight`: the whole backscatter, and the reference's light on near things.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

use aquafuse::Fuser;
use aquafuse::depth::{self, DepthMap};
use aquafuse::fusion::{Bounded, Gain, Incidence, Model, Options, TransferLaw, Waters};
use aquafuse::image::{Encoded, Image};
use aquafuse::truth::{Scene, Size, waters};
use aquafuse::waterbody::presets::{Conditions, Preset};
use aquafuse::waterbody::{self, Attenuation, Estimate, VeilingLight, Waterbody};
use proptest::prelude::*;

const ROUNDING: f32 = 16.0 * f32::EPSILON;

fn colour() -> impl Strategy<Value = [f32; 3]> {
    prop::array::uniform3(0.0..=1.0_f32)
}

fn waterbody() -> impl Strategy<Value = Waterbody> {
    (colour(), prop::array::uniform3(0.01..3.0_f32)).prop_map(|(veil, backscatter_coefficient)| Waterbody {
        veiling_light: VeilingLight::new(veil),
        backscatter_coefficient,
        attenuation: [Attenuation::constant(0.5).unwrap(); 3],
    })
}

fn light() -> impl Strategy<Value = [f32; 3]> {
    prop::array::uniform3(0.4..2.0_f32)
}

fn haze() -> impl Strategy<Value = [f32; 3]> {
    prop_oneof![Just([1.0; 3]), prop::array::uniform3(0.5..2.0_f32)]
}

fn options(degrees: f32, gain: f32) -> Options {
    options_of(Model::Relight, degrees, gain)
}

fn options_of(model: Model, degrees: f32, gain: f32) -> Options {
    let incidence = Incidence::from_degrees(degrees).unwrap();
    Options::for_model(model).with_incidence(incidence).with_gain(Gain::new(gain).unwrap())
}

proptest! {
    #[test]
    fn with_the_same_light_and_thickness_it_is_physical(
        own in waterbody(), other in waterbody(), degrees in 0.0..=90.0_f32, gain in 0.0..2.0_f32, z in 0.0..20.0_f32,
        w in 0.0..=1.0_f32, seen in colour(),
    ) {
        let waters = Waters::new(&own, &other);
        let lit = TransferLaw::new(waters, &options(degrees, gain));
        let physical = TransferLaw::new(waters, &options_of(Model::Physical, degrees, gain));
        let [lit, physical] = [lit, physical].map(|law| law.in_share(law.at(z), w).of(seen));
        for c in 0..3 {
            prop_assert!((lit[c] - physical[c]).abs() < ROUNDING);
        }
    }

    #[test]
    fn at_ninety_degrees_nothing_changes_and_open_water_takes_the_other_veil(
        own in waterbody(), other in waterbody(), light in light(), haze in haze(), z in 0.0..20.0_f32,
        w in 0.0..=1.0_f32, seen in colour(),
    ) {
        let waters = Waters::new(&own, &other).with_light_gain(light).with_haze(haze);
        let none = TransferLaw::new(waters, &options(90.0, 1.0));
        prop_assert_eq!(none.in_share(none.at(z), w).of(seen), seen);
        let whole = TransferLaw::new(waters, &options(0.0, 1.0));
        let found = whole.in_share(whole.at(z), 1.0).of(own.veiling_light.rgb());
        for (found, veil) in found.into_iter().zip(other.veiling_light.rgb()) {
            prop_assert!((found - veil).abs() < ROUNDING, "{} is not {}", found, veil);
        }
    }

    #[test]
    fn at_the_camera_the_light_is_the_references(
        own in waterbody(), other in waterbody(), light in light(), haze in haze(), seen in colour(),
    ) {
        let waters = Waters::new(&own, &other).with_light_gain(light).with_haze(haze);
        let found = TransferLaw::new(waters, &options(0.0, 1.0)).at(0.0).of(seen);
        for c in 0..3 {
            prop_assert!((found[c] - light[c] * seen[c]).abs() < ROUNDING);
        }
    }

    #[test]
    fn a_share_of_water_is_a_smaller_factor(
        own in waterbody(), other in waterbody(), light in light(), degrees in 0.0..=90.0_f32, z in 0.0..4.0_f32,
        w in 0.0..=1.0_f32, seen in colour(),
    ) {
        // U + cosθ ((1 - F) (B2 - B1) + (g - 1) F (U - B1 (1 - F))), with F = (1 - w) F'.
        let law = TransferLaw::new(Waters::new(&own, &other).with_light_gain(light), &options(degrees, 1.0));
        let found = law.in_share(law.at(z), w).of(seen);
        let (factor, cosine) = (law.depth_factor(z, w), degrees.to_radians().cos());
        for c in 0..3 {
            let [mine, veil] = [&own, &other].map(|water| water.veiling_light.rgb()[c]);
            let direct = seen[c] - mine * (1.0 - factor[c]);
            let shift = (1.0 - factor[c]) * (veil - mine);
            let expected = seen[c] + cosine * (shift + (light[c] - 1.0) * factor[c] * direct);
            prop_assert!((found[c] - expected).abs() < 2.0 * ROUNDING);
        }
    }

    #[test]
    fn no_order_is_inverted_and_no_gain_is_out_of_bounds(
        own in waterbody(), other in waterbody(), light in light(), haze in haze(), degrees in 0.0..=90.0_f32,
        z in 0.0..50.0_f32, w in 0.0..=1.0_f32,
    ) {
        let waters = Waters::new(&own, &other).with_light_gain(light).with_haze(haze);
        let law = TransferLaw::new(waters, &options(degrees, 1.0));
        let gain = law.in_share(law.at(z), w).gain;
        prop_assert!(gain.iter().all(|gain| (0.0..=3.0).contains(gain)), "{:?}", gain);
    }
}

fn seen(seed: u64, water: usize) -> Image<u8> {
    Scene::new(seed, Size { width: 96, height: 64 }).seen_through(&waters()[water].water).convert()
}

#[test]
fn an_image_in_its_own_water_is_itself() {
    let image = seen(3, 0);
    let outcome = Fuser::new(&image).unwrap().model(Model::Relight).fuse(&image).unwrap();
    assert_eq!(outcome.image, image);
}

#[test]
fn near_things_take_the_hue_of_the_references_near_things() {
    let (content, reference) = (seen(3, 0), seen(5, 1));
    let ratio = |image: &Image<u8>| {
        // The lowest rows are near.
        let near = &image.pixels()[96 * 54..];
        let sum = |c: usize| near.iter().map(|pixel| f32::from(pixel[c])).sum::<f32>();
        sum(1) / sum(2)
    };
    let fused = |model| Fuser::new(&reference).unwrap().model(model).fuse(&content).unwrap().image;
    let off = |image: &Image<u8>| (ratio(image) / ratio(&reference)).ln().abs();
    let (physical, lit) = (off(&fused(Model::Physical)), off(&fused(Model::Relight)));
    assert!(lit < 0.7 * physical, "{lit} {physical}");
}

#[test]
fn a_known_water_has_a_light_and_a_haze() {
    let own: Estimate<Encoded> = Preset::I.estimate(&Conditions::default());
    let other = Preset::Coastal5C.estimate(&Conditions::default());
    let bounded = Bounded::new(&own, &other, Options::for_model(Model::Relight));
    let Waters { light_gain, haze, .. } = bounded.waters();
    // Coastal water takes blue from the light, and is thicker.
    assert!(light_gain[2] < light_gain[1], "{light_gain:?}");
    assert_eq!(haze, [2.0; 3]);
    // A water that an image shows has a haze where its depth has a unit.
    let shown = |image: &Image<u8>, z: &DepthMap| {
        waterbody::estimate::<Encoded>(image, z, &Default::default()).unwrap()
    };
    let scene = |seed, water: usize| {
        let scene = Scene::new(seed, Size { width: 96, height: 64 });
        (scene.seen_through(&waters()[water].water).convert::<u8>(), scene.depth)
    };
    let [(content, z), (reference, z_of_reference)] = [scene(3, 3), scene(5, 2)];
    let haze = |own: &Estimate, other: &Estimate| {
        Bounded::new(own, other, Options::for_model(Model::Relight)).waters().haze
    };
    let turbid = shown(&reference, &z_of_reference);
    assert!(haze(&shown(&content, &z), &turbid)[0] > 1.1);
    let by_colour = shown(&content, &depth::estimate(&content));
    assert_eq!(haze(&by_colour, &turbid), [1.0; 3]);
    assert!(haze(&by_colour, &other)[0] > 1.0);
}
