//! The water of a sequence: what the estimates of its frames say together.

use super::effect::{EffectTable, WaterEffect};
use super::glance::{Change, Glance};
use super::levels::SteadyLevels;
use crate::depth::DepthMap;
use crate::formation::BoundedRestoration;
use crate::fusion::{self, Bounded, LawInUse, TransferLaw};
use crate::image::{Clipping, Encoding, ImageError, ImageMut, ImageRef, Sample};
use crate::levels::{Levels, LevelsOptions};
use crate::waterbody::{Estimate, Verdict, WaterShare};

/// Deviations to either side of a normal error that an interval spans.
const NINE_IN_TEN: f32 = 1.645;
/// Deviations of B∞ and of ln β_B that any frame has, however narrow its intervals are.
const VEIL_DEVIATION: f32 = 2.0 / 255.0;
const GROWTH_DEVIATION: f32 = 0.1;

/// How much B∞ of a frame counts by its verdict.
fn trust(verdict: Verdict) -> f32 {
    match verdict {
        Verdict::Good => 1.0,
        Verdict::Doubtful => 0.25,
        Verdict::Failed => 0.0625,
    }
}

/// What the frames of a sequence say together, so that their water and their levels do not flicker.
///
/// A quantity x follows its estimates y, of weight w, with a memory of n frames. At frame t, counted from 1, with `r = 1 / min(t, n)`:
///
/// `W ← W + r (w - W)`, `x ← x + r min(1, w / W) (y - x)`
///
/// Without the bound that is the mean of all estimates, weighted by w and, after n frames, by `(1 - 1/n)^age`: the answer of least
/// squares that forget. With it, a sure frame after unsure ones makes no jump. Weights are inverse variances: only how they
/// compare matters, since frames of one sequence err alike. The first frame is taken as it is.
///
/// | quantity | weight |
/// |---|---|
/// | B∞, which goes with the exposure from frame to frame | its interval, and the verdict: a doubtful frame counts a quarter |
/// | F by distance | the interval of β_B |
/// | gain of the direct signal by distance; how sure it is that open water is in view; [`Levels`] | 1 |
///
/// F and gain are followed after all safety bounds, so that a bound that comes or goes does so over n frames. A scene cut begins
/// again. No frame waits for another.
///
/// [`Stream`](super::Stream), [`RestoreStream`](super::RestoreStream) and [`EnhanceStream`](super::EnhanceStream) use it; here are
/// its steps, for those who estimate by themselves.
///
/// # Examples
///
/// ```
/// use aquafuse::fusion::{Bounded, Options};
/// use aquafuse::{depth, image::Image, stream::Steady, truth, waterbody, waterbody::Estimate};
///
/// let [own, other] = [0, 1].map(|i| truth::waters()[i].water);
/// let size = truth::Size { width: 96, height: 64 };
/// let mut steady = Steady::default();
/// for step in 0..3 {
///     let pose = truth::Pose { yaw: 0.01 * step as f32, ..Default::default() };
///     let scene = truth::Scene::from(Default::default(), 1, &pose, size);
///     let mut frame: Image<u8> = scene.seen_through(&own).convert();
///     let z = depth::estimate(&frame);
///     let (found, share) = waterbody::estimate_with_share(&frame, &z, &Default::default())?;
///     let bounded = Bounded::new(&found, &Estimate::given(other), Options::default());
///     steady.look(&frame);
///     steady.fuse_mut(&mut frame, &z, &found, &share, &bounded)?;
/// }
/// # Ok::<(), aquafuse::image::ImageError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Steady {
    frames: usize,
    glance: Glance,
    follows_exposure: bool,
    /// How many times brighter the frame is than the last one.
    brighter: f32,
    /// And than the one whose water was estimated last.
    since_estimate: f32,
    water: Option<State>,
    levels: SteadyLevels,
    /// What the last frame says by itself, in memory that is used again.
    frame: Option<EffectTable>,
    /// Whether the state is what the last frame says by itself.
    is_frame: bool,
}

#[derive(Clone, Debug)]
struct State {
    /// Frames so far.
    age: usize,
    veil: [f32; 3],
    veil_weight: [Weight; 3],
    effect: EffectTable,
    factor_weight: [Weight; 3],
    sure: f32,
}

/// The mean weight W of the frames so far.
#[derive(Clone, Copy, Debug)]
struct Weight(f32);

impl Weight {
    /// The share of the way to go to a frame of weight `w`.
    fn step(&mut self, w: f32, rate: f32) -> f32 {
        self.0 += rate * (w - self.0);
        rate * (w / self.0).min(1.0)
    }
}

/// What one frame says.
struct Frame<F> {
    /// B∞.
    veil: [f32; 3],
    veil_weight: [f32; 3],
    /// What the water does by distance.
    effect: F,
    factor_weight: [f32; 3],
    /// How sure it is that open water is in view.
    sure: f32,
}

