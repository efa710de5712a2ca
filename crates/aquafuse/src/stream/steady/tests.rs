use super::*;
use crate::depth::DepthMap;
use crate::image::Encoded;
use crate::truth::waters;
use crate::waterbody::{Quality, Reason};

const GOOD: fn() -> Quality = Quality::default;

fn depth() -> DepthMap {
    DepthMap::from_levels(2, 1, vec![0, 255]).unwrap()
}

fn estimate(half: f32, quality: Quality) -> Estimate {
    let mut estimate = Estimate::given(waters()[0].water);
    estimate.intervals.veiling_light = [[0.5 - half, 0.5 + half]; 3];
    estimate.intervals.backscatter_coefficient = [[1.0 - half, 1.0 + half]; 3];
    estimate.quality = quality;
    estimate
}

fn doubtful() -> Quality {
    Quality::default().with(Reason::FewDarkPixels)
}

/// B∞ and F at the far end after a frame that says `veil` and e^(-beta z).
fn after(steady: &mut Steady, estimate: &Estimate, veil: f32, beta: f32) -> (f32, f32) {
    let effect =
        |z: f32| WaterEffect { factor: [(-beta * z).exp(); 3], gain: [1.0; 3], ..Default::default() };
    let (veil, _) = steady.follow::<Encoded>(&Frame::of(estimate, [veil; 3], effect, 0.0), &depth());
    (veil[0], steady.water.as_ref().unwrap().effect.at(1.0).factor[0])
}

#[test]
fn frames_of_one_weight_are_averaged_and_then_forgotten() {
    let mut steady = Steady::over(4);
    let sure = estimate(0.01, GOOD());
    let values = [0.5, 0.6, 0.4, 0.5, 0.9];
    let means = values.map(|veil| after(&mut steady, &sure, veil, 1.0).0);
    for (mean, expected) in means.into_iter().zip([0.5, 0.55, 0.5, 0.5, 0.6]) {
        assert!((mean - expected).abs() < 1e-6, "{means:?}");
    }
}

#[test]
fn a_doubtful_frame_and_one_of_wide_intervals_move_little_and_a_sure_one_makes_no_jump() {
    let [sure, unsure, doubted] = [estimate(0.02, GOOD()), estimate(0.3, GOOD()), estimate(0.02, doubtful())];
    let settled = |by: &Estimate| {
        let mut steady = Steady::over(8);
        for _ in 0..40 {
            after(&mut steady, by, 0.5, 1.0);
        }
        steady
    };
    let moved = |by: &Estimate, then: &Estimate| after(&mut settled(by), then, 0.9, 1.0).0 - 0.5;
    let whole = moved(&sure, &sure);
    assert!((whole - 0.4 / 8.0).abs() < 1e-6, "{whole}");
    assert!(moved(&sure, &doubted) < 0.5 * whole && moved(&sure, &unsure) < 0.1 * whole);
    assert!(moved(&unsure, &sure) <= whole + 1e-6);
}

#[test]
fn a_bound_that_comes_and_goes_does_so_slowly() {
    // As red of a doubtful frame that is held to green: F jumps between two values.
    let (good, bad) = (estimate(0.02, GOOD()), estimate(0.02, doubtful()));
    let mut steady = Steady::over(8);
    let mut last = after(&mut steady, &good, 0.5, 2.0).1;
    let jump = (-1.0_f32).exp() - (-2.0_f32).exp();
    for frame in 1..40 {
        let (by, beta) = if frame % 3 == 0 { (&bad, 1.0) } else { (&good, 2.0) };
        let now = after(&mut steady, by, 0.5, beta).1;
        let most = jump / (frame + 1).min(8) as f32;
        assert!((now - last).abs() <= most + 1e-6, "{now} after {last} at frame {frame}");
        last = now;
    }
}

#[test]
fn f_never_rises_with_distance_whatever_the_frames_say() {
    let mut steady = Steady::over(5);
    for frame in 0..20 {
        let beta = 0.3 + (frame * 7 % 5) as f32;
        after(&mut steady, &estimate(0.02 * (1 + frame % 3) as f32, GOOD()), 0.5, beta);
        let effect = &steady.water.as_ref().unwrap().effect;
        let along: Vec<f32> = (0..=1000).map(|i| effect.at(i as f32 / 1000.0).factor[1]).collect();
        assert!(along.windows(2).all(|pair| pair[1] <= pair[0] + 1e-7), "{along:?}");
    }
}

#[test]
fn a_water_that_stays_is_the_frames_own_to_the_bit() {
    let mut steady = Steady::over(8);
    for _ in 0..5 {
        assert_eq!(after(&mut steady, &estimate(0.02, doubtful()), 0.437, 1.3).0, 0.437);
        assert!(steady.effect().is_none());
    }
    after(&mut steady, &estimate(0.02, GOOD()), 0.437, 1.4);
    assert!(steady.effect().is_some());
}
