//! A large image thinned out to what is counted in it.
//!
//! Quantiles over depth are read off it, of which half a million pixels are as good as many millions. Pixels are
//! left out, not averaged: the noise of an image and its darkest places stay what they are.

use crate::bands;
use crate::depth::Quantised;
use crate::image::{Image, ImageError, ImageRef};
use crate::waterbody::glimpse::Glimpse;

/// Pixels that are kept at least; of fewer than four times as many, none is left out.
///
/// With 500,000, β_B of truth scenes and of the two real images that large at hand moved by at most 1 % (one of 44
/// estimates, by [`Ratio`](crate::depth::DepthModel::Ratio), by 4.5 %); with 230,000, five of 48 moved by more than
/// 2 %, one by 23 %.
const ENOUGH: usize = 500_000;

/// An image and its depth in steps, of which a regular grid is kept.
pub(super) struct Thumbnail {
    pub(super) image: Image<u8>,
    pub(super) depth: Quantised<'static>,
}

impl Thumbnail {
    /// The thumbnail of a large image; none of one that is small enough as it is.
    pub(super) fn of(image: ImageRef<'_, u8>, depth: &Quantised<'_>, scratch: &mut Scratch) -> Option<Self> {
        let stride = (image.width() * image.height() / ENOUGH).isqrt();
        (stride > 1).then(|| Self::every(stride, image, depth, scratch).expect("the grid is full"))
    }

    fn every(
        stride: usize,
        image: ImageRef<'_, u8>,
        depth: &Quantised<'_>,
        scratch: &mut Scratch,
    ) -> Result<Self, ImageError> {
        let [mut samples, mut levels] = [&mut scratch.samples, &mut scratch.levels].map(std::mem::take);
        let (width, rows) = (kept(image.width(), stride).count(), kept(image.height(), stride));
        let rows: Vec<usize> = rows.collect();
        samples.resize(3 * width * rows.len(), 0);
        bands::for_each(&mut samples, 3 * width, |first, band| {
            for (samples, &y) in band.chunks_exact_mut(3 * width).zip(&rows[first..]) {
                thin(image.row(y), stride, samples.as_chunks_mut().0);
            }
        });
        levels.resize(width * rows.len(), 0);
        bands::for_each(&mut levels, width, |first, band| {
            for (levels, &y) in band.chunks_exact_mut(width).zip(&rows[first..]) {
                thin(&depth.levels[y * image.width()..][..image.width()], stride, levels);
            }
        });
        Ok(Self {
            image: Image::from_raw(width, rows.len(), samples)?,
            depth: Quantised { levels: levels.into(), step: depth.step, beyond: depth.beyond },
        })
    }

    /// Gives its memory back.
    pub(super) fn give_back(self, scratch: &mut Scratch) {
        scratch.samples = self.image.into_raw();
        scratch.levels = self.depth.levels.into_owned();
    }
}

/// What an estimate leaves for the next: the memory of its thumbnail, and what the network saw.
#[derive(Clone, Debug, Default)]
pub(crate) struct Scratch {
    samples: Vec<u8>,
    levels: Vec<u8>,
    pub(crate) glimpse: Glimpse,
}

/// Places along a side of `length` that are kept: each `stride`-th counted from the nearer end, so that the mirror
/// image keeps the mirrored ones, and an image on its side the same.
fn kept(length: usize, stride: usize) -> impl Iterator<Item = usize> {
    let near = (0..length.div_ceil(2)).step_by(stride);
    let far = (0..length / 2).step_by(stride).map(move |place| length - 1 - place);
    near.chain(far.rev())
}

