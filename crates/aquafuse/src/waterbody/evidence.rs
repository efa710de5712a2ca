//! What an estimate was fitted to, for whoever wants to see it.

use super::glimpse::Glimpse;
use super::{
    Estimate, EstimateOptions, Look, Seen, VeilingLight, WaterShare, attenuation, backscatter, estimate_in,
    look,
};
use crate::depth::DepthMap;
use crate::image::{Encoding, ImageError, ImageRef};

/// What [`estimate`](super::estimate) read off an image on its way to the water.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Evidence {
    /// Ranges of depth with about as many pixels each, near to far.
    pub bins: Vec<DepthBin>,
    /// z that 95 % of the pixels do not exceed, open water beyond all things left out: the far end of the fits.
    pub z95: f32,
    /// Whether the veiling light was read from this pixel, row by row from the top.
    pub read_from: Vec<bool>,
}

/// The pixels of one range of depths, per channel red, green, blue, in the encoding of the fit.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct DepthBin {
    /// Mean z.
    pub z: f32,
    /// How many there are.
    pub pixels: u64,
    /// The darkest things, to which B is fitted: a black one would lie on the curve, others lie above it.
    pub dark: [f32; 3],
    /// Mean direct signal U − B.
    pub direct: [f32; 3],
    /// E(z), to which β_D is fitted: the direct signal as a share of what it is at z = 0 by that fit. None
    /// where nothing is left to measure.
    pub illumination: [Option<f32>; 3],
}

/// What [`estimate`](super::estimate) reads with the same arguments, of all pixels: of large images that counts
/// some rows, which differs by less than the eye sees.
///
/// # Errors
///
/// [`ImageError`] when image and depth map differ in size.
///
/// # Examples
///
/// ```
/// use aquafuse::{depth, image::{Encoded, Image}, waterbody};
///
/// let row: Vec<u8> = (0..200).flat_map(|x| [220 - x, 60 + x / 2, 70 + x / 2]).collect();
/// let image = Image::<u8>::from_raw(200, 1, row)?;
/// let z = depth::estimate(&image);
/// let seen = waterbody::evidence::<Encoded>(&image, &z, &Default::default())?;
/// assert!(seen.bins.iter().all(|bin| bin.dark.iter().all(|dark| (0.0..=1.0).contains(dark))));
/// assert_eq!(seen.read_from.len(), 200);
/// # Ok::<(), aquafuse::image::ImageError>(())
/// ```
pub fn evidence<'a, E: Encoding>(
    image: impl Into<ImageRef<'a, u8>>,
    depth: &DepthMap,
    options: &EstimateOptions,
) -> Result<Evidence, ImageError> {
    let image = image.into();
    depth.check_fits(image.size())?;
    let quantised = depth.quantised();
    let whole = Seen::whole(image, &quantised.levels);
    Ok(look::<E>(whole, whole, &quantised, depth, options, &mut Glimpse::default()).shown(whole))
}

/// [`estimate`](super::estimate), how much of each pixel is open water, and what all that was fitted to, in one pass. Of a large
/// image the bins are those of the rows that the estimate counted.
///
/// # Errors
///
/// [`ImageError`] when image and depth map differ in size.
pub fn estimate_with_evidence<'a, E: Encoding>(
    image: impl Into<ImageRef<'a, u8>>,
    depth: &DepthMap,
    options: &EstimateOptions,
) -> Result<(Estimate<E>, WaterShare, Evidence), ImageError> {
    estimate_in(image.into(), depth, options, &mut Glimpse::default(), |looked: &Look<E>, whole, depth| {
        let (estimate, share) = looked.judged_with_share(whole, depth);
        (estimate, share, looked.shown(whole))
    })
}

impl<E: Encoding> Look<E> {
    /// What was read, with its places in the whole image.
    fn shown(&self, whole: Seen<'_>) -> Evidence {
        let Self { statistics, light, growth, attenuation, .. } = self;
        let envelopes = backscatter::envelopes(statistics, light);
        let veil = VeilingLight::<E>::new(growth.veil).rgb();
        let bins = statistics.bins.iter().enumerate().map(|(i, bin)| {
            let direct: [f32; 3] =
                std::array::from_fn(|c| attenuation::direct_signal(bin, c, veil[c], growth.coefficient[c]));
            DepthBin {
                z: bin.z,
                pixels: bin.count,
                dark: std::array::from_fn(|c| envelopes[c][i].dark),
                direct,
                illumination: std::array::from_fn(|c| attenuation[c].illumination(direct[c])),
            }
        });
        Evidence { bins: bins.collect(), z95: statistics.z95, read_from: light.places.mask(whole) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Encoded, Image};
    use crate::truth::{Scene, Size, waters};
    use crate::waterbody::{estimate, evidence};

    #[test]
    fn both_together_are_both_one_by_one() {
        let size = Size { width: 96, height: 64 };
        let image: Image<u8> = Scene::new(2, size).seen_through(&waters()[1].water).convert();
        let z = crate::depth::estimate(&image);
        for options in [EstimateOptions::default(), EstimateOptions::as_published()] {
            let (estimated, _, seen) = estimate_with_evidence::<Encoded>(&image, &z, &options).unwrap();
            assert_eq!(Ok(estimated), estimate(&image, &z, &options));
            assert_eq!(Ok(seen), evidence::<Encoded>(&image, &z, &options));
        }
    }

    #[test]
    fn of_a_large_image_the_estimate_is_that_of_some_rows_and_the_places_are_all() {
        let (width, height) = (2000, 1001);
        let sample =
            |i: usize| (60 + 90 * (i / 3 / width) / height + i.wrapping_mul(2_654_435_761) % 40) as u8;
        let image = Image::from_raw(width, height, (0..3 * width * height).map(sample).collect()).unwrap();
        let z = crate::depth::estimate(&image);
        let options = EstimateOptions::default();
        let (estimated, _, seen) = estimate_with_evidence::<Encoded>(&image, &z, &options).unwrap();
        assert_eq!(Ok(estimated), estimate(&image, &z, &options));
        assert_eq!(seen.read_from, evidence::<Encoded>(&image, &z, &options).unwrap().read_from);
    }
}
