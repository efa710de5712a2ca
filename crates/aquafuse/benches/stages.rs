//! Each stage of a frame, and the whole frame, at the paper's smallest and largest size.
//!
//! cargo bench -p aquafuse

use aquafuse::depth::{self, DepthMap, DepthModel};
use aquafuse::fusion::{Model, Options, Waters, fuse_mut};
use aquafuse::image::{Encoded, Image};
use aquafuse::smooth::bilateral;
use aquafuse::truth::{Scene, Size, waters};
use aquafuse::waterbody::{EstimateOptions, Waterbody, estimate, estimate_with_share};
use divan::Bencher;

const SIZES: [(usize, usize); 2] = [(256, 256), (1920, 1080)];

fn main() {
    divan::main();
}

/// A scene of a quarter the width and height, each pixel repeated: what is timed does not depend on detail.
fn picture(width: usize, height: usize) -> Image<u8> {
    let scene = Scene::new(1, Size { width: width / 4, height: height / 4 });
    let small: Image<u8> = scene.seen_through(&waters()[0].water).convert();
    let repeated = |y: usize| {
        (0..width).flat_map({
            let small = &small;
            move |x| small.pixels()[(y / 4) * small.width() + x / 4]
        })
    };
    Image::from_raw(width, height, (0..height).flat_map(repeated).collect()).expect("three samples a pixel")
}

fn prepared((width, height): (usize, usize)) -> (Image<u8>, DepthMap, Waterbody) {
    let image = picture(width, height);
    let z = depth::estimate(&image);
    let water = water_of(&image, &z);
    (image, z, water)
}

fn water_of(image: &Image<u8>, z: &DepthMap) -> Waterbody {
    estimate::<Encoded>(image, z, &EstimateOptions::default()).expect("the depth map is the image's").water
}

#[divan::bench(args = SIZES)]
fn depth_unfiltered(bencher: Bencher<'_, '_>, (width, height): (usize, usize)) {
    let image = picture(width, height);
    bencher.bench_local(|| DepthModel::default().estimate_unfiltered(&image));
}

#[divan::bench(args = SIZES)]
fn depth_by_median(bencher: Bencher<'_, '_>, (width, height): (usize, usize)) {
    let image = picture(width, height);
    bencher.bench_local(|| DepthModel::Eq3Median.estimate(&image));
}

#[divan::bench(args = SIZES)]
fn depth_refined(bencher: Bencher<'_, '_>, (width, height): (usize, usize)) {
    let image = picture(width, height);
    bencher.bench_local(|| depth::estimate(&image));
}

#[divan::bench(args = SIZES)]
fn waterbody(bencher: Bencher<'_, '_>, size: (usize, usize)) {
    let (image, z, _) = prepared(size);
    bencher.bench_local(|| water_of(&image, &z));
}

#[divan::bench(args = SIZES)]
fn fusion_in_place(bencher: Bencher<'_, '_>, size: (usize, usize)) {
    let (mut image, z, water) = prepared(size);
    let reference = waters()[1].water;
    let exchanged = Waters::new(&water, &reference);
    bencher.bench_local(|| fuse_mut(&mut image, &z, exchanged, &Options::for_model(Model::Aquafuse)));
}

/// With a share of open water; the light on near things changes where the model reads it.
fn with_a_share_of_water(bencher: Bencher<'_, '_>, size: (usize, usize), model: Model) {
    let (mut image, z, _) = prepared(size);
    let (own, share) = estimate_with_share(&image, &z, &EstimateOptions::default()).expect("one size");
    let reference = waters()[1].water;
    let exchanged = Waters::new(&own.water, &reference).with_share(&share).with_light_gain([0.8, 1.1, 1.3]);
    bencher.bench_local(|| fuse_mut(&mut image, &z, exchanged, &Options::for_model(model)));
}

#[divan::bench(args = SIZES)]
fn fusion_with_a_share_of_water(bencher: Bencher<'_, '_>, size: (usize, usize)) {
    with_a_share_of_water(bencher, size, Model::Physical);
}

#[divan::bench(args = SIZES)]
fn light_with_a_share_of_water(bencher: Bencher<'_, '_>, size: (usize, usize)) {
    with_a_share_of_water(bencher, size, Model::Relight);
}

#[divan::bench(args = SIZES)]
fn exchange_in_place(bencher: Bencher<'_, '_>, size: (usize, usize)) {
    let (mut image, z, water) = prepared(size);
    let reference = waters()[1].water;
    let exchanged = Waters::new(&water, &reference);
    bencher.bench_local(|| fuse_mut(&mut image, &z, exchanged, &Options::for_model(Model::Exchange)));
}

#[divan::bench(args = SIZES)]
fn smoothing(bencher: Bencher<'_, '_>, (width, height): (usize, usize)) {
    let image = picture(width, height);
    bencher.bench_local(|| bilateral(&image));
}

#[divan::bench(args = SIZES)]
fn frame(bencher: Bencher<'_, '_>, size: (usize, usize)) {
    let (mut image, _, _) = prepared(size);
    let reference = waters()[1].water;
    bencher.bench_local(|| {
        let z = depth::estimate(&image);
        let water = water_of(&image, &z);
        fuse_mut(&mut image, &z, Waters::new(&water, &reference), &Options::for_model(Model::Aquafuse))
    });
}
