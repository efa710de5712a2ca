//! The water of one image: a dozen numbers, and how they are estimated.
//!
//! The steps are the paper's, in its order: veiling light from open water or the farthest pixels, backscatter
//! from the darkest (Eq. 5), attenuation from what is left (Eq. 6-8). Each step is a module; [`estimate`] runs all.

mod attenuation;
mod backscatter;
mod cells;
mod depth_factors;
mod evidence;
mod far_region;
mod given;
mod glimpse;
mod judge;
mod near_colour;
mod pool;
pub mod presets;
mod quality;
mod seen;
mod share;
mod statistics;
mod unit;
mod veiling_light;
mod water_map;

pub use attenuation::{Attenuation, AttenuationError};
pub use backscatter::BackscatterMethod;
pub use depth_factors::DepthFactors;
pub use evidence::{DepthBin, Evidence, estimate_with_evidence, evidence};
pub use pool::pool;
pub use quality::{Quality, Reason, Reasons, Verdict};
pub use share::{WaterShare, water_share};
pub(crate) use share::{sureness, water_share_by};
pub use veiling_light::{VeilingLight, VeilingLightSource};
pub use water_map::WaterMap;

use crate::bands;
use crate::depth::{DepthMap, DepthModel, Quantised};
use crate::image::{Encoded, Encoding, ImageError, ImageRef, TopEdge};
use backscatter::Growth;
use cells::Cells;
use far_region::Region;
pub(crate) use glimpse::Glimpse;
pub(crate) use seen::Seen;
use statistics::Statistics;
use veiling_light::Reading;

/// The water of one image, per channel red, green, blue.
///
/// It belongs to one encoding: water estimated from encoded values cannot meet linear light.
///
/// # Examples
///
/// ```
/// use aquafuse::waterbody::{Attenuation, VeilingLight, Waterbody};
///
/// let water: Waterbody = Waterbody {
///     veiling_light: VeilingLight::new([0.05, 0.30, 0.45]),
///     backscatter_coefficient: [0.30, 0.20, 0.15],
///     attenuation: [Attenuation::constant(0.5)?, Attenuation::constant(0.2)?, Attenuation::constant(0.15)?],
/// };
/// // Backscatter grows from nothing at the camera to the veiling light far away.
/// assert_eq!(water.backscatter(0.0), [0.0, 0.0, 0.0]);
/// assert!((water.backscatter(1e3)[2] - 0.45).abs() < 1e-6);
/// # Ok::<(), aquafuse::waterbody::AttenuationError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(bound = ""))]
pub struct Waterbody<E: Encoding = Encoded> {
    /// B∞, the colour of the water at infinity, in `[0, 1]`.
    pub veiling_light: VeilingLight<E>,
    /// β_B, how fast backscatter grows, per unit of z, >= 0.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "coefficients"))]
    pub backscatter_coefficient: [f32; 3],
    /// β_D(z), how fast the direct signal fades, per unit of z, >= 0.
    pub attenuation: [Attenuation; 3],
}

/// β_B of a file: 0 or more.
#[cfg(feature = "serde")]
fn coefficients<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<[f32; 3], D::Error> {
    let beta = <[f32; 3] as serde::Deserialize>::deserialize(deserializer)?;
    if beta.iter().all(|beta| beta.is_finite() && *beta >= 0.0) {
        Ok(beta)
    } else {
        Err(serde::de::Error::custom(format!("backscatter_coefficient is {beta:?}, but is 0 or more")))
    }
}

impl<E: Encoding> Waterbody<E> {
    /// Backscatter `B = B∞ (1 - e^(-β_B z))` at one distance.
    pub fn backscatter(&self, z: f32) -> [f32; 3] {
        let factor = self.depth_factor(z);
        std::array::from_fn(|c| self.veiling_light.rgb()[c] * (1.0 - factor[c]))
    }

    /// Depth factor `F = e^(-β_B z)` at one distance.
    pub fn depth_factor(&self, z: f32) -> [f32; 3] {
        self.backscatter_coefficient.map(|coefficient| (-coefficient * z).exp())
    }

    /// Illumination map `E = e^(-β_D(z) z)` at one distance: what is left of the direct signal.
    pub fn illumination(&self, z: f32) -> [f32; 3] {
        self.attenuation.each_ref().map(|curve| (-curve.optical_depth(z)).exp())
    }
}

