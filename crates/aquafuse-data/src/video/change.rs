//! What happens to each frame.

use aquafuse::Fuser;
use aquafuse::depth::DepthModel;
use aquafuse::fuser::Options;
use aquafuse::image::{Encoded, ImageError, ImageMut, ImageRef, Sample};
use aquafuse::metrics::Flicker;
use aquafuse::scene_area::Border;
use aquafuse::smooth::Smoothing;
use aquafuse::stream::{EnhanceStream, RestoreStream, Steady, Stream};
use aquafuse::waterbody::{Estimate, Quality, Verdict};

use super::{Codec, Frame, Shape, VideoError};
use crate::pipeline::{Operation, Space};

/// What is done with a video.
#[derive(Clone, Debug)]
pub struct Recipe {
    /// What is done to each frame, in encoded values: fusion, restoration or enhancement without a reference.
    pub operation: Operation,
    /// How depth is estimated.
    pub depth_model: DepthModel,
    /// How fused frames are smoothed. Default: not at all.
    pub smoothing: Smoothing,
    /// What surrounds the scene. Default: it is found.
    pub border: Border,
    /// Water and levels are means over about so many frames ([`Steady`]). Default: 8. 1: each frame is by itself.
    pub steady_over: usize,
    /// The water of the frames. Default: estimated.
    pub content_water: ContentWater,
    /// Whether to measure how much the output flickers. Default: no.
    pub flicker: bool,
    /// How frames are compressed. Default: by the kind of file.
    pub codec: Option<Codec>,
    /// The constant rate factor: lower is better and larger. Default: [`Codec::default_crf`].
    pub crf: Option<u8>,
}

/// The water that the frames of a video were taken in. All but the first are for fusion alone.
#[derive(Clone, Debug, Default)]
#[allow(clippy::large_enum_variant, reason = "there is one a run")]
pub enum ContentWater {
    /// Estimated of each frame, and followed.
    #[default]
    Estimated,
    /// One for all frames: the estimates of some of them, pooled.
    Pooled,
    /// Known.
    Given(Estimate<Encoded>),
}

impl Recipe {
    /// An operation, with the defaults for everything else.
    #[must_use]
    pub fn new(operation: Operation) -> Self {
        Self {
            operation,
            depth_model: DepthModel::default(),
            smoothing: Smoothing::default(),
            border: Border::default(),
            steady_over: Steady::FRAMES,
            content_water: ContentWater::default(),
            flicker: false,
            codec: None,
            crf: None,
        }
    }

    /// Changes frames of bytes or of words.
    pub(super) fn change(&self, shape: Shape) -> Result<Box<dyn Change>, VideoError> {
        Ok(match shape.is_deep {
            false => Box::new(self.changer::<u8>(shape)?),
            true => Box::new(self.changer::<u16>(shape)?),
        })
    }

    /// A stream that fuses, if that is what is asked for.
    pub(super) fn fusion<T: Sample>(&self) -> Option<Stream<'static, T>> {
        let Operation::Fuse { reference, options } = &self.operation else { return None };
        let options = Options::default()
            .with_depth_model(self.depth_model)
            .with_fusion(*options)
            .with_smoothing(self.smoothing)
            .with_border(self.border);
        let fuser = Fuser::from_estimate(Encoded::estimate(reference)?, options);
        Some(Stream::of_samples(fuser).steady_over(self.steady_over))
    }

    fn changer<T: Sample>(&self, shape: Shape) -> Result<Changer<T>, VideoError> {
        let refused = || {
            VideoError::Request("a video is fused, restored or enhanced by levels, in encoded values".into())
        };
        let streams = match &self.operation {
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
                    .depth_model(self.depth_model)
                    .border(self.border)
                    .steady_over(self.steady_over),
            )),
            Operation::Enhance { levels } => Streams::Enhance(Box::new(
                EnhanceStream::default().levels(*levels).border(self.border).steady_over(self.steady_over),
            )),
            Operation::Clarify { .. } => return Err(refused()),
        };
        let flicker = self.flicker.then(Flicker::default);
        Ok(Changer {
            streams,
            shape,
            flicker,
            before: Vec::new(),
            samples: Vec::new(),
            seen: Seen::default(),
        })
    }
}

