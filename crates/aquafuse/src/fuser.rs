//! The front door: one image in another's water, every step within its safety bounds.

mod memory;

pub(crate) use memory::Memory;

use std::borrow::Cow;

use crate::depth::{DepthMap, DepthModel};
use crate::fusion::{self, Bounded, Bounds, Gain, Incidence, LawInUse, Model, OptionError, TransferLaw};
use crate::image::{Clipping, Image, ImageError, ImageMut, ImageRef, Sample, check_same_size};
use crate::scene_area::{Border, Margins, SceneArea};
use crate::smooth::{self, Smoothing};
use crate::stream::Steady;
use crate::waterbody::{self, Estimate, EstimateOptions, Glimpse, Look, WaterShare, Waterbody, sureness};

/// Fuses images with the water of one reference.
///
/// It estimates depth and water of the content, bounds the fusion by what both estimates are worth
/// ([`Bounded`]), and fuses. The [`Report`] says how good the content's estimate is, which bounds acted and how many
/// values were clipped. The modules [`depth`](crate::depth), [`waterbody`] and [`fusion`] do the same one by one,
/// for those who need something between the steps; [`Stream`](crate::stream::Stream) does it for video.
///
/// Images are views ([`ImageRef`]), `&`[`Image`], or what converts to a view. Values are encoded (sRGB); the steps one
/// by one also work in linear light.
///
/// # Examples
///
/// ```
/// use aquafuse::{Fuser, fusion::Model, truth};
///
/// let size = truth::Size { width: 96, height: 64 };
/// let [blue, green] = [0, 1].map(|i| truth::waters()[i].water);
/// let content = truth::Scene::new(1, size).seen_through(&blue);
/// let reference = truth::Scene::new(2, size).seen_through(&green);
///
/// let fuser = Fuser::new(&reference)?.model(Model::Physical).theta(30.0)?;
/// let fused = fuser.fuse(&content)?;
/// assert_eq!(fused.image.size(), (96, 64));
/// println!("{:?}, bounds: {:?}", fused.report.content.quality.verdict, fused.report.bounds);
///
/// // The same scene in a water from a table, with its true depth.
/// let z = truth::Scene::new(1, size).depth;
/// let fused = Fuser::from(green).depth(&z).fuse(&content)?;
/// assert!(fused.report.content.depth_model.is_none());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Fuser<'z> {
    reference: Estimate,
    options: Options,
    /// What was set, whichever model comes after it.
    theta: Option<Incidence>,
    /// The content's depth; estimated from colour where there is none.
    depth: Option<&'z DepthMap>,
}

/// How a [`Fuser`] estimates and fuses.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Options {
    /// The depth model, where no depth map is supplied. Default: the paper's, Eq. 3.
    pub depth_model: DepthModel,
    /// How waters are estimated.
    pub estimate: EstimateOptions,
    /// How they are fused.
    pub fusion: fusion::Options,
    /// How the fused image is smoothed. Default: not at all.
    pub smoothing: Smoothing,
    /// What surrounds the scene: it is left out of estimates and stays as it is. Default: found in each image. Numbers are
    /// those of contents; in a reference it is then found.
    pub border: Border,
}

/// What [`Fuser::fuse`] returns.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
#[must_use]
pub struct Outcome<T> {
    /// The content in the reference's water.
    pub image: Image<T>,
    /// How it went.
    pub report: Report,
}

/// How a fusion went.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Report {
    /// The content's own water, and in its quality the verdict on it.
    pub content: Estimate,
    /// Which safety bounds acted.
    pub bounds: Bounds,
    /// Values that did not fit into the range.
    pub clipping: Clipping,
    /// The sides that were left as they are.
    pub margins: Margins,
}

