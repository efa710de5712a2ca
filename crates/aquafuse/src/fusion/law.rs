//! What fusion does to a pixel, as a function of its depth: the whole method in one place.

use super::{Model, Options, Waters};
use crate::image::{Encoded, Encoding};
use crate::stream::{EffectTable, WaterEffect};
use crate::waterbody::{DepthFactors, VeilingLight, Waterbody};

/// How much a clearer water may strengthen the direct signal.
const MOST_CLEARING: f32 = 1.5;

/// What fusion does to the pixels of each depth.
///
/// [`Model::Aquafuse`] and [`Model::Physical`] add a shift, `cosθ · w(F) · (α B2∞ - B1∞)` with
/// `F = e^(-β_B1 z)` and the model's weight w; β_D has no part in it, for the direct signal stays as it is. Where the waters
/// come with [`DepthFactors`], `Physical` takes F from there; `Aquafuse` is the paper's, which has one exponential.
///
/// [`Model::Relight`] also takes the reference's light, g times the content's ([`Waters::light_gain`]), and a water k times as thick
/// ([`Waters::haze`]): `U + cosθ (G (U - B1) + α B2∞ (1 - F^k) - U)` with `B1 = B1∞ (1 - F)` and
/// `G = (1 + (g - 1) F) F^(k - 1)`, of which the last factor is at most 1.5. With g = k = 1 it is `Physical`.
///
/// [`Model::Exchange`] takes the content's water out and puts the scene into the reference's, which for one
/// depth is a line: `U + cosθ ((U - B1) g + B2 - U)`, B2 with the veil α B2∞ and `g = e^(τ1 - τ2)` bounded by
/// [`Options::max_gain`]. Both optical depths are read at the content's z.
///
/// # Examples
///
/// ```
/// use aquafuse::fusion::{Model, TransferLaw, Options, Waters};
/// use aquafuse::waterbody::{Attenuation, VeilingLight, Waterbody};
///
/// let blue: Waterbody = Waterbody {
///     veiling_light: VeilingLight::new([0.0, 0.2, 0.6]),
///     backscatter_coefficient: [1.0; 3],
///     attenuation: [Attenuation::constant(0.5)?; 3],
/// };
/// let green = Waterbody { veiling_light: VeilingLight::new([0.0, 0.6, 0.2]), ..blue };
/// let law = TransferLaw::new(Waters::new(&blue, &green), &Options::for_model(Model::Aquafuse));
/// assert_eq!(law.at(0.0).of([0.1, 0.5, 0.9]), [0.1, 0.5, 0.9]);
/// // The shift peaks at β_B z = ln 2, at a quarter of the difference times cos 45°.
/// let peak = law.at(2.0_f32.ln()).offset;
/// assert!((peak[1] - 0.25 * 0.4 * 0.5_f32.sqrt()).abs() < 1e-6);
/// # Ok::<(), aquafuse::waterbody::AttenuationError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransferLaw<E: Encoding = Encoded> {
    model: Model,
    cosine: f32,
    content: Waterbody<E>,
    reference: Waterbody<E>,
    /// F instead of `e^(-β_B1 z)`.
    depth_factors: Option<DepthFactors>,
    /// α B2∞, which may exceed 1.
    veil: [f32; 3],
    /// At least 1: less would dim an image in its own water.
    max_gain: f32,
    /// g, the reference's light over the content's, and k, how many times as thick its water is.
    light_gain: [f32; 3],
    haze: [f32; 3],
}

/// What happens to red, green and blue at one depth: `gain · value + offset`.
///
/// A gain of 1 is a shift.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelTransform {
    /// Factors, from 0 to [`Options::max_gain`], so that no order of values is inverted.
    pub gain: [f32; 3],
    /// What is added, in units of `[0, 1]`.
    pub offset: [f32; 3],
    /// What of the offset goes with the square of the share that is no open water.
    bend: [f32; 3],
}

impl PixelTransform {
    /// Nothing happens.
    pub(super) const NONE: Self = Self { gain: [1.0; 3], offset: [0.0; 3], bend: [0.0; 3] };

    /// A colour after the change, not clipped.
    pub fn of(&self, rgb: [f32; 3]) -> [f32; 3] {
        std::array::from_fn(|c| self.gain[c] * rgb[c] + self.offset[c])
    }
}

impl<E: Encoding> TransferLaw<E> {
    /// What happens at distance `z` to a pixel of which the share `w` is open water, by [`at`](Self::at)`(z)`: a shift of the whole
    /// difference for that share, `F = (1 - w) F'`. [`Model::Aquafuse`] takes no part in it.
    #[inline(always)]
    pub fn in_share(&self, things: PixelTransform, w: f32) -> PixelTransform {
        let (left, own) = (1.0 - w, self.content.veiling_light.rgb());
        let mut change = things;
        for c in 0..3 {
            let mut water = self.cosine * (self.veil[c] - own[c]);
            if self.model == Model::Relight {
                change.gain[c] = 1.0 + left * (things.gain[c] - 1.0);
            } else {
                water -= (things.gain[c] - 1.0) * own[c];
            }
            change.offset[c] = left * things.offset[c] + w * water - left * w * things.bend[c];
        }
        change
    }

