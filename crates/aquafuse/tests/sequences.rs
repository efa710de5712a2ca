//! Laws of sequences: water that changes smoothly, on frames of known truth.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

use aquafuse::formation::{BoundedRestoration, RestoreOptions, form};
use aquafuse::fusion::Model;
use aquafuse::image::{Image, ImageError};
use aquafuse::levels::{Levels, LevelsOptions, Setting};
use aquafuse::metrics::Flicker;
use aquafuse::stream::{EnhanceStream, RestoreStream, Stream};
use aquafuse::truth::{Pose, Scene, Size, View, waters};
use aquafuse::{Fuser, depth, waterbody};

const SIZE: Size = Size { width: 96, height: 64 };

struct Shot {
    frame: Image<u8>,
    /// The frame in the other water.
    truth: Image<f32>,
}

/// What a camera passes that moves ahead and turns.
fn passed(seed: u64, count: u16) -> Vec<Scene> {
    let scene = |frame: u16| {
        let t = f32::from(frame) / f32::from(count - 1);
        let pose = Pose { moved: [0.6 * t, 0.0, 0.8 * t], yaw: 0.15 * t, pitch: 0.15, ..Pose::default() };
        Scene::from(View::default(), seed, &pose, SIZE)
    };
    (0..count).map(scene).collect()
}

/// What it sees in `light` that depends on the time from 0 to 1.
fn shots(scenes: &[Scene], light: impl Fn(f32) -> f32) -> Vec<Shot> {
    let shot = |(frame, scene): (usize, &Scene)| {
        let t = frame as f32 / (scenes.len() - 1) as f32;
        let lit = |image: &Image<f32>| {
            let values = image.as_raw().iter().map(|value| light(t) * value).collect();
            Image::<f32>::from_raw(SIZE.width, SIZE.height, values).unwrap()
        };
        let frame = lit(&scene.seen_through(&waters()[0].water)).convert();
        let truth = form(&lit(&scene.clear), &scene.depth, &waters()[1].water).unwrap();
        Shot { frame, truth }
    };
    scenes.iter().enumerate().map(shot).collect()
}

fn reference() -> Image<u8> {
    Scene::new(9, SIZE).seen_through(&waters()[1].water).convert()
}

fn fused(stream: &mut Stream<'_>, frame: &Image<u8>) -> Image<u8> {
    let mut fused = frame.clone();
    stream.fuse_mut(&mut fused).unwrap();
    fused
}

#[test]
fn the_first_frame_is_the_picture_by_itself_and_a_constant_picture_gives_a_constant_output() {
    let frame = &shots(&passed(1, 2), |_| 1.0)[0].frame;
    for &model in Model::ALL {
        let fuser = Fuser::new(&reference()).unwrap().model(model);
        let alone = fuser.fuse(frame).unwrap().image;
        let mut stream = Stream::new(fuser);
        for _ in 0..12 {
            assert_eq!(fused(&mut stream, frame), alone);
        }
    }
}

#[test]
fn ones_own_water_returns_the_picture() {
    let frame = &shots(&passed(2, 2), |_| 1.0)[0].frame;
    for &model in Model::ALL {
        let mut stream = Stream::new(Fuser::new(frame).unwrap().model(model));
        for _ in 0..3 {
            assert_eq!(fused(&mut stream, frame), *frame);
        }
    }
}

#[test]
fn without_a_mean_and_after_a_cut_each_frame_is_by_itself() {
    let shots = shots(&passed(3, 5), |t| 1.0 - 0.3 * t);
    let fuser = Fuser::new(&reference()).unwrap();
    let (mut alone, mut steady) = (Stream::new(fuser.clone()).steady_over(1), Stream::new(fuser.clone()));
    let mut differ = 0;
    for shot in &shots {
        let expected = fuser.fuse(&shot.frame).unwrap().image;
        assert_eq!(fused(&mut alone, &shot.frame), expected);
        differ += usize::from(fused(&mut steady, &shot.frame) != expected);
    }
    assert!(differ > 0);
    let other: Image<u8> = Scene::new(5, SIZE).seen_through(&waters()[3].water).convert();
    assert_eq!(fused(&mut steady, &other), fuser.fuse(&other).unwrap().image);
}

/// Mean distance of what a stream makes from the truth, and how much it flickers.
fn judged(shots: &[Shot], stream: &mut Stream<'_>) -> (f64, f64) {
    let mut flicker = Flicker::default();
    let mut off = 0.0;
    for shot in shots {
        let fused = fused(stream, &shot.frame);
        flicker.add(&shot.frame, &fused).unwrap();
        let values = fused.as_raw().iter().zip(shot.truth.as_raw());
        off += values.map(|(value, truth)| f64::from((f32::from(*value) / 255.0 - truth).abs())).sum::<f64>();
    }
    (off / (shots.len() * 3 * SIZE.width * SIZE.height) as f64, flicker.changes()[1])
}