/// The values of a row that [`kept`] names.
fn thin<T: Copy>(row: &[T], stride: usize, thinned: &mut [T]) {
    let (near, far) = row.split_at(row.len().div_ceil(2));
    // The last of the far half is kept: so many places before the first that is.
    let far = &far[far.len().saturating_sub(1) % stride..];
    let (to_near, to_far) = thinned.split_at_mut(near.len().div_ceil(stride));
    for (to, from) in [(to_near, near), (to_far, far)] {
        match stride {
            // Of most large images: known to the compiler, it costs a third.
            2 => pick::<T, 2>(from, to),
            3 => pick::<T, 3>(from, to),
            4 => pick::<T, 4>(from, to),
            _ => to.iter_mut().zip(from.iter().step_by(stride)).for_each(|(to, from)| *to = *from),
        }
    }
}

/// The first of every `STRIDE` values.
fn pick<T: Copy, const STRIDE: usize>(from: &[T], to: &mut [T]) {
    let (whole, rest) = from.as_chunks::<STRIDE>();
    let (of_whole, of_rest) = to.split_at_mut(whole.len());
    of_whole.iter_mut().zip(whole).for_each(|(to, values)| *to = values[0]);
    of_rest.iter_mut().zip(rest).for_each(|(to, from)| *to = *from);
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn small_images_are_kept_whole_and_of_large_ones_enough() {
        for (width, height, thinned) in
            [(1, 1, false), (1414, 1414, false), (1415, 1415, true), (1920, 1080, true), (9000, 500, true)]
        {
            let image = Image::from_raw(width, height, vec![7; 3 * width * height]).unwrap();
            let depth = Quantised { levels: vec![9; width * height].into(), step: 0.1, beyond: None };
            let thumbnail = Thumbnail::of(image.view(), &depth, &mut Scratch::default());
            assert_eq!(thumbnail.is_some(), thinned, "{width}x{height}");
            if let Some(Thumbnail { image, depth }) = thumbnail {
                let pixels = image.pixels().len();
                assert!((ENOUGH..5 * ENOUGH).contains(&pixels), "{pixels} of {width}x{height}");
                assert_eq!(depth.levels.len(), pixels);
            }
        }
    }

    #[test]
    fn a_thumbnail_tells_of_the_water_what_the_image_does() {
        use crate::depth;
        use crate::truth::{Scene, Size, waters};
        use crate::waterbody::{Estimate, EstimateOptions, Seen, estimate, look};

        let scene = Scene::new(3, Size { width: 1920, height: 1080 });
        for named in waters() {
            let image = scene.seen_through(&named.water).convert();
            let z = depth::estimate(&image);
            let quantised = z.quantised();
            let whole = Seen { image: image.view(), levels: &quantised.levels };
            let options = EstimateOptions::default();
            let glimpse = &mut Glimpse::default();
            let all: Estimate = look(whole, image.view(), &quantised, &z, &options, glimpse).judged(&z);
            let some: Estimate = estimate(&image, &z, &options).unwrap();
            for c in 0..3 {
                let [veil, found] = [all, some].map(|one| one.water.veiling_light.rgb()[c]);
                assert!((veil - found).abs() < 1.0 / 255.0, "{}: {found} for {veil}", named.name);
                let [growth, found] = [all, some].map(|one| one.water.backscatter_coefficient[c]);
                assert!((found / growth - 1.0).abs() < 0.02, "{}: {found} for {growth}", named.name);
            }
            assert_eq!(all.quality, some.quality);
        }
    }

    proptest! {
        #[test]
        fn the_grid_is_the_same_from_both_ends(length in 1..3000_usize, stride in 1..20_usize) {
            let found: Vec<usize> = kept(length, stride).collect();
            prop_assert!(found.iter().all(|&place| place.min(length - 1 - place).is_multiple_of(stride)));
            let all: Vec<usize> = (0..length).collect();
            let mut thinned = vec![0; found.len()];
            thin(&all, stride, &mut thinned);
            prop_assert_eq!(&thinned, &found);
            let mirrored: Vec<usize> = found.iter().rev().map(|place| length - 1 - place).collect();
            prop_assert_eq!(found, mirrored);
        }
    }
}