    /// The law that takes an image from the content's water towards the reference's.
    pub fn new(waters: Waters<'_, E>, options: &Options) -> Self {
        Self {
            model: options.model,
            cosine: options.incidence.cosine(),
            content: *waters.content,
            reference: *waters.reference,
            depth_factors: waters.depth_factors.copied().filter(|_| options.model.reads_depth_factors()),
            veil: waters.reference.veiling_light.rgb().map(|veil| options.gain.get() * veil),
            // `max` also takes a NaN to the safe side.
            max_gain: options.max_gain.max(1.0),
            light_gain: waters.light_gain,
            haze: waters.haze,
        }
    }

    /// The depth factor F of red, green and blue at distance `z`, for a pixel of which the share `w` is open water:
    /// `F = (1 - w) F'(z)`. F' is the depth factor of things: the content's [`DepthFactors`] where the model is [`Model::Physical`] or
    /// [`Model::Relight`] and the waters have them, `e^(-β_B1 z)` otherwise. [`Model::Aquafuse`] does not read `w`.
    ///
    /// # Examples
    ///
    /// `Physical` adds `cosθ (1 - F) (α B2∞ - B1∞)` to the pixel:
    ///
    /// ```
    /// use aquafuse::fusion::{Model, Options, TransferLaw, Waters};
    /// use aquafuse::truth;
    ///
    /// let [blue, green] = [0, 1].map(|i| truth::waters()[i].water);
    /// let law = TransferLaw::new(Waters::new(&blue, &green), &Options::for_model(Model::Physical));
    /// let (z, w) = (2.0, 0.25);
    /// let (factor, shift) = (law.depth_factor(z, w), law.in_share(law.at(z), w).offset);
    /// for c in 0..3 {
    ///     assert_eq!(factor[c], 0.75 * blue.depth_factor(z)[c]);
    ///     let difference = green.veiling_light.rgb()[c] - blue.veiling_light.rgb()[c];
    ///     assert!((shift[c] - (1.0 - factor[c]) * difference).abs() < 1e-6);
    /// }
    /// ```
    pub fn depth_factor(&self, z: f32, w: f32) -> [f32; 3] {
        let of_things =
            self.depth_factors.as_ref().map_or_else(|| self.content.depth_factor(z), |table| table.at(z));
        match self.model {
            Model::Aquafuse => of_things,
            Model::Physical | Model::Relight | Model::Exchange => of_things.map(|factor| (1.0 - w) * factor),
        }
    }

    /// What happens at distance `z`.
    pub fn at(&self, z: f32) -> PixelTransform {
        self.at_with(z, self.of_content(z))
    }

    /// What happens at distance `z` where the content's water does this there.
    pub(super) fn at_with(&self, z: f32, content: WaterEffect) -> PixelTransform {
        match self.model {
            Model::Aquafuse => self.shift(content.factor, |factor| factor * (1.0 - factor)),
            Model::Physical => self.shift(content.factor, |factor| 1.0 - factor),
            Model::Relight => self.relight(content),
            Model::Exchange => self.exchange(z, content),
        }
    }

    /// What the content's water does at distance `z`, and the gain of the direct signal that the exchange asks for.
    pub(crate) fn of_content(&self, z: f32) -> WaterEffect {
        self.of_factor(z, self.depth_factor(z, 0.0))
    }

    /// The same by the depth factor at that distance.
    fn of_factor(&self, z: f32, factor: [f32; 3]) -> WaterEffect {
        let gain = match self.model {
            Model::Aquafuse | Model::Physical => [1.0; 3],
            Model::Relight => self.light_gain,
            Model::Exchange => std::array::from_fn(|c| self.net_gain(c, z)),
        };
        let after = if self.haze == [1.0; 3] {
            factor
        } else {
            std::array::from_fn(|c| factor[c].powf(self.haze[c]))
        };
        WaterEffect { factor, gain, after }
    }

    /// The content's veiling light B1∞.
    pub(crate) fn own_veil(&self) -> [f32; 3] {
        self.content.veiling_light.rgb()
    }

    /// Takes another veiling light for the content's.
    pub(crate) fn set_own_veil(&mut self, veil: [f32; 3]) {
        self.content.veiling_light = VeilingLight::new(veil);
    }

    /// Adds a share of the veils' difference, which depends on the content's depth factor.
    fn shift(&self, factor: [f32; 3], weight: impl Fn(f32) -> f32) -> PixelTransform {
        let own = self.content.veiling_light.rgb();
        let offset = |c: usize| weight(factor[c]) * (self.cosine * (self.veil[c] - own[c]));
        PixelTransform { offset: std::array::from_fn(offset), ..PixelTransform::NONE }
    }