/// What was seen of the frames.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Seen {
    /// Frames by the verdict on their water: good, doubtful, failed.
    pub(super) verdicts: [u64; 3],
    /// The sum of the shares of values that were clipped.
    pub(super) clipped: f64,
}

/// Changes one frame after another.
pub(super) trait Change: Send {
    fn change(&mut self, frame: &mut Frame) -> Result<(), VideoError>;
    fn seen(&self) -> Seen;
    fn flicker(&self) -> Option<Flicker>;
}

enum Streams<T> {
    Fuse(Box<Stream<'static, T>>),
    Restore(Box<RestoreStream<'static, T>>),
    Enhance(Box<EnhanceStream<T>>),
}

struct Changer<T> {
    streams: Streams<T>,
    shape: Shape,
    flicker: Option<Flicker>,
    /// The frame as it was, where flicker is measured.
    before: Vec<T>,
    samples: Vec<T>,
    seen: Seen,
}

/// Samples as bytes, the lower one first.
pub(super) trait Bytes: Sample {
    /// Changes a frame of such samples, by way of `room` where its bytes are none.
    fn on_frame<R>(bytes: &mut [u8], room: &mut Vec<Self>, change: impl FnOnce(&mut [Self]) -> R) -> R;
}

impl Bytes for u8 {
    fn on_frame<R>(bytes: &mut [u8], _: &mut Vec<Self>, change: impl FnOnce(&mut [Self]) -> R) -> R {
        change(bytes)
    }
}

impl Bytes for u16 {
    fn on_frame<R>(bytes: &mut [u8], room: &mut Vec<Self>, change: impl FnOnce(&mut [Self]) -> R) -> R {
        room.clear();
        room.extend(bytes.as_chunks::<2>().0.iter().map(|pair| Self::from_le_bytes(*pair)));
        let result = change(room);
        let pairs = bytes.as_chunks_mut::<2>().0;
        pairs.iter_mut().zip(room).for_each(|(pair, word)| *pair = word.to_le_bytes());
        result
    }
}

impl<T: Bytes> Change for Changer<T> {
    fn change(&mut self, frame: &mut Frame) -> Result<(), VideoError> {
        let Self { streams, shape, flicker, before, samples, seen } = self;
        let (width, height) = (shape.width, shape.height);
        let changed = T::on_frame(&mut frame.bytes, samples, |samples| {
            if flicker.is_some() {
                before.clear();
                before.extend_from_slice(samples);
            }
            let mut image = ImageMut::new(width, height, samples)?;
            let (clipping, quality) = match streams {
                Streams::Fuse(stream) => {
                    let report = stream.fuse_mut(image.reborrow())?;
                    (report.clipping, Some(report.content.quality))
                }
                Streams::Restore(stream) => {
                    let report = stream.restore_mut(image.reborrow())?;
                    (report.clipping, Some(report.content.quality))
                }
                Streams::Enhance(stream) => (stream.enhance_mut(image.reborrow())?.0, None),
            };
            seen.add(clipping.share(), quality);
            if let Some(flicker) = flicker {
                flicker.add(ImageRef::new(width, height, before)?, image)?;
            }
            Ok(())
        });
        changed.map_err(|error: ImageError| VideoError::Request(error.to_string()))
    }

    fn seen(&self) -> Seen {
        self.seen
    }

    fn flicker(&self) -> Option<Flicker> {
        self.flicker
    }
}

impl Seen {
    fn add(&mut self, clipped: f64, quality: Option<Quality>) {
        self.clipped += clipped;
        let [good, doubtful, failed] = &mut self.verdicts;
        let count = match quality.map(|quality| quality.verdict) {
            Some(Verdict::Good) => good,
            Some(Verdict::Doubtful) => doubtful,
            Some(Verdict::Failed) => failed,
            None => return,
        };
        *count = count.saturating_add(1);
    }
}
