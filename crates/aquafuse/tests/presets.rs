//! Waters from tables: laws that hold for all types and conditions, and the tables against another collection.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

use std::process::Command;

use aquafuse::depth::RelativeScale;
use aquafuse::image::{Encoded, Encoding, Linear};
use aquafuse::waterbody::presets::{Camera, Conditions, Preset, White};
use aquafuse::waterbody::{Attenuation, VeilingLight, Waterbody};
use proptest::prelude::*;

const OCEAN: [Preset; 5] = [Preset::I, Preset::IA, Preset::IB, Preset::II, Preset::III];

fn preset() -> impl Strategy<Value = Preset> {
    prop::sample::select(Preset::ALL)
}

fn white() -> impl Strategy<Value = White> {
    prop::sample::select(&[White::Daylight, White::AtDepth, White::AtSurface][..])
}

fn conditions() -> impl Strategy<Value = Conditions> {
    let camera = (590.0..620.0, 520.0..550.0, 440.0..470.0, 20.0..45.0)
        .prop_map(|(r, g, b, deviation)| Camera::new("some", "made up", [r, g, b], [deviation; 3]).unwrap());
    (0.0..40.0, white(), 0.5..1.0, 1.0..60.0, 0.5..5.0, camera).prop_map(
        |(depth, white, level, range, factor, camera)| {
            let sited = Conditions::default().with_depth_below_surface(depth).unwrap().with_white(white);
            let exposed = sited.with_white_level(level).unwrap().with_veil_factor(factor).unwrap();
            exposed.with_range(range).unwrap().with_camera(camera)
        },
    )
}

fn at_depth(depth: f64, white: White) -> Conditions {
    Conditions::default().with_depth_below_surface(depth).unwrap().with_white(white)
}

fn lawful<E: Encoding>(preset: Preset, conditions: &Conditions, z: f32) -> Result<(), TestCaseError> {
    let water = preset.water::<E>(conditions);
    let veil = water.veiling_light.rgb();
    let (near, far) = (water.illumination(z), water.illumination(z + 0.5));
    let (before, after) = (water.backscatter(z), water.backscatter(z + 0.5));
    let end = water.backscatter(1e5);
    for c in 0..3 {
        prop_assert!((0.0..=1.0).contains(&veil[c]), "veil {veil:?}");
        prop_assert!(water.backscatter_coefficient[c] > 0.0);
        prop_assert!(far[c] <= near[c] * (1.0 + 1e-5), "light left rises from {near:?} to {far:?}");
        prop_assert!(after[c] >= before[c]);
        prop_assert!((end[c] - veil[c]).abs() <= 1e-6);
    }
    Ok(())
}

proptest! {
    #[test]
    fn every_preset_is_a_water(preset in preset(), conditions in conditions(), z in 0.0..60.0_f32) {
        lawful::<Encoded>(preset, &conditions, z)?;
        lawful::<Linear>(preset, &conditions, z)?;
    }

    #[test]
    fn the_fits_are_as_close_as_the_documentation_says(
        preset in preset(), depth in 0.0..20.0, white in white(), range in 3.0..50.0,
    ) {
        let conditions = at_depth(depth, white).with_range(range).unwrap();
        let linear = preset.derive::<Linear>(&conditions).residual;
        let encoded = preset.derive::<Encoded>(&conditions);
        for c in 0..3 {
            let [backscatter, direct, seen] = [linear.backscatter, linear.direct, linear.seen].map(|off| off[c]);
            prop_assert!(backscatter < 0.002 && direct < 0.002 && seen < 0.002, "{linear:?}");
            prop_assert!(encoded.residual.backscatter[c] < 0.16 * encoded.water.veiling_light.rgb()[c], "{encoded:?}");
            prop_assert!(encoded.residual.seen[c] < 0.11, "{encoded:?}");
        }
    }

    #[test]
    fn a_water_per_relative_depth_looks_the_same_at_the_same_place(
        preset in preset(), metres_at_one in 0.5..100.0_f32, z in 0.0..60.0_f32,
    ) {
        let metric: Waterbody = preset.water(&Conditions::default());
        let scale = RelativeScale::new(metres_at_one).unwrap();
        let relative = metric.per_relative(scale).unwrap();
        let there = scale.relative(z);
        prop_assert!((scale.metres(there) - z).abs() < 1e-5 * z.max(1.0));
        for c in 0..3 {
            prop_assert!((metric.backscatter(z)[c] - relative.backscatter(there)[c]).abs() < 1e-5);
            prop_assert!((metric.illumination(z)[c] - relative.illumination(there)[c]).abs() < 1e-5);
        }
    }

    #[test]
    fn deeper_is_darker(preset in preset(), depth in 0.0..40.0, more in 0.5..20.0) {
        let veil = |depth| preset.water::<Linear>(&at_depth(depth, White::AtSurface)).veiling_light.rgb();
        let (shallow, deep) = (veil(depth), veil(depth + more));
        for c in 0..3 {
            // All light may be gone from a channel already.
            prop_assert!(deep[c] < shallow[c] || shallow[c] < 1e-6, "{shallow:?} {deep:?}");
        }
    }

    #[test]
    fn deeper_in_the_ocean_is_bluer(preset in prop::sample::select(&OCEAN[..4]), depth in 0.0..20.0, more in 0.5..20.0) {
        let blueness = |depth| {
            let [r, g, b] = preset.water::<Linear>(&at_depth(depth, White::Daylight)).veiling_light.rgb();
            b / (r + g + b)
        };
        prop_assert!(blueness(depth + more) > blueness(depth));
    }
}