impl Fuser<'static> {
    /// A fuser into the water of `reference`, with default options.
    ///
    /// # Errors
    ///
    /// [`ImageError`] when `reference` is no image: a foreign one without pixels, for example.
    pub fn new<'a, T: Sample, I>(reference: I) -> Result<Self, ImageError>
    where
        I: TryInto<ImageRef<'a, T>>,
        ImageError: From<I::Error>,
    {
        Self::with_options(reference, Options::default())
    }

    /// [`Fuser::new`] with options, by which the reference's water is estimated too.
    ///
    /// # Errors
    ///
    /// As [`Fuser::new`].
    pub fn with_options<'a, T: Sample, I>(reference: I, options: Options) -> Result<Self, ImageError>
    where
        I: TryInto<ImageRef<'a, T>>,
        ImageError: From<I::Error>,
    {
        let reference = reference.try_into()?;
        let reference = options.estimate_in(reference, None, &mut Memory::default())?;
        Ok(Self::from_estimate(reference, options))
    }

    /// [`Fuser::with_options`] with a depth map of the reference, measured or supplied, instead of depth from colour.
    ///
    /// # Errors
    ///
    /// [`ImageError`] when the two differ in size, or as [`Fuser::new`].
    pub fn with_depth<'a, T: Sample, I>(
        reference: I,
        depth: &DepthMap,
        options: Options,
    ) -> Result<Self, ImageError>
    where
        I: TryInto<ImageRef<'a, T>>,
        ImageError: From<I::Error>,
    {
        let reference = reference.try_into()?;
        let reference = options.estimate_in(reference, Some(depth), &mut Memory::default())?;
        Ok(Self::from_estimate(reference, options))
    }

    /// A fuser into a water that was estimated before, or is known ([`Estimate::given`]).
    ///
    /// [`Model::Exchange`] uses the coefficients of both waters: they must be per the same unit of depth.
    #[must_use]
    pub fn from_estimate(reference: Estimate, options: Options) -> Self {
        Self { reference, options, theta: None, depth: None }
    }
}

impl From<Estimate> for Fuser<'static> {
    fn from(reference: Estimate) -> Self {
        Self::from_estimate(reference, Options::default())
    }
}

/// A water that is known, from a file or a preset.
impl From<Waterbody> for Fuser<'static> {
    fn from(reference: Waterbody) -> Self {
        Self::from(Estimate::given(reference))
    }
}

impl<'z> Fuser<'z> {
    /// Takes another model, with its default θ unless [`theta`](Self::theta) was called.
    #[must_use]
    pub fn model(mut self, model: Model) -> Self {
        let fusion = &mut self.options.fusion;
        fusion.model = model;
        fusion.incidence = self.theta.unwrap_or(fusion::Options::for_model(model).incidence);
        self
    }

    /// Sets the incidence θ in degrees, 0 (most fusion) to 90 (none).
    ///
    /// # Errors
    ///
    /// [`OptionError::Incidence`] outside this range.
    pub fn theta(mut self, degrees: f32) -> Result<Self, OptionError> {
        let theta = Incidence::from_degrees(degrees)?;
        (self.theta, self.options.fusion.incidence) = (Some(theta), theta);
        Ok(self)
    }

    /// Sets the gain α on the reference's veiling light; 1 takes it as it is.
    ///
    /// # Errors
    ///
    /// [`OptionError::Gain`] when it is negative or not finite.
    pub fn alpha(mut self, gain: f32) -> Result<Self, OptionError> {
        self.options.fusion.gain = Gain::new(gain)?;
        Ok(self)
    }

    /// Sets how fused images are smoothed.
    #[must_use]
    pub fn smoothing(mut self, smoothing: Smoothing) -> Self {
        self.options.smoothing = smoothing;
        self
    }