/// An estimated waterbody and how it was obtained.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Estimate<E: Encoding = Encoded> {
    /// The water.
    pub water: Waterbody<E>,
    /// Where the veiling light was read; corners and unfiltered pixels are the last resorts.
    pub veiling_light_source: VeilingLightSource,
    /// Share of the image the veiling light is the median of.
    ///
    /// Of the farthest pixels whole depth levels are taken, so a saturated level may bring far more than the
    /// 5 % asked for.
    pub veiling_light_share: f32,
    /// The depth model used; `None` for supplied depth.
    pub depth_model: Option<DepthModel>,
    /// F by depth, where one β_B does not describe it: with depth from colour and open water in view.
    pub depth_factors: Option<DepthFactors>,
    /// The mean colour of the nearest three tenths of the pixels, in `(0, 1]`: it says what things are lit by. None where nobody
    /// looked. [`Model::Relight`](crate::fusion::Model::Relight) compares it with another image's.
    pub near_colour: Option<[f32; 3]>,
    /// How far off the water may be.
    pub intervals: Intervals,
    /// Whether to rely on it.
    pub quality: Quality,
}

/// Intervals that hold the truth nine times in ten, `[low, high]` per channel: measured on scenes of known
/// truth, not derived.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Intervals {
    /// Of B∞.
    pub veiling_light: [[f32; 2]; 3],
    /// Of β_B, per unit of z. Depth from colour has no true β_B: there it says how far the one that serves
    /// best may be off.
    pub backscatter_coefficient: [[f32; 2]; 3],
}

/// How to estimate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct EstimateOptions {
    /// The stored edge that is up as seen: the fallbacks look there for open water. Default: row 0.
    pub top: TopEdge,
    /// How the growth of backscatter is estimated. Default: from the dark envelope.
    pub backscatter: BackscatterMethod,
    /// What says where open water is. Default: rules.
    pub water_map: WaterMap,
}

impl EstimateOptions {
    /// The paper's estimators of veiling light and backscatter.
    pub fn as_published() -> Self {
        let (water_map, backscatter) = (WaterMap::Published, BackscatterMethod::Published);
        Self { water_map, backscatter, ..Self::default() }
    }

    /// The same with another edge on top.
    #[must_use]
    pub fn with_top(self, top: TopEdge) -> Self {
        Self { top, ..self }
    }

    /// The same with another way to the backscatter.
    #[must_use]
    pub fn with_backscatter(self, backscatter: BackscatterMethod) -> Self {
        Self { backscatter, ..self }
    }

    /// The same with another map of open water.
    #[must_use]
    pub fn with_water_map(self, water_map: WaterMap) -> Self {
        Self { water_map, ..self }
    }
}

/// Estimates the water of an image from its 8-bit colours and its depth.
///
/// The result is per unit of the depth map's z; change the unit and the betas change against it.
/// Medians and quantiles are read from the encoded bytes and then taken to encoding `E`, in which the
/// curves are fitted.
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
/// let row: Vec<u8> = (0..64).flat_map(|x| [180 - 2 * x, 60 + x, 70 + 2 * x]).collect();
/// let image = Image::<u8>::from_raw(64, 1, row)?;
/// let found = waterbody::estimate::<Encoded>(&image, &depth::estimate(&image), &Default::default())?;
/// let [r, g, b] = found.water.veiling_light.rgb();
/// assert!(r < g && g < b);
/// # Ok::<(), aquafuse::image::ImageError>(())
/// ```
pub fn estimate<'a, E: Encoding>(
    image: impl Into<ImageRef<'a, u8>>,
    depth: &DepthMap,
    options: &EstimateOptions,
) -> Result<Estimate<E>, ImageError> {
    estimate_in(image.into(), depth, options, &mut Glimpse::default(), |looked: &Look<E>, _, depth| {
        looked.judged(depth)
    })
}

/// [`estimate`], and how much of each pixel is open water, in one pass: what a fusion reads.
///
/// # Errors
///
/// [`ImageError`] when image and depth map differ in size.
pub fn estimate_with_share<'a, E: Encoding>(
    image: impl Into<ImageRef<'a, u8>>,
    depth: &DepthMap,
    options: &EstimateOptions,
) -> Result<(Estimate<E>, WaterShare), ImageError> {
    estimate_in(image.into(), depth, options, &mut Glimpse::default(), Look::judged_with_share)
}