#[test]
fn a_moving_camera_in_changing_light_flickers_less_and_is_no_farther_from_the_truth() {
    let slow = |t: f32| 1.0 - 0.25 * (std::f32::consts::PI * t).sin();
    let jump = |t: f32| if t < 0.5 { 1.0 } else { 0.7 };
    let (mut all, mut steady_all) = ((0.0, 0.0), (0.0, 0.0));
    for seed in [5, 7] {
        let scenes = passed(seed, 28);
        for shots in [shots(&scenes, slow), shots(&scenes, jump)] {
            for model in [Model::Physical, Model::Exchange] {
                let fuser = Fuser::new(&reference()).unwrap().model(model);
                let alone = judged(&shots, &mut Stream::new(fuser.clone()).steady_over(1));
                let steady = judged(&shots, &mut Stream::new(fuser));
                assert!(steady.0 < 1.1 * alone.0, "{model:?}, {seed}: {steady:?} beside {alone:?}");
                all = (all.0 + alone.0, all.1 + alone.1);
                steady_all = (steady_all.0 + steady.0, steady_all.1 + steady.1);
            }
        }
    }
    assert!(steady_all.0 < 1.02 * all.0 && steady_all.1 < all.1, "{steady_all:?} beside {all:?}");
}

#[test]
fn a_given_water_is_that_of_every_frame() {
    let shots = shots(&passed(4, 4), |t| 1.0 - 0.2 * t);
    let estimates: Vec<_> = shots
        .iter()
        .map(|shot| {
            waterbody::estimate(&shot.frame, &depth::estimate(&shot.frame), &Default::default()).unwrap()
        })
        .collect();
    let pooled = waterbody::pool(&estimates).unwrap();
    let mut stream = Stream::new(Fuser::new(&reference()).unwrap()).content_water(pooled);
    for shot in &shots {
        fused(&mut stream, &shot.frame);
        assert_eq!(stream.content(), Some(&pooled));
    }
}

#[test]
fn a_restored_and_an_enhanced_sequence_begin_as_the_picture_by_itself_and_stay_if_it_stays()
-> Result<(), ImageError> {
    let frame = &shots(&passed(6, 2), |_| 1.0)[0].frame;
    let plain = LevelsOptions::default().with_white(Setting::None).with_exposure(Setting::None);
    for options in [LevelsOptions::default(), plain] {
        let z = depth::estimate(frame);
        let found = waterbody::estimate(frame, &z, &Default::default())?;
        let bounded = BoundedRestoration::new(frame, &z, &found, &RestoreOptions::default())?;
        let mut alone = frame.clone();
        if options.sets_nothing() {
            aquafuse::formation::restore_mut(&mut alone, &z, &bounded.water, &bounded.options)?;
        } else {
            let levels = bounded.levels(frame, &z, &options)?;
            bounded.restore_and_level_mut(&mut alone, &z, &levels)?;
        }
        let mut stream = RestoreStream::default().levels(options);
        for _ in 0..10 {
            let mut restored = frame.clone();
            let report = stream.restore_mut(&mut restored)?;
            assert_eq!((&restored, report.content, report.bounds), (&alone, found, bounded.bounds));
        }
    }
    let mut alone = frame.clone();
    Levels::of(frame, &LevelsOptions::default()).apply(&mut alone);
    let mut stream = EnhanceStream::default();
    for _ in 0..10 {
        let mut enhanced = frame.clone();
        stream.enhance_mut(&mut enhanced)?;
        assert_eq!(enhanced, alone);
    }
    Ok(())
}

#[test]
fn restoration_and_enhancement_flicker_less_and_leave_a_border() -> Result<(), ImageError> {
    let shots = shots(&passed(8, 20), |t| 1.0 - 0.25 * (std::f32::consts::PI * t).sin());
    let changes = |frames: usize| -> Result<[f64; 2], ImageError> {
        let (mut restore, mut enhance) =
            (RestoreStream::default().steady_over(frames), EnhanceStream::default().steady_over(frames));
        let mut flicker = [Flicker::default(); 2];
        for shot in &shots {
            let mut frame = shot.frame.clone();
            frame.view_mut().rows_mut().take(10).for_each(|row| row.fill([16; 3]));
            let (mut restored, mut enhanced) = (frame.clone(), frame.clone());
            assert_eq!(restore.restore_mut(&mut restored)?.margins.top, 10);
            enhance.enhance_mut(&mut enhanced)?;
            for (flicker, made) in flicker.iter_mut().zip([&restored, &enhanced]) {
                assert!((0..10).all(|y| made.row(y) == frame.row(y)));
                flicker.add(&frame, made)?;
            }
        }
        Ok(flicker.map(|flicker| flicker.changes()[1]))
    };
    let (alone, steady) = (changes(1)?, changes(8)?);
    assert!((0..2).all(|i| steady[i] < alone[i]), "{steady:?} beside {alone:?}");
    Ok(())
}
