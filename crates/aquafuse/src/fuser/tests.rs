use super::*;
use crate::truth::{Scene, Size, waters};
use crate::waterbody::{Quality, Reason, VeilingLight};

const SIZE: Size = Size { width: 64, height: 48 };

fn scene(seed: u64, water: usize) -> (Image<f32>, DepthMap) {
    let scene = Scene::new(seed, SIZE);
    (scene.seen_through(&waters()[water].water), scene.depth)
}

/// The steps one by one.
fn by_steps<T: Sample>(content: &Image<T>, depth: Option<&DepthMap>, fuser: &Fuser<'_>) -> Outcome<T> {
    let options = fuser.options();
    let depth = depth.cloned().unwrap_or_else(|| options.depth_model.estimate(content));
    let (own, share) = waterbody::estimate_with_share(&content.convert(), &depth, &options.estimate).unwrap();
    let bounded = Bounded::new(&own, fuser.reference(), options.fusion);
    let waters = bounded.waters().with_share(&share);
    let fused = fusion::fuse(content, &depth, waters, &bounded.options).unwrap();
    let margins = Margins::default();
    let report = Report { content: own, bounds: bounded.bounds, clipping: fused.clipping, margins };
    Outcome { image: options.smoothing.apply(fused.image), report }
}

fn check<T: Sample>(content: &Image<T>, z: &DepthMap, reference: &Image<T>) {
    for (model, smoothing) in Model::ALL.iter().copied().zip(Smoothing::ALL.iter().copied().cycle()) {
        for &depth_model in DepthModel::ALL {
            let options = Options { depth_model, smoothing, ..Options::default() };
            let fuser = Fuser::with_options(reference, options).unwrap().model(model);
            let depth = depth_model.estimate(reference);
            let water = waterbody::estimate(&reference.convert(), &depth, &options.estimate).unwrap();
            assert_eq!(*fuser.reference(), water);
            let expected = by_steps(content, None, &fuser);
            assert_eq!(fuser.fuse(content).unwrap(), expected);
            let (mut in_place, mut into) = (content.clone(), reference.clone());
            assert_eq!(fuser.fuse_mut(&mut in_place), Ok(expected.report));
            assert_eq!(fuser.fuse_into(content, &mut into), Ok(expected.report));
            assert_eq!((&in_place, &into), (&expected.image, &expected.image));
            let expected = by_steps(content, Some(z), &fuser);
            assert_eq!(fuser.depth(z).fuse(content).unwrap(), expected);
        }
    }
}

#[test]
fn the_front_door_gives_what_the_steps_give_for_every_sample_model_and_depth() {
    let ((content, z), (reference, _)) = (scene(1, 0), scene(2, 1));
    check(&content, &z, &reference);
    check::<u16>(&content.convert(), &z, &reference.convert());
    check::<u8>(&content.convert(), &z, &reference.convert());
}

#[test]
fn a_depth_map_of_the_reference_is_what_its_water_is_estimated_from() {
    let (reference, z) = scene(2, 1);
    let fuser = Fuser::with_depth(&reference, &z, Options::default()).unwrap();
    let expected = waterbody::estimate(&reference.convert(), &z, &Default::default()).unwrap();
    assert_eq!((*fuser.reference(), fuser.reference().depth_model), (expected, None));
}

#[test]
fn bounds_are_on_without_asking() {
    let mut glare = Estimate::given(waters()[1].water);
    glare.water.veiling_light = VeilingLight::new([0.95, 0.92, 0.9]);
    glare.quality = Quality::default().with(Reason::LightOutsideWaterHues);
    let (content, z) = scene(1, 0);
    let outcome = Fuser::from(glare).model(Model::Physical).depth(&z).fuse(&content).unwrap();
    assert!(outcome.report.bounds.glare);
}