/// What [`estimate`] looks at; `glimpse` is what the network saw in the image before.
pub(crate) fn estimate_in<E: Encoding, R>(
    image: ImageRef<'_, u8>,
    depth: &DepthMap,
    options: &EstimateOptions,
    glimpse: &mut Glimpse,
    result: impl FnOnce(&Look<E>, Seen<'_>, &DepthMap) -> R,
) -> Result<R, ImageError> {
    depth.check_fits(image.size())?;
    let quantised = depth.quantised();
    let whole = Seen::whole(image, &quantised.levels);
    let looked = look(whole, whole.thinned(), &quantised, depth, options, glimpse);
    Ok(result(&looked, whole, depth))
}

/// All that was read and fitted: what [`estimate`] judges and [`evidence`] shows.
pub(crate) struct Look<E: Encoding> {
    /// The far region; none where the veiling light is read the paper's way.
    region: Option<Region>,
    statistics: Statistics<E>,
    light: Reading,
    growth: Growth,
    attenuation: [attenuation::Fit; 3],
}

impl<E: Encoding> Look<E> {
    /// The water, and what it is worth.
    pub(crate) fn judged(&self, depth: &DepthMap) -> Estimate<E> {
        let Self { statistics, light, growth, attenuation, .. } = self;
        Estimate {
            water: Waterbody {
                veiling_light: VeilingLight::new(growth.veil),
                backscatter_coefficient: growth.coefficient,
                attenuation: attenuation.each_ref().map(|fit| fit.curve),
            },
            veiling_light_source: light.source,
            veiling_light_share: light.share as f32,
            depth_model: depth.model(),
            depth_factors: growth.depth_factors,
            near_colour: near_colour::of(statistics),
            intervals: judge::intervals::<E>(growth, light, depth),
            quality: judge::quality(growth, light, statistics, attenuation, depth),
        }
    }

    /// The same, and how much of each pixel is open water.
    pub(crate) fn judged_with_share(&self, whole: Seen<'_>, depth: &DepthMap) -> (Estimate<E>, WaterShare) {
        let estimate = self.judged(depth);
        let veil = estimate.water.veiling_light.rgb().map(E::to_encoded);
        let share = self.share_by(whole, depth, |seen| (veil, sureness(seen)));
        (estimate, share)
    }

    /// How much of each pixel is open water, by the water's colour (encoded) and how sure it is that water is in view, which may
    /// depend on the likelihood.
    pub(crate) fn share_by(
        &self,
        whole: Seen<'_>,
        depth: &DepthMap,
        water: impl FnOnce(f32) -> ([f32; 3], f32),
    ) -> WaterShare {
        let region = self.region.as_ref().filter(|_| !depth.is_measured_everywhere());
        let (veil, sure) = water(region.map_or(0.0, |region| region.seen));
        let none = || WaterShare::none(whole.image.size());
        region.map_or_else(none, |region| WaterShare::of(depth, region, veil, sure))
    }
}

/// Open water is looked for in all of the image, for whether a place is smooth is a close decision on many images; colours by
/// depth are those of what is `counted`.
fn look<E: Encoding>(
    whole: Seen<'_>,
    counted: Seen<'_>,
    quantised: &Quantised<'_>,
    depth: &DepthMap,
    options: &EstimateOptions,
    glimpse: &mut Glimpse,
) -> Look<E> {
    let given = depth.model().is_none();
    let (statistics, region) = bands::both(
        whole.levels.len(),
        || Statistics::<E>::gather(counted, quantised),
        || Region::by(options, Cells::new(whole.image, whole.levels), whole.image, given, glimpse),
    );
    let mut light = veiling_light::read(region.as_ref(), counted, depth.is_measured(), options.top);
    let mut growth = fit(counted, depth, quantised, &statistics, &light, options.backscatter);
    if depth.is_measured() && is_seen_through(&light, &growth, quantised) {
        light = veiling_light::read_things(counted);
        growth = fit(counted, depth, quantised, &statistics, &light, options.backscatter);
    }
    let veil = VeilingLight::<E>::new(growth.veil);
    // The paper's way is the slope alone, wherever depth is from.
    let attenuation = if given && options.backscatter == BackscatterMethod::Envelope {
        attenuation::fit_supplied(&statistics, veil.rgb(), growth.coefficient)
    } else {
        std::array::from_fn(|c| attenuation::fit(&statistics, c, veil.rgb()[c], growth.coefficient[c]))
    };
    Look { region, statistics, light, growth, attenuation }
}

fn fit<E: Encoding>(
    counted: Seen<'_>,
    depth: &DepthMap,
    quantised: &Quantised<'_>,
    statistics: &Statistics<E>,
    light: &Reading,
    method: BackscatterMethod,
) -> Growth {
    match method {
        BackscatterMethod::Envelope => backscatter::fit(statistics, light, depth),
        BackscatterMethod::Published => backscatter::fit_published(counted, quantised, statistics, light),
    }
}

/// Share of the direct signal that open water may still let through at the distance it was seen at.
const LEFT_IN_OPEN_WATER: f32 = 0.1;

/// Whether what was taken for open water is too near to be any: at its distance, if that is known, light from
/// things would still come through.
fn is_seen_through(light: &Reading, growth: &Growth, quantised: &Quantised<'_>) -> bool {
    let known = light.level.filter(|&level| quantised.beyond != Some(level));
    known.is_some_and(|level| {
        let z = f32::from(level) * quantised.step;
        growth.coefficient.iter().any(|coefficient| (-coefficient * z).exp() > LEFT_IN_OPEN_WATER)
    })
}
