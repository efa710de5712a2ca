//! A large picture thinned out to what the estimators need.
//!
//! They take medians and quantiles, of which a few hundred thousand pixels tell as much as millions. Pixels are
//! left out, not averaged: the noise of a picture, its darkest and its smoothest places stay what they are.

use crate::bands;
use crate::depth::Quantised;
use crate::image::{Image, SizeError};

/// Pixels that are kept at least; of fewer, none is left out. Of 250,000 the dark end of a bin of depth (.4 % of a
/// 32nd) is still read off 30, and β_B moves by less than 2 % on nearly every picture.
const ENOUGH: usize = 250_000;

/// A picture and its depth in steps, of which a regular grid is kept.
pub(super) struct Thumbnail {
    pub(super) image: Image<u8>,
    pub(super) depth: Quantised<'static>,
}

impl Thumbnail {
    /// The thumbnail of a large picture; none of one that is small enough as it is.
    pub(super) fn of(image: &Image<u8>, depth: &Quantised<'_>) -> Option<Self> {
        let stride = (image.width() * image.height() / ENOUGH).isqrt();
        (stride > 1).then(|| Self::every(stride, image, depth).expect("the grid is full"))
    }

    fn every(stride: usize, image: &Image<u8>, depth: &Quantised<'_>) -> Result<Self, SizeError> {
        let (columns, rows) = (kept(image.width(), stride), kept(image.height(), stride));
        let mut samples = vec![0; 3 * columns.len() * rows.len()];
        bands::for_each(&mut samples, 3 * columns.len(), |first, band| {
            for (samples, &y) in band.chunks_exact_mut(3 * columns.len()).zip(&rows[first..]) {
                let pixels = image.row(y);
                for (sample, &x) in samples.as_chunks_mut().0.iter_mut().zip(&columns) {
                    *sample = pixels[x];
                }
            }
        });
        let mut levels = vec![0; columns.len() * rows.len()];
        bands::for_each(&mut levels, columns.len(), |first, band| {
            for (kept, &y) in band.chunks_exact_mut(columns.len()).zip(&rows[first..]) {
                let all = &depth.levels[y * image.width()..][..image.width()];
                kept.iter_mut().zip(&columns).for_each(|(level, &x)| *level = all[x]);
            }
        });
        Ok(Self {
            image: Image::from_raw(columns.len(), rows.len(), samples)?,
            depth: Quantised { levels: levels.into(), step: depth.step, beyond: depth.beyond },
        })
    }
}

/// Places along a side of `length` that are kept: each `stride`-th counted from the nearer end, so that the mirror
/// image keeps the mirrored ones, and a picture on its side the same.
fn kept(length: usize, stride: usize) -> Vec<usize> {
    (0..length).filter(|&place| place.min(length - 1 - place).is_multiple_of(stride)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn small_pictures_are_kept_whole_and_of_large_ones_enough() {
        for (width, height, thinned) in
            [(1, 1, false), (999, 1000, false), (1000, 1000, true), (1920, 1080, true), (9000, 500, true)]
        {
            let image = Image::from_raw(width, height, vec![7; 3 * width * height]).unwrap();
            let depth = Quantised { levels: vec![9; width * height].into(), step: 0.1, beyond: None };
            let thumbnail = Thumbnail::of(&image, &depth);
            assert_eq!(thumbnail.is_some(), thinned, "{width}x{height}");
            if let Some(Thumbnail { image, depth }) = thumbnail {
                let pixels = image.pixels().len();
                assert!((ENOUGH..5 * ENOUGH).contains(&pixels), "{pixels} of {width}x{height}");
                assert_eq!(depth.levels.len(), pixels);
            }
        }
    }

    proptest! {
        #[test]
        fn the_grid_is_the_same_from_both_ends(length in 1..3000_usize, stride in 1..20_usize) {
            let found = kept(length, stride);
            let mirrored: Vec<usize> = found.iter().rev().map(|place| length - 1 - place).collect();
            prop_assert_eq!(found, mirrored);
        }
    }
}
