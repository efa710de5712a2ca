//! Restoration and enhancement, frame after frame.

use super::steady::Steady;
use crate::depth::{DepthMap, DepthModel};
use crate::formation::{BoundedRestoration, RestoreBounds, RestoreOptions};
use crate::fuser::{Memory, Options, on_bytes};
use crate::image::{Clipping, ImageError, ImageMut, Sample};
use crate::levels::{Levels, LevelsOptions};
use crate::scene_area::{Border, Margins};
use crate::waterbody::{Estimate, EstimateOptions};

/// Restores the frames of a sequence as if seen through air, and sets their levels, with water and levels that change smoothly
/// ([`Steady`]).
///
/// # Examples
///
/// ```
/// use aquafuse::{image::Image, stream::RestoreStream, truth};
///
/// let size = truth::Size { width: 96, height: 64 };
/// let mut stream = RestoreStream::default();
/// for step in 0..3 {
///     let pose = truth::Pose { yaw: 0.01 * step as f32, ..Default::default() };
///     let scene = truth::Scene::from(Default::default(), 1, &pose, size);
///     let mut frame: Image<u8> = scene.seen_through(&truth::waters()[0].water).convert();
///     let report = stream.restore_mut(&mut frame)?;
///     println!("{:?}", report.content.quality);
/// }
/// # Ok::<(), aquafuse::image::ImageError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct RestoreStream<'z, T = u8> {
    estimates: Options,
    restoration: RestoreOptions,
    levels: LevelsOptions,
    depth: Option<&'z DepthMap>,
    steady: Steady,
    memory: Memory<T>,
}

/// How the restoration of a frame went.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct RestoreReport {
    /// The water of this frame by itself, and in its quality the verdict on it.
    pub content: Estimate,
    /// Which safety bounds acted on this frame.
    pub bounds: RestoreBounds,
    /// Values that did not fit into the range.
    pub clipping: Clipping,
    /// The levels that were set; `None` if none are wanted.
    pub levels: Option<Levels>,
    /// The sides that were left as they are.
    pub margins: Margins,
}

impl<'z, T: Sample> RestoreStream<'z, T> {
    /// Restores with these options.
    #[must_use]
    pub fn restoration(self, restoration: RestoreOptions) -> Self {
        Self { restoration, ..self }
    }

    /// Sets levels with these options.
    #[must_use]
    pub fn levels(self, levels: LevelsOptions) -> Self {
        Self { levels, ..self }
    }

    /// Takes another depth model.
    #[must_use]
    pub fn depth_model(self, depth_model: DepthModel) -> Self {
        Self { estimates: self.estimates.with_depth_model(depth_model), ..self }
    }

    /// Estimates waters with these options.
    #[must_use]
    pub fn estimate(self, estimate: EstimateOptions) -> Self {
        Self { estimates: self.estimates.with_estimate(estimate), ..self }
    }

    /// Says what surrounds the scene.
    #[must_use]
    pub fn border(self, border: Border) -> Self {
        Self { estimates: self.estimates.with_border(border), ..self }
    }

    /// Takes `depth` for the depth of every frame. A frame of another size is then an error.
    #[must_use]
    pub fn depth(self, depth: &DepthMap) -> RestoreStream<'_, T> {
        RestoreStream { depth: Some(depth), ..self }
    }

    /// Averages water and levels over about so many frames. Default: 8. 1, or 0: each frame by itself.
    #[must_use]
    pub fn steady_over(self, frames: usize) -> Self {
        Self { steady: Steady::over(frames), ..self }
    }

    /// Restores a frame in place.
    ///
    /// # Errors
    ///
    /// [`ImageError`] when the depth map, if there is one, is of another size; the frame is then unchanged.
    pub fn restore_mut<'a>(
        &mut self,
        frame: impl Into<ImageMut<'a, T>>,
    ) -> Result<RestoreReport, ImageError> {
        let Self { estimates, restoration, levels, depth, steady, memory } = self;
        memory
            .on_scene(frame.into(), estimates.border, *depth, |mut scene, depth, memory| {
                let image = scene.as_ref();
                let is_same_scene = on_bytes(image, |bytes| steady.is_same_scene(bytes));
                memory.glimpse.next(is_same_scene);
                let z = estimates.depth_in(image, depth, memory);
                let content = estimates.water_in(image, &z, memory)?;
                let bounded = BoundedRestoration::new(image, &z, &content, restoration)?;
                let (clipping, levels) = if levels.sets_nothing() {
                    (steady.restore_mut(scene.reborrow(), &z, &content, &bounded)?, None)
                } else {
                    let (clipping, set) =
                        steady.restore_and_level_mut(scene.reborrow(), &z, &content, &bounded, levels)?;
                    (clipping, Some(set))
                };
                memory.take_back(z);
                let margins = Margins::default();
                Ok(RestoreReport { content, bounds: bounded.bounds, clipping, levels, margins })
            })
            .map(|(report, margins)| RestoreReport { margins, ..report })
    }
}

/// Enhances the frames of a sequence: sets their levels, which change smoothly ([`Steady`]).
///
/// # Examples
///
/// ```
/// use aquafuse::{image::Image, stream::EnhanceStream};
///
/// let mut stream = EnhanceStream::default();
/// for light in [100, 101, 102] {
///     let row: Vec<u8> = (0..64).flat_map(|x| [light - x, light, light + x]).collect();
///     let mut frame = Image::<u8>::from_raw(64, 1, row)?;
///     let (_, levels) = stream.enhance_mut(&mut frame)?;
///     assert!(levels.gain[0] > 1.0);
/// }
/// # Ok::<(), aquafuse::image::ImageError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct EnhanceStream<T = u8> {
    levels: LevelsOptions,
    border: Border,
    steady: Steady,
    memory: Memory<T>,
}

impl<T: Sample> EnhanceStream<T> {
    /// Sets levels with these options.
    #[must_use]
    pub fn levels(self, levels: LevelsOptions) -> Self {
        Self { levels, ..self }
    }

    /// Says what surrounds the scene.
    #[must_use]
    pub fn border(self, border: Border) -> Self {
        Self { border, ..self }
    }

    /// Averages levels over about so many frames. Default: 8. 1, or 0: each frame by itself.
    #[must_use]
    pub fn steady_over(self, frames: usize) -> Self {
        Self { steady: Steady::over(frames), ..self }
    }

    /// Enhances a frame in place; what was clipped, and the levels that were set.
    ///
    /// # Errors
    ///
    /// [`ImageError`] when the border leaves no scene; the frame is then unchanged.
    pub fn enhance_mut<'a>(
        &mut self,
        frame: impl Into<ImageMut<'a, T>>,
    ) -> Result<(Clipping, Levels), ImageError> {
        let Self { levels, border, steady, memory } = self;
        let enhance = |mut scene: ImageMut<'_, T>, _: Option<&DepthMap>, _: &mut Memory<T>| {
            on_bytes(scene.as_ref(), |bytes| steady.look(bytes));
            Ok(steady.enhance_mut(scene.reborrow(), levels))
        };
        Ok(memory.on_scene(frame.into(), *border, None, enhance)?.0)
    }
}
