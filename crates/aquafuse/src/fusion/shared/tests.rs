use super::super::{Model, Options, Waters, fuse, fuse_mut};
use super::*;
use crate::depth;
use crate::image::Image;
use crate::simd::Level;
use crate::truth::{Scene, Size, waters};
use crate::waterbody::{Estimate, EstimateOptions, estimate_with_share};

struct Case {
    content: Image<u8>,
    depth: DepthMap,
    own: Estimate,
    share: WaterShare,
}

/// A scene with open water in view.
fn case(width: usize, height: usize) -> Case {
    let seen = |seed| {
        let content: Image<u8> =
            Scene::new(seed, Size { width, height }).seen_through(&waters()[0].water).convert();
        let depth = depth::estimate(&content);
        let (own, share) = estimate_with_share(&content, &depth, &EstimateOptions::default()).unwrap();
        (!share.is_none()).then_some(Case { content, depth, own, share })
    };
    (0..20).find_map(seen).expect("open water is in view of some")
}

impl Case {
    fn waters<'a>(&'a self, reference: &'a crate::waterbody::Waterbody) -> Waters<'a, crate::image::Encoded> {
        Waters::new(&self.own.water, reference)
            .with_depth_factors(self.own.depth_factors.as_ref())
            .with_share(&self.share)
            .with_light_gain([0.6, 1.3, 1.8])
    }

    fn fused(&self, model: Model) -> Image<u8> {
        let reference = waters()[1].water;
        fuse(&self.content, &self.depth, self.waters(&reference), &Options::for_model(model)).unwrap().image
    }
}

#[test]
fn bytes_are_the_fusion_of_floats_within_a_step() {
    let case = case(131, 97);
    let reference = waters()[1].water;
    for model in [Model::Physical, Model::Relight, Model::Exchange] {
        let options = Options::for_model(model);
        let exact = fuse(&case.content.convert::<f32>(), &case.depth, case.waters(&reference), &options)
            .unwrap()
            .image;
        for (byte, exact) in case.fused(model).as_raw().iter().zip(exact.as_raw()) {
            assert!(
                (f32::from(*byte) - 255.0 * exact).abs() <= 0.5 + 1.0 / 32.0,
                "{byte} is not {}",
                255.0 * exact
            );
        }
    }
}

#[test]
fn no_instructions_and_no_padding_change_a_bit() {
    let case = case(601, 200);
    let reference = waters()[1].water;
    for model in [Model::Physical, Model::Relight, Model::Exchange] {
        let expected = case.fused(model);
        for level in Level::all() {
            assert_eq!(level.force(|| case.fused(model)), expected);
        }
        let (width, height) = expected.size();
        let stride = 3 * width + 7;
        let mut buffer = vec![9; stride * height];
        for y in 0..height {
            buffer[y * stride..][..3 * width].copy_from_slice(case.content.row(y).as_flattened());
        }
        let view = ImageMut::with_stride(width, height, stride, &mut buffer).unwrap();
        let _ = fuse_mut(view, &case.depth, case.waters(&reference), &Options::for_model(model)).unwrap();
        for y in 0..height {
            assert_eq!(&buffer[y * stride..][..3 * width], expected.row(y).as_flattened());
            assert!(buffer[y * stride..][3 * width..stride].iter().all(|&value| value == 9));
        }
    }
}

#[test]
fn one_at_a_time_and_row_by_row_a_share_is_the_same() {
    let case = case(75, 50);
    let mut rows = case.share.rows();
    for (y, pixels) in case.content.rows().enumerate() {
        let found = rows.row::<u8, crate::image::Encoded>(y, pixels).to_vec();
        for (x, pixel) in pixels.iter().enumerate() {
            assert_eq!(case.share.at(x, y, pixel.map(Sample::to_unit)), found[x]);
        }
    }
}

#[cfg(feature = "threads")]
#[test]
fn threads_change_no_bit() {
    let case = case(900, 300);
    let on = |model, threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| case.fused(model))
    };
    for model in [Model::Physical, Model::Relight] {
        assert_eq!(on(model, 1), on(model, 3));
    }
}

#[test]
fn the_nearest_whole_number_is_that_of_the_library() {
    for value in [0.0, 0.25, 0.5, 1.5, 2.4999, 65279.5, 65280.0] {
        for value in [value, -value] {
            assert_eq!(nearest(value), f32::round(value));
        }
    }
    assert!(nearest(f32::NAN).is_nan());
}