impl<F: Fn(f32) -> WaterEffect> Frame<F> {
    /// A frame of this estimate; `veil` is its B∞ within the bounds.
    fn of<E: Encoding>(estimate: &Estimate<E>, veil: [f32; 3], effect: F, sure: f32) -> Self {
        let trust = trust(estimate.quality.verdict);
        let weight = |half: f32, least: f32| ((half / NINE_IN_TEN).powi(2) + least * least).recip();
        let veil_weight = std::array::from_fn(|c| {
            let [low, high] = estimate.intervals.veiling_light[c].map(E::to_encoded);
            trust * weight(0.5 * (high - low), VEIL_DEVIATION)
        });
        let factor_weight = std::array::from_fn(|c| {
            let [low, high] = estimate.intervals.backscatter_coefficient[c];
            let half = if low > 0.0 { 0.5 * (high / low).ln() } else { 0.0 };
            weight(half, GROWTH_DEVIATION)
        });
        Self { veil, veil_weight, effect, factor_weight, sure }
    }
}

impl Default for Steady {
    /// A memory of 8 frames.
    fn default() -> Self {
        Self::over(Self::FRAMES)
    }
}

impl Steady {
    /// Frames that are remembered unless said otherwise: fewer flicker more, more follow a change of the water too late.
    pub const FRAMES: usize = 8;

    /// A memory of so many frames; 1, or 0, is none: each frame is then as it is by itself.
    #[must_use]
    pub fn over(frames: usize) -> Self {
        Self {
            frames: frames.max(1),
            glance: Glance::default(),
            follows_exposure: true,
            brighter: 1.0,
            since_estimate: 1.0,
            water: None,
            levels: SteadyLevels::default(),
            frame: None,
            is_frame: true,
        }
    }

    /// Forgets all frames.
    pub fn reset(&mut self) {
        (self.water, self.levels) = (None, SteadyLevels::default());
    }