#[test]
fn from_i_to_9c_the_water_gets_murkier_in_green() {
    let conditions = Conditions::default();
    let left = |preset: &Preset| preset.water::<Linear>(&conditions).illumination(2.0)[1];
    let left: Vec<f32> = Preset::ALL.iter().map(left).collect();
    assert!(left.is_sorted_by(|clear, murky| clear > murky), "{left:?}");
}

#[test]
fn in_the_ocean_red_goes_first() {
    for preset in OCEAN {
        let [r, g, b] = preset.water::<Linear>(&Conditions::default()).illumination(3.0);
        assert!(r < g && r < b, "{preset:?}: {r} {g} {b}");
    }
}

#[test]
fn what_goes_first_leaves_what_stays() {
    for &preset in Preset::ALL {
        for curve in preset.water::<Linear>(&Conditions::default()).attenuation {
            assert!(
                curve.coefficient(0.0) >= curve.coefficient(curve.held_beyond()),
                "{preset:?}: {curve:?}"
            );
        }
    }
}

#[test]
fn the_veil_turns_from_blue_over_green_to_yellow() {
    let veil = |preset: Preset| preset.water::<Encoded>(&Conditions::default()).veiling_light.rgb();
    for preset in [Preset::I, Preset::IA, Preset::IB, Preset::II] {
        let [r, g, b] = veil(preset);
        assert!(r < g && g < b, "{preset:?} is not blue");
    }
    for preset in [Preset::III, Preset::Coastal1C, Preset::Coastal3C, Preset::Coastal5C] {
        let [r, g, b] = veil(preset);
        assert!(g > r && g >= b, "{preset:?} is not green");
    }
    for preset in [Preset::Coastal7C, Preset::Coastal9C] {
        let [r, g, b] = veil(preset);
        assert!(b < 0.75 * r.min(g) && (r - g).abs() < 0.2, "{preset:?} is not yellow");
    }
}

#[test]
fn what_is_balanced_is_white() {
    for &preset in Preset::ALL {
        let balanced = preset.derive::<Encoded>(&at_depth(8.0, White::AtDepth)).white;
        let exposed = preset.derive::<Encoded>(&at_depth(8.0, White::Daylight)).white;
        assert!(balanced.iter().all(|value| (value - 0.9).abs() < 1e-5), "{balanced:?}");
        assert!((exposed.into_iter().fold(0.0, f32::max) - 0.9).abs() < 1e-5, "{exposed:?}");
    }
}