    /// Takes `depth` for the depth of the content, measured or supplied, instead of depth from colour. A content of
    /// another size is then an error.
    #[must_use]
    pub fn depth(self, depth: &DepthMap) -> Fuser<'_> {
        Fuser { depth: Some(depth), reference: self.reference, options: self.options, theta: self.theta }
    }

    pub(crate) fn refer_to(&mut self, reference: Estimate) {
        self.reference = reference;
    }

    /// The water that images are fused into.
    #[must_use]
    pub fn reference(&self) -> &Estimate {
        &self.reference
    }

    /// The options of estimates and fusion.
    #[must_use]
    pub fn options(&self) -> &Options {
        &self.options
    }

    /// Fuses `content`, which keeps its objects, with the reference's water.
    ///
    /// # Errors
    ///
    /// [`ImageError`] when `content` is no image, or has another size than its depth map.
    pub fn fuse<'a, T: Sample, I>(&self, content: I) -> Result<Outcome<T>, ImageError>
    where
        I: TryInto<ImageRef<'a, T>>,
        ImageError: From<I::Error>,
    {
        let mut image = content.try_into()?.to_image();
        let report = self.fuse_in(None, image.view_mut(), None, &mut Memory::default())?;
        Ok(Outcome { image, report })
    }

    /// [`Fuser::fuse`] in place: the content becomes the fused image.
    ///
    /// # Errors
    ///
    /// As [`Fuser::fuse`]; the content is then unchanged.
    pub fn fuse_mut<'a, T: Sample, I>(&self, content: I) -> Result<Report, ImageError>
    where
        I: TryInto<ImageMut<'a, T>>,
        ImageError: From<I::Error>,
    {
        self.fuse_in(None, content.try_into()?, None, &mut Memory::default())
    }

    /// [`Fuser::fuse`] into an image that is there already, which keeps nothing of what it was.
    ///
    /// # Errors
    ///
    /// [`ImageError`] when one of the two is no image, or when content, depth map and `fused` differ in size;
    /// `fused` is then unchanged.
    pub fn fuse_into<'a, 'b, T: Sample, I, O>(&self, content: I, fused: O) -> Result<Report, ImageError>
    where
        I: TryInto<ImageRef<'a, T>>,
        O: TryInto<ImageMut<'b, T>>,
        ImageError: From<I::Error> + From<O::Error>,
    {
        self.fuse_in(Some(content.try_into()?), fused.try_into()?, None, &mut Memory::default())
    }

    /// Fuses the content, or `fused` itself if there is none, into `fused`, in the memory of the last image.
    /// The content's water is estimated unless it is `known`.
    pub(crate) fn fuse_in<T: Sample>(
        &self,
        content: Option<ImageRef<'_, T>>,
        mut fused: ImageMut<'_, T>,
        known: Option<Estimate>,
        memory: &mut Memory<T>,
    ) -> Result<Report, ImageError> {
        let source = content.unwrap_or(fused.as_ref());
        check_same_size(source.size(), fused.size())?;
        let area = memory.area(source, self.options.border)?;
        if area.is_whole() {
            memory.area = Some(area);
            return self.fuse_scene(content, fused, self.depth, known, memory);
        }
        let mut scene = area.cut(source);
        let depth = self.depth.map(|depth| depth.cut(&area)).transpose()?;
        let report = self.fuse_scene(None, scene.view_mut(), depth.as_ref(), known, memory)?;
        if let Some(content) = content {
            fused.copy_from(content)?;
        }
        area.put_back(&scene, fused)?;
        let margins = area.margins();
        memory.area = Some(area);
        Ok(Report { margins, ..report })
    }

    /// The same for an image of which every pixel is scene.
    fn fuse_scene<T: Sample>(
        &self,
        content: Option<ImageRef<'_, T>>,
        fused: ImageMut<'_, T>,
        depth: Option<&DepthMap>,
        known: Option<Estimate>,
        memory: &mut Memory<T>,
    ) -> Result<Report, ImageError> {
        let source = content.unwrap_or(fused.as_ref());
        let depth = self.options.depth_in(source, depth, memory);
        let Memory { glimpse, steady, .. } = memory;
        let found = self.content_in(source, &depth, known, glimpse, steady.as_mut())?;
        let law = LawInUse::new(&found.law, steady.as_ref().and_then(Steady::effect));
        let share = Some(&found.share);
        let clipping = match self.options.smoothing {
            Smoothing::None => fusion::fuse_by(content, fused, &depth, law, share)?,
            Smoothing::Bilateral => {
                let mut samples = std::mem::take(&mut memory.samples);
                samples.resize(3 * source.width() * source.height(), T::default());
                let mut rough = Image::from_raw(source.width(), source.height(), samples)?;
                let clipping = fusion::fuse_by(Some(source), rough.view_mut(), &depth, law, share)?;
                smooth::bilateral_into(&rough, fused)?;
                memory.samples = rough.into_raw();
                clipping
            }
        };
        memory.take_back(depth);
        Ok(Report { content: found.water, bounds: found.bounds, clipping, margins: Margins::default() })
    }
}

/// What is found of a content: its water, the law by it, and how much of each pixel is open water, if the model reads that.
struct Found {
    water: Estimate,
    bounds: Bounds,
    law: TransferLaw,
    share: WaterShare,
}

