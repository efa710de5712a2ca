//! A scene in another image's water (Eq. 9-11).
//!
//! What happens to a pixel depends on its depth and channel alone. Two models add a **shift**, a weight of
//! the depth factor F times the difference of the veiling lights; the others change the direct signal too:
//!
//! | model | what happens | at the camera | in open water |
//! |---|---|---|---|
//! | [`Model::Aquafuse`] | shift of weight `F (1 - F)`, at most 1/4 | nothing | nothing |
//! | [`Model::Physical`] | shift of weight `1 - F` | nothing | the reference's veil |
//! | [`Model::Relight`] | shift of weight `1 - F`, and near things take the hue of the reference's light | the reference's light | the reference's veil |
//! | [`Model::Exchange`] | the water is taken out, the other put in | nothing | the reference's veil |
//!
//! F is `e^(-β_B z)`; for `Physical` and `Relight` with depth from colour and open water in view, a table ([`DepthFactors`]), which
//! [`Bounded::waters`] hands on.

mod bound;
mod law;
mod light;
mod options;
mod relit;
mod shared;
mod shift;

pub use bound::{Bounded, Bounds};
pub(crate) use law::LawInUse;
pub use law::{PixelTransform, TransferLaw};
pub use options::{Gain, Incidence, Model, OptionError, Options};

use shift::Shifts;

use crate::bands;
use crate::depth::{DepthMap, InSteps, Stepped};
use crate::image::{
    Encoding, Image, ImageError, ImageMut, ImageRef, Kernels as _, Sample, check_same_size, runs_mut,
};
use crate::waterbody::{DepthFactors, WaterShare, Waterbody};

#[doc(no_inline)]
pub use crate::image::Clipping;

/// A fused image.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
#[must_use]
pub struct Fused<T, E: Encoding> {
    /// The content in the reference's water.
    pub image: Image<T, E>,
    /// What did not fit into the range.
    pub clipping: Clipping,
}

/// The two waters of a fusion; exchanged, they would fuse the other way round.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Waters<'a, E: Encoding> {
    /// The content's own water, estimated with the depth map it is fused with.
    pub content: &'a Waterbody<E>,
    /// The water it is to be seen in. Of it, only [`Model::Exchange`] uses more than the veiling light: its
    /// coefficients must then be per the same unit of z as the content's. Metres and metres are, and so
    /// are depths from colour by one [`DepthModel`](crate::depth::DepthModel).
    pub reference: &'a Waterbody<E>,
    /// The content's F by the depth map it was estimated with, where β_B does not describe it (see
    /// [`Estimate::depth_factors`](crate::waterbody::Estimate::depth_factors)); [`Model::Physical`] and [`Model::Relight`] read it.
    pub depth_factors: Option<&'a DepthFactors>,
    /// How much of each of the content's pixels is open water; none at all where there is none. [`Model::Aquafuse`], which is
    /// the paper's to the letter, does not read it.
    pub share: Option<&'a WaterShare>,
    /// The light on near things in the reference's water over the light in the content's, above 0; 1 is the same light. Only
    /// [`Model::Relight`] reads it.
    pub light_gain: [f32; 3],
    /// How many times as thick as the content's water the reference's is, above 0: k of `F2 = F^k`. Only [`Model::Relight`] reads
    /// it.
    pub haze: [f32; 3],
}

impl<'a, E: Encoding> Waters<'a, E> {
    /// The waters by their numbers alone: **the safety bounds are left out**, and so are the depth factors. A doubtful
    /// estimate then paints what is not there. Of two estimates, take [`Bounded::waters`], or leave it all to
    /// [`Fuser`](crate::Fuser).
    pub fn new(content: &'a Waterbody<E>, reference: &'a Waterbody<E>) -> Self {
        Self { content, reference, depth_factors: None, share: None, light_gain: [1.0; 3], haze: [1.0; 3] }
    }

    /// The same with the content's F by depth.
    #[must_use]
    pub fn with_depth_factors(self, depth_factors: Option<&'a DepthFactors>) -> Self {
        Self { depth_factors, ..self }
    }

    /// The same with another light on near things.
    #[must_use]
    pub fn with_light_gain(self, light_gain: [f32; 3]) -> Self {
        Self { light_gain, ..self }
    }