    /// Looks at the next frame, as it is before it is changed: a cut resets, a change of exposure is followed. To be called once for
    /// each frame, before its water or its levels are used.
    pub fn look<'a>(&mut self, frame: impl Into<ImageRef<'a, u8>>) {
        self.is_same_scene(frame.into());
    }

    /// [`Steady::look`]; whether the frame is to be taken together with the one before it.
    pub(crate) fn is_same_scene(&mut self, frame: ImageRef<'_, u8>) -> bool {
        let change = self.glance.next(frame);
        match change {
            Change::Cut => {
                self.reset();
                self.brighter = 1.0;
            }
            Change::Goes(brighter) if self.follows_exposure => self.brighter = brighter,
            Change::Goes(_) => {}
        }
        self.since_estimate *= self.brighter;
        change != Change::Cut && self.frames > 1
    }

    /// [`fusion::fuse_mut`] with the water of the sequence. `bounded` is of this frame's estimate.
    ///
    /// # Errors
    ///
    /// [`ImageError`] when image, depth map and share differ in size; the image is then unchanged.
    pub fn fuse_mut<'a, T: Sample, E: Encoding>(
        &mut self,
        image: impl Into<ImageMut<'a, T, E>>,
        depth: &DepthMap,
        estimate: &Estimate<E>,
        share: &WaterShare,
        bounded: &Bounded<E>,
    ) -> Result<Clipping, ImageError> {
        let image = image.into();
        depth.check_fits(image.size())?;
        self.is_estimated();
        let mut law = TransferLaw::new(bounded.waters(), &bounded.options);
        let sure = self.follow_fusion(estimate, &mut law, depth, share.sure());
        let share = share.clone().with_sure(sure);
        fusion::fuse_by(None, image, depth, LawInUse::new(&law, self.effect()), Some(&share))
    }

    /// [`formation::restore_mut`](crate::formation::restore_mut) with the water of the sequence. `bounded` is of this frame's estimate.
    ///
    /// # Errors
    ///
    /// [`ImageError`] when image and depth map differ in size; the image is then unchanged.
    pub fn restore_mut<'a, T: Sample, E: Encoding>(
        &mut self,
        image: impl Into<ImageMut<'a, T, E>>,
        depth: &DepthMap,
        estimate: &Estimate<E>,
        bounded: &BoundedRestoration<E>,
    ) -> Result<Clipping, ImageError> {
        let image = image.into();
        depth.check_fits(image.size())?;
        let veil = self.follow_restoration(estimate, bounded, depth);
        bounded.restore_by_mut(image, depth, veil, self.effect())
    }

    /// [`BoundedRestoration::restore_and_level_mut`] with water and levels of the sequence. `bounded` is of this frame's estimate.
    ///
    /// # Errors
    ///
    /// [`ImageError`] when image and depth map differ in size; the image is then unchanged.
    pub fn restore_and_level_mut<'a, T: Sample, E: Encoding>(
        &mut self,
        image: impl Into<ImageMut<'a, T>>,
        depth: &DepthMap,
        estimate: &Estimate<E>,
        bounded: &BoundedRestoration<E>,
        options: &LevelsOptions,
    ) -> Result<(Clipping, Levels), ImageError> {
        let image = image.into();
        depth.check_fits(image.size())?;
        let veil = self.follow_restoration(estimate, bounded, depth);
        let (effect, levels) = (self.water.as_ref().filter(|_| !self.is_frame), &mut self.levels);
        let effect = effect.map(|state| &state.effect);
        let found = bounded.levels_by(image.as_ref(), depth, options, veil, effect);
        let found = levels.follow(found, self.brighter, self.frames);
        Ok((bounded.restore_and_level_by_mut(image, depth, &found, veil, effect), found))
    }

    /// [`Levels::of`] and [`Levels::apply`] with the levels of the sequence.
    pub fn enhance_mut<'a, T: Sample>(
        &mut self,
        image: impl Into<ImageMut<'a, T>>,
        options: &LevelsOptions,
    ) -> (Clipping, Levels) {
        let image = image.into();
        let levels = Levels::of(image.as_ref(), options);
        let levels = self.levels.follow(levels, self.brighter, self.frames);
        (levels.apply(image), levels)
    }

    /// For a water that is the same in every frame.
    pub(crate) fn ignore_exposure(&mut self) {
        self.follows_exposure = false;
    }

    /// Says that the water of this frame was estimated, not that of one before.
    pub(crate) fn is_estimated(&mut self) {
        self.since_estimate = 1.0;
    }

    /// Takes what a frame says, and sets the veiling light of its law; how sure it is that open water is in view.
    pub(crate) fn follow_fusion<E: Encoding>(
        &mut self,
        estimate: &Estimate<E>,
        law: &mut TransferLaw<E>,
        depth: &DepthMap,
        sure: f32,
    ) -> f32 {
        law.set_own_veil(exposed::<E>(law.own_veil(), self.since_estimate));
        let by_frame = *law;
        let frame = Frame::of(estimate, law.own_veil(), |z| by_frame.of_content(z), sure);
        let (veil, sure) = self.follow::<E>(&frame, depth);
        law.set_own_veil(veil);
        sure
    }

    /// Takes what a frame says; the veiling light of the sequence.
    fn follow_restoration<E: Encoding>(
        &mut self,
        estimate: &Estimate<E>,
        bounded: &BoundedRestoration<E>,
        depth: &DepthMap,
    ) -> [f32; 3] {
        let veil = bounded.water.veiling_light.rgb();
        self.follow::<E>(&Frame::of(estimate, veil, bounded.effect(), 0.0), depth).0
    }

    /// Takes what a frame says, and returns veiling light and sureness of the sequence.
    fn follow<E: Encoding>(
        &mut self,
        frame: &Frame<impl Fn(f32) -> WaterEffect>,
        depth: &DepthMap,
    ) -> ([f32; 3], f32) {
        let Some(state) = &mut self.water else {
            let effect = EffectTable::new(depth.reach(), &frame.effect);
            let [veil_weight, factor_weight] =
                [frame.veil_weight, frame.factor_weight].map(|weights| weights.map(Weight));
            let (veil, sure) = (frame.veil, frame.sure);
            self.frame = Some(effect.clone());
            self.water = Some(State { age: 1, veil, veil_weight, effect, factor_weight, sure });
            self.is_frame = true;
            return (veil, sure);
        };
        state.age = state.age.saturating_add(1);
        let rate = 1.0 / state.age.min(self.frames) as f32;
        let step = |weights: &mut [Weight; 3], w: [f32; 3]| -> [f32; 3] {
            std::array::from_fn(|c| weights[c].step(w[c], rate))
        };
        let before = exposed::<E>(state.veil, self.brighter);
        let of_veil = step(&mut state.veil_weight, frame.veil_weight);
        state.veil = std::array::from_fn(|c| mixed(before[c], frame.veil[c], of_veil[c]));
        let own = self.frame.get_or_insert_with(|| state.effect.clone());
        own.fill(&frame.effect);
        state.effect.approach(own, step(&mut state.factor_weight, frame.factor_weight), rate);
        state.sure = mixed(state.sure, frame.sure, rate);
        self.is_frame = state.effect == *own;
        (state.veil, state.sure)
    }

    /// What the water of the sequence does by distance; none if that is what the last frame says by itself.
    pub(crate) fn effect(&self) -> Option<&EffectTable> {
        self.water.as_ref().filter(|_| !self.is_frame).map(|state| &state.effect)
    }
}

/// The share `step` of the way: the whole, and between equal numbers any, to the bit.
pub(super) fn mixed(from: f32, to: f32, step: f32) -> f32 {
    if step == 1.0 { to } else { from + step * (to - from) }
}

/// A colour in so many times the light, within its range.
fn exposed<E: Encoding>(colour: [f32; 3], brighter: f32) -> [f32; 3] {
    match brighter {
        1.0 => colour,
        _ => colour.map(|value| E::from_encoded((brighter * E::to_encoded(value)).min(1.0))),
    }
}

#[cfg(test)]
mod tests;
