//! Padding changes nothing: every function gives the same bits with it, and leaves it alone.

use proptest::prelude::*;

use super::*;
use crate::depth::fit::Fitter;
use crate::depth::{DepthKind, DepthMap, DepthModel, Supplied, SuppliedKind};
use crate::formation::{self, BoundedRestoration, RestoreOptions};
use crate::fuser::Fuser;
use crate::fusion::{self, Model, Options, Waters};
use crate::image::{Linear, TopEdge};
use crate::simd::Level;
use crate::stream::Stream;
use crate::truth::waters;
use crate::waterbody::{self, BackscatterMethod, Estimate, EstimateOptions, WaterMap, Waterbody};
use crate::{metrics, smooth};

/// Samples to fill padding with that would show if they were read, and their bits.
trait Filler: Sample {
    fn filler(i: usize) -> Self;
    fn bits(self) -> u32;
}

impl Filler for u8 {
    fn filler(i: usize) -> Self {
        [255, 0, 129][i % 3]
    }
    fn bits(self) -> u32 {
        self.into()
    }
}

impl Filler for u16 {
    fn filler(i: usize) -> Self {
        [65535, 0, 33_001][i % 3]
    }
    fn bits(self) -> u32 {
        self.into()
    }
}

impl Filler for f32 {
    fn filler(i: usize) -> Self {
        [Self::NAN, Self::INFINITY, -7.0][i % 3]
    }
    fn bits(self) -> u32 {
        self.to_bits()
    }
}

/// An image as a camera hands it over: padding between its rows, and behind the last.
struct Padded<T> {
    size: (usize, usize),
    stride: usize,
    buffer: Vec<T>,
}

impl<T: Filler> Padded<T> {
    fn of<E: Encoding>(image: &Image<T, E>, padding: usize) -> Self {
        let stride = 3 * image.width() + padding;
        let mut buffer = Vec::new();
        for row in image.rows() {
            buffer.extend_from_slice(row.as_flattened());
            buffer.extend((0..padding).map(T::filler));
        }
        Self { size: image.size(), stride, buffer }
    }

    fn view<E: Encoding>(&self) -> ImageRef<'_, T, E> {
        ImageRef::with_stride(self.size.0, self.size.1, self.stride, &self.buffer).unwrap()
    }

    fn view_mut<E: Encoding>(&mut self) -> ImageMut<'_, T, E> {
        ImageMut::with_stride(self.size.0, self.size.1, self.stride, &mut self.buffer).unwrap()
    }

    /// Whether the padding is what it was.
    fn is_untouched(&self) -> bool {
        let padding = |samples: &[T]| samples[3 * self.size.0..].iter().map(|v| v.bits()).collect::<Vec<_>>();
        self.buffer.chunks(self.stride).all(|row| {
            let found = padding(row);
            found.iter().enumerate().all(|(i, bits)| *bits == T::filler(i).bits())
        })
    }

    /// Applies `change` and gives the pixels; the padding must not change.
    fn after<E: Encoding, R>(mut self, change: impl FnOnce(ImageMut<'_, T, E>) -> R) -> (Image<T, E>, R) {
        let result = change(self.view_mut());
        assert!(self.is_untouched(), "padding was written");
        (self.view().to_image(), result)
    }
}

/// A gradient of water colours with some noise in it: everything finds something.
fn picture<T: Sample, E: Encoding>(width: usize, height: usize, seed: usize) -> Image<T, E> {
    let sample = |i: usize| {
        let (x, y, c) = (i / 3 % width, i / 3 / width, i % 3);
        let noise = (i + seed).wrapping_mul(2_654_435_761) >> 16 & 63;
        let base = [140 * y / height, 60 + 90 * x / width, 170 - 60 * y / height][c];
        T::from_unit((base + noise) as f32 / 255.0)
    };
    Image::from_raw(width, height, (0..3 * width * height).map(sample).collect()).unwrap()
}

