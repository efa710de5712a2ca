//! Every named way to fail has a scene, and every such scene its reason.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

use aquafuse::depth::{DepthKind, DepthMap, DepthModel};
use aquafuse::formation::form;
use aquafuse::fusion::{Bounded, Model, Options, TransferLaw};
use aquafuse::image::{Encoded, Image};
use aquafuse::truth::{Gaze, OPEN_WATER, Scene, Size, View, waters};
use aquafuse::waterbody::{Attenuation, Estimate, Reason, VeilingLight, Verdict, Waterbody, estimate};

const SIZE: Size = Size { width: 240, height: 160 };
const SEED: u64 = 2000;

fn water() -> Waterbody {
    waters()[0].water
}

/// A place with black discs laid over things, and what a camera sees of it.
struct Made {
    clear: Image<f32>,
    depth: DepthMap,
}

impl Made {
    fn new(seed: u64, gaze: Gaze) -> Self {
        let scene = Scene::of(View { gaze, ..View::default() }, seed, SIZE);
        let mut clear = scene.clear;
        let distances = scene.depth.distances();
        for (i, pixel) in clear.pixels_mut().iter_mut().enumerate() {
            let (x, y) = ((i % SIZE.width) as i32 % 20 - 10, (i / SIZE.width) as i32 % 20 - 10);
            if x * x + y * y <= 4 && distances[i] < OPEN_WATER {
                *pixel = [0.0; 3];
            }
        }
        Self { clear, depth: scene.depth }
    }

    fn changed(mut self, mut change: impl FnMut(&mut [f32; 3], f32)) -> Self {
        let distances = self.depth.distances();
        self.clear.pixels_mut().iter_mut().zip(distances).for_each(|(pixel, z)| change(pixel, z));
        self
    }

    fn seen(&self, water: &Waterbody) -> Image<u8> {
        form(&self.clear, &self.depth, water).unwrap().convert()
    }

    fn found(&self, water: &Waterbody) -> Estimate {
        estimate::<Encoded>(&self.seen(water), &self.depth, &Default::default()).unwrap()
    }
}

#[track_caller]
fn assert_doubted(found: &Estimate, reason: Reason) {
    assert!(found.quality.reasons.contains(reason), "{:?} lacks {reason:?}", found.quality);
    assert_ne!(found.quality.verdict, Verdict::Good);
}

#[test]
fn clean_scenes_are_good_and_right() {
    let (mut good, mut all) = (0, 0);
    for seed in SEED..SEED + 2 {
        let made = Made::new(seed, Gaze::Ahead);
        for named in waters() {
            let (truth, found) = (named.water, made.found(&named.water));
            all += 1;
            if found.quality.verdict != Verdict::Good {
                continue;
            }
            good += 1;
            for c in 0..3 {
                let veil = truth.veiling_light.rgb()[c];
                assert!((found.water.veiling_light.rgb()[c] - veil).abs() < 0.01, "{}", named.name);
                let off = found.water.backscatter_coefficient[c] / truth.backscatter_coefficient[c] - 1.0;
                assert!(veil < 0.05 || off.abs() < 0.25, "β_B of {} is off by {off}", named.name);
            }
        }
    }
    assert!(10 * good >= 6 * all, "{good} of {all}");
}

#[test]
fn a_look_at_the_floor_shows_no_open_water() {
    assert_doubted(&Made::new(SEED, Gaze::Down).found(&water()), Reason::NoOpenWater);
}

#[test]
fn a_wall_is_flat() {
    let mut made = Made::new(SEED, Gaze::Down);
    made.depth =
        DepthMap::from_distances(SIZE.width, SIZE.height, DepthKind::Metres, vec![3.0; 240 * 160]).unwrap();
    let found = made.found(&water());
    assert_doubted(&found, Reason::FlatDepth);
    assert_eq!(found.quality.verdict, Verdict::Failed, "nothing is left to rely on");
}