    /// The same with water of another thickness.
    #[must_use]
    pub fn with_haze(self, haze: [f32; 3]) -> Self {
        Self { haze, ..self }
    }

    /// The same with the content's share of water, pixel by pixel.
    #[must_use]
    pub fn with_share(self, share: &'a WaterShare) -> Self {
        Self { share: Some(share), ..self }
    }
}

/// Moves the water of one image into another.
///
/// Evaluates the [`TransferLaw`] of the model at every pixel (Eq. 9-11 of the paper with the direct signal
/// I1 e^(-τ) taken as U1*, so that β_D cancels; [`Model::Exchange`]: Eq. 2, then Eq. 1). The image keeps its size, sample type and
/// encoding; values are rounded once and clipped, and clipping is counted.
///
/// # Errors
///
/// [`ImageError`] when content and depth map differ in size.
///
/// # Examples
///
/// ```
/// use aquafuse::{depth, fusion, fusion::Waters, image::Image, waterbody};
///
/// # let row = |r: u8| -> Vec<u8> { (0..64).flat_map(|x| [r - x, 60 + x, 70 + 2 * x]).collect() };
/// # let content: Image<u8> = Image::from_raw(64, 1, row(180))?;
/// # let reference: Image<u8> = Image::from_raw(64, 1, row(90))?;
/// let (z1, z2) = (depth::estimate(&content), depth::estimate(&reference));
/// let own = waterbody::estimate(&content, &z1, &Default::default())?.water;
/// let other = waterbody::estimate(&reference, &z2, &Default::default())?.water;
/// let waters = Waters::new(&own, &other);
/// let fused = fusion::fuse(&content, &z1, waters, &fusion::Options::default())?;
/// assert_eq!(fused.image.size(), content.size());
/// # Ok::<(), aquafuse::image::ImageError>(())
/// ```
pub fn fuse<'a, T: Sample, E: Encoding>(
    content: impl Into<ImageRef<'a, T, E>>,
    depth: &DepthMap,
    waters: Waters<'_, E>,
    options: &Options,
) -> Result<Fused<T, E>, ImageError> {
    let mut image = content.into().to_image();
    let clipping = fuse_mut(&mut image, depth, waters, options)?;
    Ok(Fused { image, clipping })
}

/// [`fuse`] in place: the content becomes the fused image, and nothing is allocated.
///
/// # Errors
///
/// [`ImageError`] when content and depth map differ in size; the content is then unchanged.
pub fn fuse_mut<'a, T: Sample, E: Encoding>(
    content: impl Into<ImageMut<'a, T, E>>,
    depth: &DepthMap,
    waters: Waters<'_, E>,
    options: &Options,
) -> Result<Clipping, ImageError> {
    fuse_from(None, content.into(), depth, waters, options)
}

/// [`fuse`] into an image that is there already, which keeps nothing of what it was: nothing is allocated.
///
/// # Errors
///
/// [`ImageError`] when content, depth map and `fused` differ in size; `fused` is then unchanged.
pub fn fuse_into<'a, 'b, T: Sample, E: Encoding>(
    content: impl Into<ImageRef<'a, T, E>>,
    depth: &DepthMap,
    waters: Waters<'_, E>,
    options: &Options,
    fused: impl Into<ImageMut<'b, T, E>>,
) -> Result<Clipping, ImageError> {
    let (content, fused) = (content.into(), fused.into());
    check_same_size(content.size(), fused.size())?;
    fuse_from(Some(content), fused, depth, waters, options)
}

/// Fuses the content, or `fused` itself if there is none, into `fused`.
fn fuse_from<T: Sample, E: Encoding>(
    content: Option<ImageRef<'_, T, E>>,
    fused: ImageMut<'_, T, E>,
    depth: &DepthMap,
    waters: Waters<'_, E>,
    options: &Options,
) -> Result<Clipping, ImageError> {
    let law = TransferLaw::new(waters, options);
    fuse_by(content, fused, depth, LawInUse::new(&law, None), waters.share)
}