fn depths(width: usize, height: usize) -> [DepthMap; 3] {
    let fine = |i: usize| (i * 7919 % 65_521) as u16;
    let places = 0..width * height;
    let metres = places.clone().map(|i| f32::from(fine(i)) / 9_000.0).collect();
    [
        DepthMap::from_levels(width, height, places.clone().map(|i| (i * 31) as u8).collect()).unwrap(),
        DepthMap::from_fine_levels(width, height, places.map(fine).collect()).unwrap(),
        DepthMap::from_distances(width, height, DepthKind::Metres, metres).unwrap(),
    ]
}

/// What works on all samples and encodings.
fn check_physics<T: Filler, E: Encoding>(image: &Image<T, E>, water: &Waterbody<E>, padding: usize) {
    let (width, height) = image.size();
    let padded = || Padded::of(image, padding);
    let other = Waterbody { veiling_light: waterbody::VeilingLight::new([0.3, 0.5, 0.2]), ..*water };
    let target = picture::<T, E>(width, height, 99);
    for z in &depths(width, height) {
        for &model in Model::ALL {
            let (waters, options) = (Waters::new(water, &other), Options::for_model(model));
            let fused = fusion::fuse(image, z, waters, &options).unwrap();
            assert_eq!(fusion::fuse(padded().view(), z, waters, &options).unwrap(), fused);
            let expected = (fused.image, fused.clipping);
            let in_place = padded().after(|view| fusion::fuse_mut(view, z, waters, &options).unwrap());
            assert_eq!(in_place, expected);
            let (from, to) = (padded(), Padded::of(&target, padding + 2));
            let into = to.after(|view| fusion::fuse_into(from.view(), z, waters, &options, view).unwrap());
            assert_eq!(into, expected);
            let to = Padded::of(&target, padding);
            assert_eq!(
                to.after(|view| fusion::fuse_into(image, z, waters, &options, view).unwrap()),
                expected
            );
        }
        let options = RestoreOptions::default();
        let (from, estimate) = (padded(), Estimate::given(*water));
        assert_eq!(formation::form(from.view(), z, water), formation::form(image, z, water));
        let restored = formation::restore(image, z, water, &options);
        assert_eq!(formation::restore(from.view(), z, water, &options), restored);
        let bounded = BoundedRestoration::new(image, z, &estimate, &options);
        assert_eq!(BoundedRestoration::new(from.view(), z, &estimate, &options), bounded);
        let mut in_place = image.clone();
        let clipping = formation::restore_mut(&mut in_place, z, water, &options).unwrap();
        let found = padded().after(|view| formation::restore_mut(view, z, water, &options).unwrap());
        assert_eq!(found, (in_place, clipping));
    }
    let smoothed = smooth::bilateral(image);
    assert_eq!(smooth::bilateral(padded().view()), smoothed);
    let to = Padded::of(&target, padding + 1);
    assert_eq!(to.after(|view| smooth::bilateral_into(padded().view(), view).unwrap()).0, smoothed);
    let psnr = |a: ImageRef<'_, T, E>| metrics::psnr(a, &target).unwrap().to_bits();
    assert_eq!(psnr(padded().view()), psnr(image.view()));
}

