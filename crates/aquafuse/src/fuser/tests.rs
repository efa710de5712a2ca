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
    let report = Report { content: own, bounds: bounded.bounds, clipping: fused.clipping };
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
