//! What is shown of an estimate is what it was fitted to.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

use aquafuse::formation::form;
use aquafuse::image::{Encoded, Image};
use aquafuse::truth::{OPEN_WATER, Scene, Size, waters};
use aquafuse::waterbody::{DepthBin, Estimate, Evidence, VeilingLightSource, estimate, evidence};

const SIZE: Size = Size { width: 240, height: 160 };

/// A place in which every third pixel of every third row is black, as a camera sees it.
fn with_black(seed: u64) -> (Image<u8>, Scene) {
    let mut scene = Scene::new(seed, SIZE);
    let distances = scene.depth.distances();
    for (i, pixel) in scene.clear.pixels_mut().iter_mut().enumerate() {
        let [x, y] = [i % SIZE.width, i / SIZE.width];
        if x.is_multiple_of(3) && y.is_multiple_of(3) && distances[i] < OPEN_WATER {
            *pixel = [0.0; 3];
        }
    }
    let seen = form(&scene.clear, &scene.depth, &waters()[0].water).unwrap().convert();
    (seen, scene)
}

fn found() -> (Image<u8>, Scene, Estimate, Evidence) {
    let (seen, scene) = with_black(7);
    let estimated = estimate::<Encoded>(&seen, &scene.depth, &Default::default()).unwrap();
    let shown = evidence::<Encoded>(&seen, &scene.depth, &Default::default()).unwrap();
    (seen, scene, estimated, shown)
}

#[test]
fn the_darkest_things_lie_on_the_curve_of_backscatter_where_there_is_black() {
    let (_, _, Estimate { water, .. }, shown) = found();
    assert!(shown.bins.len() > 20, "{}", shown.bins.len());
    for c in 0..3 {
        let off = |bin: &DepthBin| (bin.dark[c] - water.backscatter(bin.z)[c]).abs();
        let mut off: Vec<f32> = shown.bins.iter().map(off).collect();
        off.sort_by(f32::total_cmp);
        // The darkest things of a wide bin are those of its near end.
        let (median, largest) = (off[off.len() / 2], off[off.len() - 1]);
        assert!(median < 0.015 && largest < 0.05, "channel {c}: {off:?}");
    }
    assert!(shown.bins.is_sorted_by(|near, far| near.z <= far.z));
}

#[test]
fn what_is_left_of_the_light_scatters_about_its_curve() {
    let (_, _, Estimate { water, .. }, shown) = found();
    for c in 0..3 {
        let off: Vec<f32> = shown
            .bins
            .iter()
            .filter_map(|bin| Some((bin.illumination[c]? / water.illumination(bin.z)[c]).ln()))
            .collect();
        let mean = off.iter().sum::<f32>() / off.len() as f32;
        assert!(off.len() > 10 && mean.abs() < 0.15, "channel {c}: {mean} over {} bins", off.len());
    }
}

#[test]
fn the_pixels_read_are_open_water_of_the_veils_colour() {
    let (seen, scene, estimated, shown) = found();
    assert_eq!(estimated.veiling_light_source, VeilingLightSource::OpenWater);
    let read: Vec<usize> = (0..shown.read_from.len()).filter(|&i| shown.read_from[i]).collect();
    let share = read.len() as f32 / shown.read_from.len() as f32;
    assert!((share - estimated.veiling_light_share).abs() < 0.02, "{share}");
    let distances = scene.depth.distances();
    let open = read.iter().filter(|&&i| distances[i] >= OPEN_WATER).count();
    assert!(open as f32 > 0.95 * read.len() as f32, "{open} of {}", read.len());
    let veil = estimated.water.veiling_light.rgb()[2];
    let mean = read.iter().map(|&i| f32::from(seen.pixels()[i][2]) / 255.0).sum::<f32>() / read.len() as f32;
    assert!((mean - veil).abs() < 0.02, "{mean} beside {veil}");
}
