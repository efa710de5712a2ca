//! Waters as data: what is written is read back to the bit, and what is malformed is an error.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

use aquafuse::image::{Encoded, Encoding, Linear};
use aquafuse::truth::{Scene, Size, waters};
use aquafuse::waterbody::presets::{Camera, Conditions, Preset, White};
use aquafuse::waterbody::{self, Attenuation, Quality, Reason, VeilingLight, Waterbody};
use proptest::prelude::*;
use serde::{Serialize, de::DeserializeOwned};

fn comes_back<T: Serialize + DeserializeOwned + PartialEq + std::fmt::Debug>(value: &T) {
    let text = serde_json::to_string(value).unwrap();
    assert_eq!(&serde_json::from_str::<T>(&text).unwrap(), value, "{text}");
}

fn bits<E: Encoding>(water: &Waterbody<E>) -> Vec<u32> {
    let curves =
        water.attenuation.iter().flat_map(|curve| [&curve.mu()[..], &[curve.held_beyond()]].concat());
    let numbers = water.veiling_light.rgb().into_iter().chain(water.backscatter_coefficient).chain(curves);
    numbers.map(f32::to_bits).collect()
}

proptest! {
    #[test]
    fn a_waterbody_comes_back_bit_for_bit(
        veil: [f32; 3], beta: [f32; 3], mu5 in 0.0..9.0_f32, fall in 0.0..1.0_f32, end in 0.01..99.0_f32,
    ) {
        let beta = beta.map(f32::abs);
        prop_assume!(beta.iter().all(|beta| beta.is_finite()));
        let water: Waterbody<Linear> = Waterbody {
            veiling_light: VeilingLight::new(veil),
            backscatter_coefficient: beta,
            attenuation: [Attenuation::new([mu5, -fall / end, 0.1, 0.0], end).unwrap(); 3],
        };
        let text = serde_json::to_string(&water).unwrap();
        let back: Waterbody<Linear> = serde_json::from_str(&text).unwrap();
        prop_assert_eq!(bits(&back), bits(&water), "{}", text);
    }

    #[test]
    fn no_text_makes_a_reader_panic(text in "[\\[\\]{}:,\"a-z0-9.eE+-]{0,80}") {
        let _ = serde_json::from_str::<Waterbody>(&text);
        let _ = serde_json::from_str::<Quality>(&text);
        let _ = serde_json::from_str::<Conditions>(&text);
    }
}

#[test]
fn what_describes_an_estimate_comes_back() {
    let image = Scene::new(3, Size { width: 96, height: 64 }).seen_through(&waters()[1].water).convert();
    let z = aquafuse::depth::estimate(&image);
    let found = waterbody::estimate::<Encoded>(&image, &z, &Default::default()).unwrap();
    comes_back(&found.water);
    comes_back(&found.intervals);
    comes_back(&found.veiling_light_source);
    comes_back(&Quality::default().with(Reason::DeadRed).with(Reason::FlatDepth));
    comes_back(&aquafuse::depth::RelativeScale::default());
}

#[test]
fn presets_and_their_conditions_come_back() {
    let camera = Camera::new("narrow", "a test", [620.0, 530.0, 460.0], [15.0; 3]).unwrap();
    let conditions = Conditions::default().with_camera(camera).with_white(White::AtDepth);
    comes_back(&conditions);
    for preset in Preset::ALL {
        comes_back(&preset.derive::<Linear>(&conditions));
    }
}

#[test]
fn a_malformed_water_is_an_error_that_says_what_is_wrong() {
    let water = |veil: &str, beta: &str, mu: &str, end: &str| {
        let curve = format!(r#"{{"mu":{mu},"held_beyond":{end}}}"#);
        let text = format!(
            r#"{{"veiling_light":{veil},"backscatter_coefficient":{beta},"attenuation":[{curve},{curve},{curve}]}}"#
        );
        serde_json::from_str::<Waterbody>(&text).map_err(|error| error.to_string())
    };
    let (veil, beta, mu) = ("[0.1,0.2,0.3]", "[1,1,1]", "[0.5,0,0,0]");
    assert!(water(veil, beta, mu, "9").is_ok());
    for (found, cause) in [
        (water("[0.1,0.2,1.3]", beta, mu, "9"), "lies between 0 and 1"),
        (water("[0.1,0.2]", beta, mu, "9"), "length 2"),
        (water(veil, "[-1,1,1]", mu, "9"), "0 or more"),
        (water(veil, "[1e99,1,1]", mu, "9"), "out of range"),
        (water(veil, "[null,1,1]", mu, "9"), "null"),
        (water(veil, beta, "[-0.5,0,0,0]", "9"), "negative"),
        (water(veil, beta, "[0.5,-1,0,0]", "9"), "falls"),
        (water(veil, beta, mu, "-9"), "not negative"),
    ] {
        let error = found.unwrap_err();
        assert!(error.contains(cause), "{error}");
    }
    let quality = r#"{"verdict":"good","reasons":["dead_red"]}"#;
    let error = serde_json::from_str::<Quality>(quality).unwrap_err().to_string();
    assert!(error.contains("these reasons make it doubtful"), "{error}");
}