#[test]
fn for_one_colour_of_light_the_water_is_the_formula() {
    // 550 nm is a wavelength of every table; a camera this narrow sees a tenth of the light beside it.
    let camera = Camera::new("narrow", "made up", [550.0; 3], [5.0; 3]).unwrap();
    let conditions = at_depth(4.0, White::AtDepth).with_camera(camera);
    for &preset in Preset::ALL {
        let assumed = preset.assumptions(&conditions);
        let [a, b, _, _] = assumed.spectra.each_ref().map(|spectrum| {
            let at = spectrum.wavelengths_nm.iter().position(|&wavelength| wavelength == 550.0);
            at.map_or(f64::NAN, |at| spectrum.values[at])
        });
        let sea = 0.00583 * (400.0_f64 / 550.0).powf(4.322);
        let backwards = 0.5 * sea + 0.0183 * (b - sea);
        let white = f64::from(Linear::from_encoded(0.9));
        let veil = white * 4.5 * backwards / (a + backwards);
        let water = preset.water::<Linear>(&conditions);
        let off = |found: f32, expected: f64| (f64::from(found) / expected - 1.0).abs();
        assert!(off(water.veiling_light.rgb()[1], veil) < 0.02, "{preset:?}: {water:?}, veil {veil}");
        assert!(off(water.backscatter_coefficient[1], a + b) < 0.02, "{preset:?}: {water:?}, c {}", a + b);
        assert!(
            off(water.attenuation[1].coefficient(1.0), a + b) < 0.02,
            "{preset:?}: {water:?}, c {}",
            a + b
        );
    }
}

#[cfg(feature = "serde")]
#[test]
fn all_that_is_assumed_is_data() {
    fn data(_: &impl serde::Serialize) {}
    let conditions = Conditions::default();
    data(&Preset::II.assumptions(&conditions));
    data(&Preset::II.derive::<Linear>(&conditions));
    data(&RelativeScale::default());
}

#[test]
fn names_are_read_back() {
    for &preset in Preset::ALL {
        assert_eq!(preset.to_string().parse(), Ok(preset));
    }
    assert_eq!("JERLOV-1c".parse(), Ok(Preset::Coastal1C));
    assert!("jerlov-11C".parse::<Preset>().is_err());
}

#[test]
fn conditions_out_of_range_are_refused() {
    let from = Conditions::default;
    assert!(from().with_depth_below_surface(f64::NAN).is_err());
    assert!(from().with_white_level(1.1).is_err());
    assert!(from().with_range(0.0).is_err());
    assert!(from().with_veil_factor(6.0).is_err());
    assert!(Camera::new("infrared", "none", [900.0, 530.0, 460.0], [30.0; 3]).is_err());
    assert!(Camera::new("laser", "none", [600.0, 530.0, 460.0], [0.0; 3]).is_err());
    let message = from().with_depth_below_surface(120.0).unwrap_err().to_string();
    assert_eq!(message, "depth below the surface in metres is 120, but must be from 0 to 100");
}

#[test]
fn a_water_too_murky_for_a_scale_is_refused() {
    let water: Waterbody = Waterbody {
        veiling_light: VeilingLight::new([0.5; 3]),
        backscatter_coefficient: [1.0; 3],
        attenuation: [Attenuation::constant(1e38).unwrap(); 3],
    };
    assert!(water.per_relative(RelativeScale::new(1000.0).unwrap()).is_err());
}

/// Prints a, b and K_d of a type as the package `jerlov` has them: a line per number.
const SCRIPT: &str = "
import sys, warnings, jerlov
warnings.simplefilter('ignore')
source, quantity, kind = sys.argv[1:4]
water = jerlov.water(kind, source=source)
for wavelength in sys.argv[4:]:
    print(float(getattr(water, quantity)(float(wavelength))))
";

#[test]
fn the_tables_are_those_of_the_package_jerlov() {
    let Some(python) = std::env::var_os("AQUAFUSE_PYTHON") else {
        eprintln!("skipped: AQUAFUSE_PYTHON names no Python with jerlov; `cargo xtask test` sets one up");
        return;
    };
    for &preset in Preset::ALL {
        let assumed = preset.assumptions(&Conditions::default());
        for (spectrum, quantity) in assumed.spectra.iter().zip(["a", "b", "kd"]) {
            let source = match spectrum.source.split(' ').next() {
                Some("Williamson") => "williamson2022",
                Some("Solonenko") => "solonenko2015",
                _ => "jerlov1976",
            };
            let kind = preset.name().trim_start_matches("jerlov-");
            let wavelengths = spectrum.wavelengths_nm.iter().map(f64::to_string);
            let script = ["-c", SCRIPT, source, quantity, kind];
            let ended = Command::new(&python).args(script).args(wavelengths).output().unwrap();
            assert!(ended.status.success(), "{}", String::from_utf8_lossy(&ended.stderr));
            let printed = String::from_utf8(ended.stdout).unwrap();
            let theirs: Vec<f64> = printed.lines().map(|line| line.parse().unwrap()).collect();
            assert_eq!(spectrum.values, theirs, "{} of {}", spectrum.quantity, preset.name());
        }
    }
}