/// What needs encoded values.
fn check_colours<T: Filler>(image: &Image<T>, padding: usize) {
    let padded = Padded::of(image, padding);
    let view = padded.view();
    for &model in DepthModel::ALL {
        assert_eq!(model.estimate(view), model.estimate(image));
        assert_eq!(
            model.estimate_oriented(view, TopEdge::Left),
            model.estimate_oriented(image, TopEdge::Left)
        );
        assert_eq!(model.estimate_unfiltered(view), model.estimate_unfiltered(image));
        assert_eq!(metrics::depth_rmse(view, image, model).unwrap().0, 0.0);
    }
    let fuser = Fuser::new(view).unwrap();
    assert_eq!(fuser.reference(), Fuser::new(image).unwrap().reference());
    let fuser = Fuser::from(waters()[1].water);
    let expected = fuser.fuse(image).unwrap();
    assert_eq!(fuser.fuse(view).unwrap(), expected);
    let to = Padded::of(&picture::<T, Encoded>(image.width(), image.height(), 3), padding + 1);
    assert_eq!(to.after(|to| fuser.fuse_into(view, to).unwrap()), (expected.image, expected.report));
    assert_eq!(metrics::ssim(view, image), metrics::ssim(image, image));
    assert_eq!(metrics::uciqe(view), metrics::uciqe(image));
    assert_eq!(metrics::uiqm(view), metrics::uiqm(image));
    let labels: Vec<f32> = (0..image.pixels().len()).map(|i| (i * 13 % 101) as f32).collect();
    let scores = |image: ImageRef<'_, T>| {
        let mut fitter = Fitter::new(Default::default());
        fitter.add(image, &labels).map(|()| fitter.rank_scores(&Default::default()))
    };
    assert_eq!(scores(view), scores(image.view()));
}

/// What needs bytes.
fn check_bytes(image: &Image<u8>, padding: usize) {
    let (width, height) = image.size();
    let padded = Padded::of(image, padding);
    let view = padded.view();
    for z in &depths(width, height) {
        for (water_map, backscatter) in [
            (WaterMap::Rules, BackscatterMethod::Envelope),
            (WaterMap::Published, BackscatterMethod::Published),
        ] {
            let options = EstimateOptions { water_map, backscatter, ..EstimateOptions::default() };
            let expected = waterbody::estimate::<Encoded>(image, z, &options);
            assert_eq!(waterbody::estimate(view, z, &options), expected);
            let expected = waterbody::estimate::<Linear>(image, z, &options);
            assert_eq!(waterbody::estimate(view, z, &options), expected);
            let expected = waterbody::evidence::<Encoded>(image, z, &options);
            assert_eq!(waterbody::evidence::<Encoded>(view, z, &options), expected);
        }
    }
    let values = (0..width * height).map(|i| (i % 7) as f32).collect();
    let supplied = Supplied::new(width, height, values, SuppliedKind::Metres).unwrap();
    assert_eq!(supplied.seen_with(view, TopEdge::Last), supplied.seen_with(image, TopEdge::Last));
    for smoothing in smooth::Smoothing::ALL {
        let mut stream = Stream::new(Fuser::from(waters()[1].water).smoothing(*smoothing));
        let mut fused = image.clone();
        let report = stream.fuse_mut(&mut fused).unwrap();
        let in_place = Padded::of(image, padding).after(|view| stream.fuse_mut(view).unwrap());
        assert_eq!(in_place, (fused.clone(), report));
        let to = Padded::of(image, padding + 5);
        assert_eq!(to.after(|to| stream.fuse_into(view, to).unwrap()), (fused, report));
    }
}

fn check(width: usize, height: usize, padding: usize, seed: usize) {
    let encoded = waters()[0].water;
    let linear: Waterbody<Linear> = Waterbody {
        veiling_light: waterbody::VeilingLight::new(encoded.veiling_light.rgb()),
        backscatter_coefficient: encoded.backscatter_coefficient,
        attenuation: encoded.attenuation,
    };
    let (bytes, words) = (picture(width, height, seed), picture::<u16, _>(width, height, seed));
    let floats = picture::<f32, _>(width, height, seed);
    check_physics::<u8, Encoded>(&bytes, &encoded, padding);
    check_physics::<u16, Encoded>(&words, &encoded, padding);
    check_physics::<f32, Encoded>(&floats, &encoded, padding);
    check_physics::<f32, Linear>(&picture(width, height, seed), &linear, padding);
    check_colours(&bytes, padding);
    check_colours(&words, padding);
    check_colours(&floats, padding);
    check_bytes(&bytes, padding);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn padding_changes_no_bit_of_any_function_by_any_instructions(
        width in 1..70_usize, height in 1..140_usize, padding in 1..40_usize, seed in 0..1000_usize,
    ) {
        for level in Level::all() {
            level.force(|| check(width, height, padding, seed));
        }
    }
}