/// Fuses the content, or `fused` itself if there is none, into `fused` by a law.
pub(crate) fn fuse_by<T: Sample, E: Encoding>(
    content: Option<ImageRef<'_, T, E>>,
    mut fused: ImageMut<'_, T, E>,
    depth: &DepthMap,
    law: LawInUse<'_, E>,
    share: Option<&WaterShare>,
) -> Result<Clipping, ImageError> {
    depth.check_fits(fused.size())?;
    let model = law.model();
    let pixels = fused.width() as u64 * fused.height() as u64;
    if let Some(share) = share {
        check_same_size(fused.size(), share.size())?;
    }
    let share = share.filter(|share| model != Model::Aquafuse && !share.is_none());
    if law.is_light_alone() && depth.in_steps().is_some() && fused.reborrow().into_bytes().is_some() {
        let values = relit::fuse(content, fused, depth, law, share);
        return Ok(Clipping { values, pixels });
    }
    if let Some(share) = share {
        let values = shared::fuse(content, fused, depth, law, share)?;
        return Ok(Clipping { values, pixels });
    }
    if let Some(values) = shift_of_bytes(content, fused.reborrow(), depth, law) {
        return Ok(Clipping { values, pixels });
    }
    if let Some(content) = content {
        fused.copy_from(content)?;
    }
    Ok(Clipping { values: change_pixels(fused, depth, law), pixels })
}

/// The law where it is a shift of bytes by depth in steps, the everyday case; how many values were clipped.
fn shift_of_bytes<T: Sample, E: Encoding>(
    content: Option<ImageRef<'_, T, E>>,
    fused: ImageMut<'_, T, E>,
    depth: &DepthMap,
    law: LawInUse<'_, E>,
) -> Option<[u64; 3]> {
    let depths = depth.in_steps().filter(|_| law.model().is_shift())?;
    let (content, fused) = (content.and_then(|content| content.as_bytes()), fused.into_bytes()?);
    match depths {
        InSteps::Levels(levels) => shift_by(content, fused, levels, law),
        InSteps::Steps(steps) => shift_by(content, fused, steps, law),
    }
}

fn shift_by<S: Stepped, E: Encoding>(
    content: Option<ImageRef<'_, u8, E>>,
    fused: ImageMut<'_, u8, E>,
    depths: &[S],
    law: LawInUse<'_, E>,
) -> Option<[u64; 3]> {
    let (width, stride) = (fused.width(), fused.stride());
    let of_step = |place| law.at(S::z(place)).offset.map(u8::shift_from_unit);
    let shifts = Shifts::new((0..S::COUNT).map(of_step))?;
    let band = |first: usize, band: &mut [u8]| {
        if let Some(content) = content {
            for (i, row) in band.chunks_mut(stride).enumerate() {
                row[..3 * width].copy_from_slice(content.row(first + i).as_flattened());
            }
        }
        let depths = &depths[first * width..];
        let run = |sum, (start, values): (usize, &mut [u8])| {
            add(sum, shifts.add(values, &depths[start..][..values.len() / 3]))
        };
        runs_mut(band, width, stride).fold([0; 3], run)
    };
    Some(bands::sum(fused.into_samples(), stride, band, add))
}

/// The law at each pixel, whatever it is; how many values were clipped.
fn change_pixels<T: Sample, E: Encoding>(
    content: ImageMut<'_, T, E>,
    depth: &DepthMap,
    law: LawInUse<'_, E>,
) -> [u64; 3] {
    let store = |pixel: &mut [T; 3], c: usize, (value, is_clipped): (T, bool), clipped: &mut [u64; 3]| {
        pixel[c] = value;
        clipped[c] += u64::from(is_clipped);
    };
    if law.model().is_shift() {
        // In whole steps of the samples, which is exact and rounds once a depth.
        let steps = |z| law.at(z).offset.map(T::shift_from_unit);
        let change = |pixel: &mut [T; 3], shift: [T::Shift; 3], clipped: &mut [u64; 3]| {
            (0..3).for_each(|c| store(pixel, c, pixel[c].shifted(shift[c]), clipped));
        };
        depth.sum_over_pixels(content, steps, change, add)
    } else {
        let change = |pixel: &mut [T; 3], change: PixelTransform, clipped: &mut [u64; 3]| {
            (0..3).for_each(|c| store(pixel, c, pixel[c].changed(change.gain[c], change.offset[c]), clipped));
        };
        depth.sum_over_pixels(content, |z| law.at(z), change, add)
    }
}

fn add(a: [u64; 3], b: [u64; 3]) -> [u64; 3] {
    std::array::from_fn(|c| a[c] + b[c])
}
