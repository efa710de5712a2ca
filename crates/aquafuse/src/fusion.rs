//! A scene in another picture's water (Eq. 9-11).
//!
//! Both models add to each pixel a **shift** that depends on its depth and channel alone: a weight of the
//! depth factor times the difference of the veiling lights. What differs is the weight:
//!
//! | model | weight at depth factor F | at the camera | in open water |
//! |---|---|---|---|
//! | [`Model::Aquafuse`] | `F (1 - F)`, at most 1/4 | 0 | 0 |
//! | [`Model::Physical`] | `1 - F` | 0 | 1 |

mod options;

pub use options::{Gain, Incidence, Model, OptionError, Options};

use crate::depth::DepthMap;
use crate::image::{Encoding, Image, Sample, SizeError};
use crate::waterbody::Waterbody;

/// A fused picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Fused<T, E: Encoding> {
    /// The content in the reference's water.
    pub image: Image<T, E>,
    /// What did not fit into the range.
    pub clipping: Clipping,
}

/// Values that left `[0, 1]` and were clipped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Clipping {
    /// Clipped values of red, green and blue.
    pub values: [u64; 3],
    /// Pixels in the picture.
    pub pixels: u64,
}

impl Clipping {
    /// Share of all values that were clipped.
    pub fn share(&self) -> f64 {
        self.values.iter().sum::<u64>() as f64 / (3 * self.pixels.max(1)) as f64
    }
}

/// The two waters of a fusion; exchanged, they would fuse the other way round.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waters<'a, E: Encoding> {
    /// The content's own water, estimated with the depth map it is fused with.
    pub content: &'a Waterbody<E>,
    /// The water it is to be seen in; of it, only the veiling light is used.
    pub reference: &'a Waterbody<E>,
}

/// What fusion adds to a pixel, as a function of its depth: the whole method in one line.
///
/// `shift(z) = cosθ · w(F) · (α B2∞ - B1∞)` with `F = e^(-β_B1 z)` and the model's weight w.
/// β_D has no part in it: the direct signal is left as it is.
///
/// # Examples
///
/// ```
/// use aquafuse::fusion::{Options, Shift, Waters};
/// use aquafuse::waterbody::{Attenuation, VeilingLight, Waterbody};
///
/// let blue: Waterbody = Waterbody {
///     veiling_light: VeilingLight::new([0.0, 0.2, 0.6]),
///     backscatter_coefficient: [1.0; 3],
///     attenuation: [Attenuation::constant(0.5)?; 3],
/// };
/// let green = Waterbody { veiling_light: VeilingLight::new([0.0, 0.6, 0.2]), ..blue };
/// let shift = Shift::new(Waters { content: &blue, reference: &green }, &Options::default());
/// assert_eq!(shift.at(0.0), [0.0; 3]);
/// // It peaks at β_B z = ln 2, at a quarter of the difference times cos 45°.
/// let peak = shift.at(2.0_f32.ln());
/// assert!((peak[1] - 0.25 * 0.4 * 0.5_f32.sqrt()).abs() < 1e-6);
/// # Ok::<(), aquafuse::waterbody::AttenuationError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shift {
    model: Model,
    /// cosθ (α B2∞ - B1∞)
    amplitude: [f32; 3],
    backscatter_coefficient: [f32; 3],
}

impl Shift {
    /// The shift that takes a picture from the content's water towards the reference's.
    pub fn new<E: Encoding>(waters: Waters<'_, E>, options: &Options) -> Self {
        let (from, to) = (waters.content.veiling_light.rgb(), waters.reference.veiling_light.rgb());
        let (cosine, gain) = (options.incidence.cosine(), options.gain.get());
        Self {
            model: options.model,
            amplitude: std::array::from_fn(|c| cosine * (gain * to[c] - from[c])),
            backscatter_coefficient: waters.content.backscatter_coefficient,
        }
    }

    /// What is added to red, green and blue at distance `z`.
    pub fn at(&self, z: f32) -> [f32; 3] {
        std::array::from_fn(|c| {
            let depth_factor = (-self.backscatter_coefficient[c] * z).exp();
            self.model.weight(depth_factor) * self.amplitude[c]
        })
    }
}

/// Moves the water of one picture into another.
///
/// Evaluates `U12 = U1 + shift(z)` at every pixel (see [`Shift`]; Eq. 9-11 of the paper with the direct
/// signal I1 e^(-τ) taken as U1*, so that β_D cancels). The picture keeps its size, sample type and
/// encoding; values are rounded once and clipped, and clipping is counted.
///
/// # Errors
///
/// [`SizeError`] when content and depth map differ in size.
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
/// let waters = Waters { content: &own, reference: &other };
/// let fused = fusion::fuse(&content, &z1, waters, &fusion::Options::default())?;
/// assert_eq!(fused.image.size(), content.size());
/// # Ok::<(), aquafuse::image::SizeError>(())
/// ```
pub fn fuse<T: Sample, E: Encoding>(
    content: &Image<T, E>,
    depth: &DepthMap,
    waters: Waters<'_, E>,
    options: &Options,
) -> Result<Fused<T, E>, SizeError> {
    let mut image = content.clone();
    let clipping = fuse_mut(&mut image, depth, waters, options)?;
    Ok(Fused { image, clipping })
}

/// [`fuse`] in place: the content becomes the fused picture, and nothing is allocated.
///
/// # Errors
///
/// [`SizeError`] when content and depth map differ in size; the content is then unchanged.
pub fn fuse_mut<T: Sample, E: Encoding>(
    content: &mut Image<T, E>,
    depth: &DepthMap,
    waters: Waters<'_, E>,
    options: &Options,
) -> Result<Clipping, SizeError> {
    depth.check_fits(content.size())?;
    let shift = Shift::new(waters, options);
    let pixels = content.pixels_mut();
    let mut clipping = Clipping { values: [0; 3], pixels: pixels.len() as u64 };
    depth.for_each_pixel(
        pixels,
        |z| shift.at(z).map(T::shift_from_unit),
        |pixel, shift| {
            for c in 0..3 {
                let (value, clipped) = pixel[c].shifted(shift[c]);
                pixel[c] = value;
                clipping.values[c] += u64::from(clipped);
            }
        },
    );
    Ok(clipping)
}