#[test]
fn padding_changes_no_bit_of_what_is_thinned_out_nor_with_threads() {
    // More than two million pixels, of which estimates read every second.
    let image = picture::<u8, Encoded>(1803, 1203, 7);
    let padded = Padded::of(&image, 11);
    let z = DepthModel::default().estimate(padded.view());
    assert_eq!(z, DepthModel::default().estimate(&image));
    let own = waterbody::estimate(padded.view(), &z, &EstimateOptions::default()).unwrap();
    assert_eq!(Ok(own), waterbody::estimate(&image, &z, &EstimateOptions::default()));
    let other = waters()[1].water;
    let (waters, options) = (Waters::new(&own.water, &other), Options::default());
    let fused = fusion::fuse(&image, &z, waters, &options).unwrap();
    let in_place = padded.after(|view| fusion::fuse_mut(view, &z, waters, &options).unwrap());
    assert_eq!(in_place, (fused.image, fused.clipping));
}

#[test]
fn a_padded_buffer_is_fused_where_it_lies() {
    let mut buffer = Padded::of(&picture::<u8, Encoded>(33, 20, 3), 13);
    let (before, place) = (buffer.buffer.clone(), buffer.buffer.as_ptr());
    Fuser::from(waters()[1].water).fuse_mut(buffer.view_mut()).unwrap();
    assert_eq!(buffer.buffer.as_ptr(), place);
    assert_ne!(buffer.buffer, before);
    assert!(buffer.is_untouched());
}

#[test]
fn a_view_that_does_not_fit_its_buffer_is_refused() {
    let of = |width, height, stride, length| {
        let view: Result<ImageRef<'_, u8>, _> =
            ImageRef::with_stride(width, height, stride, &[0; 64][..length]);
        view.map(|_| ()).unwrap_err()
    };
    assert_eq!(of(0, 3, 9, 20), ImageError::Empty { width: 0, height: 3 });
    assert_eq!(of(3, 2, 8, 64), ImageError::Stride { width: 3, stride: 8 });
    assert_eq!(of(3, 2, 11, 19), ImageError::Buffer { width: 3, height: 2, expected: 20, found: 19 });
    assert_eq!(
        of(usize::MAX, 1, usize::MAX, 64),
        ImageError::Stride { width: usize::MAX, stride: usize::MAX }
    );
    let far = ImageError::Buffer { width: 1, height: 3, expected: usize::MAX, found: 64 };
    assert_eq!(of(1, 3, usize::MAX, 64), far);
    assert!(ImageMut::<u8>::with_stride(3, 2, 11, &mut [0; 19]).is_err());
    assert!(ImageMut::<u8>::new(3, 2, &mut [0; 19]).is_err() && ImageRef::<u8>::new(3, 2, &[0; 18]).is_ok());
}

#[test]
fn the_last_row_needs_no_padding_and_what_follows_it_is_left_alone() {
    for length in [20, 64] {
        let mut buffer = vec![1_u8; length];
        let mut view: ImageMut<'_, u8> = ImageMut::with_stride(3, 2, 11, &mut buffer).unwrap();
        assert_eq!(view.rows_mut().len(), 2);
        view.copy_from(&Image::from_raw(3, 2, vec![9; 18]).unwrap()).unwrap();
        assert_eq!(view.as_ref().rows().map(<[_]>::len).collect::<Vec<_>>(), [3, 3]);
        assert_eq!(buffer.iter().filter(|&&value| value == 9).count(), 18);
        assert!(buffer[9..11].iter().chain(&buffer[20..]).all(|&value| value == 1));
    }
}
