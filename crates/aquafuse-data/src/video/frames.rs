//! Frames changed one after another, with water and levels that change smoothly.

use aquafuse::Fuser;
use aquafuse::depth::DepthModel;
use aquafuse::fuser::Options;
use aquafuse::fusion::Clipping;
use aquafuse::image::{Encoded, ImageMut, Sample};
use aquafuse::stream::{EnhanceStream, RestoreStream, Stream};
use aquafuse::waterbody::{EstimateOptions, Quality};

use super::at_depth::AtDepth;
use super::change::{ContentWater, Recipe};
use super::error::VideoError;
use crate::depth_network::DepthNetwork;
use crate::pipeline::{DepthEstimator, DepthSource, Operation, PixelEncoding, Space, analyse_in};

/// The frames of one sequence, in their order: what [`Recipe::frames`] makes of each depends on those before it.
///
/// # Examples
///
/// ```
/// use aquafuse::image::Image;
/// use aquafuse::truth::{Scene, Size, waters};
/// use aquafuse_data::pipeline::Operation;
/// use aquafuse_data::video::Recipe;
///
/// let recipe = Recipe::new(Operation::Enhance { levels: Default::default() });
/// let mut frames = recipe.frames::<u8>()?;
/// for seed in 0..3 {
///     let scene = Scene::new(seed, Size { width: 64, height: 48 });
///     let mut frame: Image<u8> = scene.seen_through(&waters()[0].water).convert();
///     frames.change(frame.view_mut())?;
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Frames<T>(Streams<T>);

/// What was done to a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct FrameReport {
    /// Values that were clipped.
    pub clipping: Clipping,
    /// What the estimate of the frame's own water is worth; none where no water is estimated.
    pub quality: Option<Quality>,
}

#[derive(Clone, Debug)]
enum Streams<T> {
    Fuse(Box<Stream<'static, T>>),
    Restore(Box<RestoreStream<'static, T>>),
    Enhance(Box<EnhanceStream<T>>),
    ByNetwork(Box<AtDepth>, DepthSource),
}

impl Recipe {
    /// Frames of a sequence that begins. [`ContentWater::Pooled`] needs frames that are not there yet; the water is then estimated.
    ///
    /// # Errors
    ///
    /// [`VideoError::Request`] for an operation in linear light, and for [`Operation::Clarify`].
    pub fn frames<T: Sample>(&self) -> Result<Frames<T>, VideoError> {
        let refused = || {
            VideoError::Request("a video is fused, restored or enhanced by levels, in encoded values".into())
        };
        let encoding = match &self.operation {
            Operation::Fuse { reference, .. } => reference.encoding(),
            Operation::Restore { encoding, .. } => *encoding,
            Operation::Enhance { .. } => PixelEncoding::Encoded,
            Operation::Clarify { .. } => return Err(refused()),
        };
        if encoding == PixelEncoding::Linear {
            return Err(refused());
        }
        Ok(Frames(match &self.operation {
            Operation::Fuse { .. } | Operation::Restore { .. } if self.network().is_some() => {
                let source = DepthSource::Estimated(self.depth_model.clone());
                Streams::ByNetwork(Box::new(AtDepth::new(self)), source)
            }
            Operation::Fuse { .. } => {
                let stream = self.fusion().ok_or_else(refused)?;
                Streams::Fuse(Box::new(match self.content_water {
                    ContentWater::Given(water) => stream.content_water(water),
                    _ => stream,
                }))
            }
            Operation::Restore { options, levels, .. } => Streams::Restore(Box::new(
                RestoreStream::default()
                    .restoration(*options)
                    .levels(*levels)
                    .depth_model(self.colour())
                    .estimate(EstimateOptions::default().with_water_map(self.water_map))
                    .border(self.border)
                    .steady_over(self.steady_over),
            )),
            Operation::Enhance { levels } => Streams::Enhance(Box::new(
                EnhanceStream::default().levels(*levels).border(self.border).steady_over(self.steady_over),
            )),
            Operation::Clarify { .. } => return Err(refused()),
        }))
    }

    /// The network that depth is estimated by, if it is one; none for an operation that needs no depth.
    pub fn network(&self) -> Option<&DepthNetwork> {
        self.depth_model.network().filter(|_| self.operation.needs_analysis())
    }

    /// Bytes that its network takes beside a frame of so many pixels.
    pub(crate) fn network_memory(&self, pixels: u64) -> u64 {
        self.network().map_or(0, |_| self.depth_model.memory(pixels))
    }

    /// The model of colours, which a stream of the core estimates depth by.
    fn colour(&self) -> DepthModel {
        match self.depth_model {
            DepthEstimator::Colour(model) => model,
            DepthEstimator::Network(_) => DepthModel::default(),
        }
    }

    /// A stream that fuses, if that is what is asked for.
    pub(super) fn fusion<T: Sample>(&self) -> Option<Stream<'static, T>> {
        let Operation::Fuse { reference, options } = &self.operation else { return None };
        let options = Options::default()
            .with_depth_model(self.colour())
            .with_estimate(EstimateOptions::default().with_water_map(self.water_map))
            .with_fusion(*options)
            .with_smoothing(self.smoothing)
            .with_border(self.border);
        let fuser = Fuser::from_estimate(Encoded::estimate(reference)?, options);
        Some(Stream::of_samples(fuser).steady_over(self.steady_over))
    }
}

impl<T: Sample> Frames<T> {
    /// Bytes that a network takes beside a frame of so many pixels.
    #[cfg(feature = "bag")]
    pub(crate) fn network_memory(&self, pixels: u64) -> u64 {
        match &self.0 {
            Streams::ByNetwork(_, source) => source.memory(pixels),
            Streams::Fuse(_) | Streams::Restore(_) | Streams::Enhance(_) => 0,
        }
    }

    /// Changes the next frame in place. Frames may differ in size.
    ///
    /// # Errors
    ///
    /// [`VideoError`] when the frame is no image, or a network gives no depth for it; it is then unchanged.
    pub fn change(&mut self, frame: ImageMut<'_, T>) -> Result<FrameReport, VideoError> {
        let (clipping, quality) = match &mut self.0 {
            Streams::Fuse(stream) => {
                let report = stream.fuse_mut(frame)?;
                (report.clipping, Some(report.content.quality))
            }
            Streams::Restore(stream) => {
                let report = stream.restore_mut(frame)?;
                (report.clipping, Some(report.content.quality))
            }
            Streams::Enhance(stream) => (stream.enhance_mut(frame)?.0, None),
            Streams::ByNetwork(at_depth, source) => {
                let analyse = |scene: &_| Ok(analyse_in(PixelEncoding::Encoded, scene, source)?);
                return at_depth.change(frame, analyse);
            }
        };
        Ok(FrameReport { clipping, quality })
    }
}
