//! The laws of fusion where a network says where open water is and how far things are.

use aquafuse::depth::DepthModel;
use aquafuse::fuser::{Fuser, Options};
use aquafuse::fusion::Model;
use aquafuse::image::{Encoded, Image};
use aquafuse::stream::Stream;
use aquafuse::truth::{Gaze, OPEN_WATER, Scene, Site, Size, View, waters};
use aquafuse::waterbody::{EstimateOptions, WaterMap, estimate_with_share};

const SIZE: Size = Size { width: 160, height: 120 };

fn seen(scene: &Scene, water: usize) -> Image<u8> {
    scene.seen_through(&waters()[water].water).convert()
}

fn by_network() -> EstimateOptions {
    EstimateOptions::default().with_water_map(WaterMap::Network)
}

fn mirrored(image: &Image<u8>) -> Image<u8> {
    let rows = image.pixels().chunks(image.width());
    let pixels = rows.flat_map(|row| row.iter().rev().copied()).flatten().collect();
    Image::from_raw(image.width(), image.height(), pixels).expect("as many pixels as before")
}

fn options() -> Options {
    Options::default().with_estimate(by_network()).with_depth_model(DepthModel::Network)
}

#[test]
fn the_mirror_image_fuses_to_the_mirror_of_the_fusion() {
    let reference = seen(&Scene::new(2, SIZE), 1);
    for model in [Model::Physical, Model::Aquafuse] {
        let fuser = Fuser::with_options(&reference, options()).unwrap().model(model);
        for water in 0..waters().len() {
            let content = seen(&Scene::new(10 + water as u64, SIZE), water);
            let fused = fuser.fuse(&content).unwrap().image;
            assert_eq!(fuser.fuse(&mirrored(&content)).unwrap().image, mirrored(&fused));
        }
    }
}

#[test]
fn a_first_frame_of_a_stream_is_the_image_by_itself_and_so_is_each_after_a_cut() {
    let fuser = Fuser::with_options(&seen(&Scene::new(2, SIZE), 1), options()).unwrap();
    let frames = [seen(&Scene::new(5, SIZE), 0), seen(&Scene::new(6, SIZE), 3)];
    let by_itself = frames.each_ref().map(|frame| fuser.fuse(frame).unwrap().image);
    let mut stream = Stream::new(fuser.clone());
    for (frame, fused) in frames.iter().zip(&by_itself) {
        // As the frame stands still, so does what becomes of it, when the network looks again too.
        for _ in 0..20 {
            let mut made = frame.clone();
            stream.fuse_mut(&mut made).unwrap();
            assert_eq!(made, *fused);
        }
    }
    let mut each_by_itself = Stream::new(fuser).steady_over(1);
    for i in [0, 1, 0] {
        let mut made = frames[i].clone();
        each_by_itself.fuse_mut(&mut made).unwrap();
        assert_eq!(made, by_itself[i]);
    }
}

#[test]
fn ones_own_water_changes_nothing() {
    let content = seen(&Scene::new(5, SIZE), 0);
    let fuser = Fuser::with_options(&content, options()).unwrap();
    assert_eq!(fuser.fuse(&content).unwrap().image, content);
}

#[test]
fn a_thread_more_or_less_changes_no_bit() {
    let (content, reference) = (seen(&Scene::new(5, SIZE), 0), seen(&Scene::new(2, SIZE), 1));
    let fused = || Fuser::with_options(&reference, options()).unwrap().fuse(&content).unwrap();
    assert_eq!(aquafuse::on_this_thread(fused), fused());
}

#[test]
fn the_share_of_water_is_where_open_water_is() {
    let (mut in_water, mut on_things) = ([0.0, 0.0], [0.0, 0.0]);
    for seed in 500..510 {
        let scene = Scene::new(seed, SIZE);
        let image = seen(&scene, seed as usize % 4);
        let z = DepthModel::default().estimate(&image);
        let (_, share) = estimate_with_share::<Encoded>(&image, &z, &by_network()).unwrap();
        for (i, pixel) in image.pixels().iter().enumerate() {
            let w = share.at(i % SIZE.width, i / SIZE.width, pixel.map(|value| f32::from(value) / 255.0));
            let sum = if scene.depth.at(i % SIZE.width, i / SIZE.width) >= OPEN_WATER {
                &mut in_water
            } else {
                &mut on_things
            };
            sum[0] += f64::from(w);
            sum[1] += 1.0;
        }
    }
    let [water, things] = [in_water, on_things].map(|[sum, count]| sum / count);
    assert!(water > 0.75 && things < 0.3, "{water} {things}");
}

#[test]
fn where_the_floor_fills_the_image_no_water_is_seen() {
    let mean = |gaze: Gaze| {
        (0..8).fold(0.0, |sum, number| {
            let scene = Scene::of(View { site: Site::Harbour, gaze }, 600 + number, SIZE);
            let image = seen(&scene, number as usize % 5);
            let z = DepthModel::default().estimate(&image);
            let (_, share) = estimate_with_share::<Encoded>(&image, &z, &by_network()).unwrap();
            sum + share.mean() / 8.0
        })
    };
    let (down, ahead) = (mean(Gaze::Down), mean(Gaze::Ahead));
    assert!(down < 0.05 && ahead > 4.0 * down, "{down} {ahead}");
}