#[test]
fn theta_stays_whether_it_comes_before_the_model_or_after() {
    let fuser = || Fuser::from(waters()[0].water);
    let [before, after] = [
        fuser().theta(20.0).unwrap().model(Model::Physical),
        fuser().model(Model::Physical).theta(20.0).unwrap(),
    ];
    assert_eq!(before.options(), after.options());
    assert_eq!(fuser().model(Model::Physical).options().fusion, fusion::Options::for_model(Model::Physical));
    assert!(fuser().theta(91.0).is_err() && fuser().alpha(-1.0).is_err());
}

#[test]
fn sizes_that_differ_are_an_error_and_change_nothing() {
    let (mut content, z) = scene(1, 0);
    let wide = Image::<f32>::from_raw(65, 48, vec![0.5; 3 * 65 * 48]).unwrap();
    let error = ImageError::Mismatch { left: (65, 48), right: (64, 48) };
    let fuser = Fuser::from(waters()[0].water);
    assert_eq!(fuser.clone().depth(&z).fuse(&wide).unwrap_err(), error);
    let before = content.clone();
    assert_eq!(fuser.fuse_into(&wide, &mut content).unwrap_err(), error);
    assert_eq!(content, before);
    assert!(Fuser::with_depth(&wide, &z, Options::default()).is_err());
}

/// An image between bars of grey.
fn letterboxed(scene: &Image<u8>, grey: u8) -> (Image<u8>, SceneArea) {
    let (width, height) = (scene.width() + 12, scene.height() + 20);
    let mut image = Image::<u8>::from_raw(width, height, vec![grey; 3 * width * height]).unwrap();
    let margins = Margins { top: 9, right: 5, bottom: 11, left: 7 };
    let area = SceneArea::of(&image, Border::Given(margins)).unwrap();
    area.put_back(scene, &mut image).unwrap();
    (image, area)
}

#[test]
fn a_letterboxed_scene_comes_out_as_the_bare_one_and_the_bars_keep_every_byte() {
    let ((content, z), (reference, _)) = (scene(3, 0), scene(2, 1));
    let (content, reference) = (content.convert::<u8>(), reference.convert::<u8>());
    for (model, smoothing) in Model::ALL.iter().copied().zip(Smoothing::ALL.iter().copied().cycle()) {
        for grey in [0, 16, 114, 255] {
            let options = Options { smoothing, ..Options::default() };
            let fuser = Fuser::with_options(&reference, options).unwrap().model(model);
            let in_bars =
                Fuser::with_options(&letterboxed(&reference, grey).0, options).unwrap().model(model);
            assert_eq!(in_bars.reference(), fuser.reference());
            let (image, area) = letterboxed(&content, grey);
            let (bare, fused) = (fuser.fuse(&content).unwrap(), fuser.fuse(&image).unwrap());
            let mut expected = image.clone();
            area.put_back(&bare.image, &mut expected).unwrap();
            assert_eq!(fused.image, expected, "{model} in {grey}");
            assert_eq!(fused.report, Report { margins: area.margins(), ..bare.report });
            let mut in_place = image.clone();
            assert_eq!(fuser.fuse_mut(&mut in_place), Ok(fused.report));
            assert_eq!(in_place, expected);
            // Supplied depth is that of the whole image.
            let whole = area.spread(&z.distances(), &0.0);
            let whole = DepthMap::from_distances(image.width(), image.height(), z.kind(), whole).unwrap();
            let bare = fuser.clone().depth(&z).fuse(&content).unwrap();
            area.put_back(&bare.image, &mut expected).unwrap();
            assert_eq!(fuser.depth(&whole).fuse(&image).unwrap().image, expected);
        }
    }
}

#[test]
fn without_a_border_every_pixel_is_scene() {
    let (image, area) = letterboxed(&scene(3, 0).0.convert(), 16);
    let options = Options::default().with_border(Border::None);
    let fused = Fuser::with_options(&scene(2, 1).0, options).unwrap().model(Model::Physical).fuse(&image);
    assert_eq!(fused.unwrap().report.margins, Margins::default());
    let all = Border::Given(Margins { top: 70, ..Margins::default() });
    let fuser = Fuser::with_options(&scene(2, 1).0, options.with_border(all)).unwrap();
    assert!(matches!(fuser.fuse(&image), Err(ImageError::Border(_))), "{area:?}");
}