#[test]
fn depth_from_colour_saturates_where_red_leads() {
    let made = Made::new(SEED, Gaze::Ahead);
    let amber = Waterbody { veiling_light: VeilingLight::new([0.7, 0.3, 0.1]), ..water() };
    let image = made.seen(&amber);
    let z = DepthModel::Ratio.estimate(&image);
    assert_doubted(&estimate(&image, &z, &Default::default()).unwrap(), Reason::SaturatedDepth);
}

#[test]
fn glare_is_no_colour_of_water() {
    for veil in [[0.9, 0.92, 0.95], [0.6, 0.3, 0.3]] {
        let glare = Waterbody { veiling_light: VeilingLight::new(veil), ..water() };
        assert_doubted(&Made::new(SEED, Gaze::Ahead).found(&glare), Reason::LightOutsideWaterHues);
    }
}

#[test]
fn dark_things_that_glow_with_distance_leave_the_curve() {
    // A second light: bands of distance whose black is grey.
    let made = Made::new(SEED, Gaze::Ahead);
    let banded = made.changed(|pixel, z| {
        if z < OPEN_WATER && (1.5 * z).sin() > -0.7 {
            *pixel = pixel.map(|value| value.max(0.5));
        }
    });
    assert_doubted(&banded.found(&water()), Reason::LargeResidual);
}

#[test]
fn where_nothing_is_dark_beta_is_not_known() {
    let bright = Made::new(SEED, Gaze::Ahead).changed(|pixel, z| {
        if z < OPEN_WATER {
            *pixel = pixel.map(|value| value.max(0.45));
        }
    });
    assert_doubted(&bright.found(&water()), Reason::FewDarkPixels);
}

#[test]
fn an_image_without_red_has_dead_red() {
    let made = Made::new(SEED, Gaze::Ahead).changed(|pixel, _| pixel[0] = 0.0);
    let [_, green, blue] = water().veiling_light.rgb();
    let redless = Waterbody { veiling_light: VeilingLight::new([0.0, green, blue]), ..water() };
    assert_doubted(&made.found(&redless), Reason::DeadRed);
}

#[test]
fn light_that_grows_with_distance_fades_along_no_curve() {
    // The near is in shadow, the far in the sun.
    let made = Made::new(SEED, Gaze::Ahead);
    let lit = made.changed(|pixel, z| *pixel = pixel.map(|value| value * (0.007 * z * z).clamp(0.1, 1.0)));
    let attenuation = [Attenuation::constant(0.01).unwrap(); 3];
    let thin = Waterbody { attenuation, ..water() };
    assert_doubted(&lit.found(&thin), Reason::AttenuationNotConverged);
}

#[test]
fn a_dead_red_channel_gets_no_red_cast() {
    let made = Made::new(SEED, Gaze::Ahead).changed(|pixel, _| pixel[0] = 0.0);
    let [_, green, blue] = water().veiling_light.rgb();
    let redless = Waterbody { veiling_light: VeilingLight::new([0.0, green, blue]), ..water() };
    let image = made.seen(&redless);
    let glare = Waterbody { veiling_light: VeilingLight::new([0.95, 0.9, 0.85]), ..water() };
    let reference = Made::new(SEED + 1, Gaze::Ahead).found(&glare);
    for z in [made.depth.clone(), DepthModel::default().estimate(&image)] {
        let content = estimate::<Encoded>(&image, &z, &Default::default()).unwrap();
        for model in [Model::Physical, Model::Exchange] {
            let bounded = Bounded::new(&content, &reference, Options::for_model(model));
            assert!(bounded.bounds.any());
            let law = TransferLaw::new(bounded.waters(), &bounded.options);
            let distances = z.distances();
            let mut sums = [0.0_f64; 3];
            for (pixel, z) in image.pixels().iter().zip(distances) {
                let fused = law.at(z).of(pixel.map(|value| f32::from(value) / 255.0));
                assert!(fused.iter().all(|value| (-0.5..=1.5).contains(value)), "{fused:?}");
                (0..3).for_each(|c| sums[c] += f64::from(fused[c]));
            }
            assert!(sums[0] <= sums[1].max(sums[2]), "{model:?} turned the image red: {sums:?}");
        }
    }
}