impl Fuser<'_> {
    /// The content's water, unless it is `known`, and what follows from it.
    fn content_in<T: Sample>(
        &self,
        content: ImageRef<'_, T>,
        depth: &DepthMap,
        known: Option<Estimate>,
        glimpse: &mut Glimpse,
        mut steady: Option<&mut Steady>,
    ) -> Result<Found, ImageError> {
        let reads_share = self.options.fusion.model != Model::Aquafuse;
        on_bytes(content, |bytes| {
            let is_same_scene = steady.as_mut().is_some_and(|steady| steady.is_same_scene(bytes));
            glimpse.next(is_same_scene);
            if let Some(steady) = steady.as_mut().filter(|_| known.is_none()) {
                steady.is_estimated();
            }
            let law_by = |water: Estimate| {
                let bounded = Bounded::new(&water, &self.reference, self.options.fusion);
                (bounded.bounds, TransferLaw::new(bounded.waters(), &bounded.options))
            };
            let follow = |water: &Estimate, law: &mut TransferLaw, seen: f32| {
                let sure = sureness(seen);
                let sure = steady.map_or(sure, |steady| steady.follow_fusion(water, law, depth, sure));
                (law.own_veil(), sure)
            };
            match known {
                Some(water) => {
                    let (bounds, mut law) = law_by(water);
                    let share = match reads_share {
                        true => {
                            let options = &self.options.estimate;
                            waterbody::water_share_by(bytes, depth, options, glimpse, |seen| {
                                follow(&water, &mut law, seen)
                            })?
                        }
                        false => {
                            follow(&water, &mut law, 0.0);
                            WaterShare::none(content.size())
                        }
                    };
                    Ok(Found { water, bounds, law, share })
                }
                None => waterbody::estimate_in(
                    bytes,
                    depth,
                    &self.options.estimate,
                    glimpse,
                    |looked: &Look<_>, whole, depth| {
                        let water = looked.judged(depth);
                        let (bounds, mut law) = law_by(water);
                        let share = match reads_share {
                            true => looked.share_by(whole, depth, |seen| follow(&water, &mut law, seen)),
                            false => {
                                follow(&water, &mut law, 0.0);
                                WaterShare::none(content.size())
                            }
                        };
                        Found { water, bounds, law, share }
                    },
                ),
            }
        })
    }
}

/// Shows an image as estimators see it: in bytes.
pub(crate) fn on_bytes<T: Sample, R>(image: ImageRef<'_, T>, look: impl FnOnce(ImageRef<'_, u8>) -> R) -> R {
    match image.as_bytes() {
        Some(bytes) => look(bytes),
        None => look(image.to_image().convert::<u8>().view()),
    }
}

impl Options {
    /// The same with another depth model.
    #[must_use]
    pub fn with_depth_model(self, depth_model: DepthModel) -> Self {
        Self { depth_model, ..self }
    }

    /// The same with other options of estimates.
    #[must_use]
    pub fn with_estimate(self, estimate: EstimateOptions) -> Self {
        Self { estimate, ..self }
    }

    /// The same with other options of fusion.
    #[must_use]
    pub fn with_fusion(self, fusion: fusion::Options) -> Self {
        Self { fusion, ..self }
    }

    /// The same with another smoothing.
    #[must_use]
    pub fn with_smoothing(self, smoothing: Smoothing) -> Self {
        Self { smoothing, ..self }
    }

    /// The same with another border.
    #[must_use]
    pub fn with_border(self, border: Border) -> Self {
        Self { border, ..self }
    }

    /// The water of an image that gives it, in the memory of the last one.
    pub(crate) fn estimate_in<T: Sample>(
        &self,
        image: ImageRef<'_, T>,
        depth: Option<&DepthMap>,
        memory: &mut Memory<T>,
    ) -> Result<Estimate, ImageError> {
        let area = SceneArea::of(image, self.border.of_reference())?;
        if !area.is_whole() {
            let depth = depth.map(|depth| depth.cut(&area)).transpose()?;
            let whole = Self { border: Border::None, ..*self };
            return whole.estimate_in(area.cut(image).view(), depth.as_ref(), memory);
        }
        let depth = self.depth_in(image, depth, memory);
        // What was seen in the frames of a sequence is kept for its next one.
        let kept = std::mem::take(&mut memory.glimpse);
        let found = self.water_in(image, &depth, memory);
        memory.glimpse = kept;
        memory.take_back(depth);
        found
    }

    pub(crate) fn depth_in<'z, T: Sample>(
        &self,
        image: ImageRef<'_, T>,
        depth: Option<&'z DepthMap>,
        memory: &mut Memory<T>,
    ) -> Cow<'z, DepthMap> {
        match depth {
            Some(depth) => Cow::Borrowed(depth),
            None => {
                let buffers = std::mem::take(&mut memory.depth);
                Cow::Owned(self.depth_model.estimate_in(image, self.estimate.top, buffers))
            }
        }
    }

    pub(crate) fn water_in<T: Sample>(
        &self,
        image: ImageRef<'_, T>,
        depth: &DepthMap,
        memory: &mut Memory<T>,
    ) -> Result<Estimate, ImageError> {
        on_bytes(image, |bytes| {
            let judged = |looked: &Look<_>, _: waterbody::Seen<'_>, depth: &DepthMap| looked.judged(depth);
            waterbody::estimate_in(bytes, depth, &self.estimate, &mut memory.glimpse, judged)
        })
    }
}

#[cfg(test)]
mod tests;