    /// The whole backscatter, the light on near things, and how thick the water is.
    ///
    /// The gain of the light fades with F, for what is left of the direct signal far away is noise; open water is as with
    /// [`Model::Physical`].
    fn relight(&self, content: WaterEffect) -> PixelTransform {
        let own = self.content.veiling_light.rgb();
        let mut change = PixelTransform::NONE;
        for c in 0..3 {
            let (factor, after) = (content.factor[c], content.after[c]);
            // Where F is 0 nothing of a thing is seen, before and after.
            let fading = if after == factor { 1.0 } else { (after / factor).min(MOST_CLEARING) };
            let lit = self.cosine * ((1.0 + (content.gain[c] - 1.0) * factor) * fading - 1.0);
            let veils = self.cosine * (self.veil[c] * (1.0 - after) - own[c] * (1.0 - factor));
            change.gain[c] = 1.0 + lit;
            change.offset[c] = veils - lit * own[c] * (1.0 - factor);
            change.bend[c] = lit * own[c] * factor;
        }
        change
    }

    /// The whole water.
    ///
    /// The bound acts on the gain of both waters together, not on e^τ1 before the reference dims it again:
    /// noise comes out at most that much stronger either way, but a bound on e^τ1 would also dim what
    /// lies far away in an image that is fused with its own water.
    ///
    /// A direct signal U1 - B1 below 0 is noise, or the backscatter was taken too bright. It is kept and
    /// changed as any other: cut off at 0, one's own water would no longer give the image back, and noise
    /// around 0 would lighten the image on average.
    fn exchange(&self, z: f32, content: WaterEffect) -> PixelTransform {
        let veil = self.content.veiling_light.rgb();
        let factor = self.reference.depth_factor(z);
        let mut change = PixelTransform::NONE;
        for c in 0..3 {
            let (own, other) = (veil[c] * (1.0 - content.factor[c]), self.veil[c] * (1.0 - factor[c]));
            let gain = content.gain[c];
            change.gain[c] = 1.0 + self.cosine * (gain - 1.0);
            change.offset[c] = self.cosine * (other - own * gain);
        }
        change
    }

    /// e^(τ1 - τ2) of one channel, bounded.
    fn net_gain(&self, c: usize, z: f32) -> f32 {
        let [own, other] = [&self.content, &self.reference].map(|water| water.attenuation[c].coefficient(z));
        // The difference first: of equal curves nothing is left however far away, where τ would be infinite.
        let difference = (own - other) * z;
        if difference.is_nan() { 1.0 } else { difference.exp().min(self.max_gain) }
    }
}

/// A law, of one image or of a sequence: there the content's water is read from a table.
#[derive(Clone, Copy)]
pub(crate) struct LawInUse<'a, E: Encoding> {
    law: &'a TransferLaw<E>,
    table: Option<&'a EffectTable>,
}

impl<'a, E: Encoding> LawInUse<'a, E> {
    /// The law, with the content's water read from `table` if there is one.
    pub(crate) fn new(law: &'a TransferLaw<E>, table: Option<&'a EffectTable>) -> Self {
        Self { law, table }
    }

    /// Which model it is of.
    pub(super) fn model(&self) -> Model {
        self.law.model
    }

    /// Whether it is [`Model::Relight`] in water of the same thickness.
    pub(super) fn is_light_alone(&self) -> bool {
        self.law.model == Model::Relight && self.law.haze == [1.0; 3]
    }

    /// What the content's water does at distance `z`.
    pub(super) fn effect(&self, z: f32) -> WaterEffect {
        self.table.map_or_else(|| self.law.of_content(z), |table| table.at(z))
    }

    /// cosθ, the content's veil B1∞ and α B2∞.
    pub(super) fn veils(&self) -> (f32, [[f32; 3]; 2]) {
        (self.law.cosine, [self.law.own_veil(), self.law.veil])
    }

    /// What happens at distance `z`.
    pub(super) fn at(&self, z: f32) -> PixelTransform {
        self.law.at_with(z, self.effect(z))
    }

    /// What happens at one distance after another, none nearer than the one before.
    pub(super) fn at_each(
        &self,
        distances: impl Iterator<Item = f32>,
    ) -> impl Iterator<Item = PixelTransform> {
        let (law, table) = (self.law, self.table);
        let mut factors = law.depth_factors.as_ref().map(DepthFactors::rising);
        distances.map(move |z| {
            let content = match (table, &mut factors) {
                (Some(table), _) => table.at(z),
                (None, Some(factors)) => law.of_factor(z, factors(z)),
                (None, None) => law.of_content(z),
            };
            law.at_with(z, content)
        })
    }

    /// As [`TransferLaw::in_share`].
    #[inline(always)]
    pub(super) fn in_share(&self, things: PixelTransform, w: f32) -> PixelTransform {
        self.law.in_share(things, w)
    }
}
