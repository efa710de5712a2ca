//! What happens to each frame.

use aquafuse::image::{Encoded, ImageMut, ImageRef, Sample};
use aquafuse::metrics::Flicker;
use aquafuse::scene_area::Border;
use aquafuse::smooth::Smoothing;
use aquafuse::stream::Steady;
use aquafuse::waterbody::{Estimate, Quality, Reason, Verdict, WaterMap};

use super::frames::{FrameReport, Frames};
use super::{Codec, Frame, Shape, VideoError};
use crate::pipeline::{DepthEstimator, Operation};

/// What is done with a video.
#[derive(Clone, Debug)]
pub struct Recipe {
    /// What is done to each frame, in encoded values: fusion, restoration or enhancement without a reference.
    pub operation: Operation,
    /// How depth is estimated: from colour, or by a network, frame by frame.
    pub depth_model: DepthEstimator,
    /// How fused frames are smoothed. Default: not at all.
    pub smoothing: Smoothing,
    /// What surrounds the scene. Default: it is found.
    pub border: Border,
    /// What says where open water is. Default: rules.
    pub water_map: WaterMap,
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

impl ContentWater {
    /// Refuses a water that cannot be estimated with depth from this: a program can ask before it reads anything.
    ///
    /// # Errors
    ///
    /// [`VideoError::Request`] for [`ContentWater::Pooled`] with a network.
    pub fn check(&self, depth: &DepthEstimator) -> Result<(), VideoError> {
        match self {
            Self::Pooled if depth.network().is_some() => Err(VideoError::Request(
                "--one-water pools waters at depth from colour, not at a network's; leave it out, or give the water \
                 with --content-water"
                    .into(),
            )),
            _ => Ok(()),
        }
    }
}

impl Recipe {
    /// An operation, with the defaults for everything else.
    #[must_use]
    pub fn new(operation: Operation) -> Self {
        Self {
            operation,
            depth_model: DepthEstimator::default(),
            smoothing: Smoothing::default(),
            border: Border::default(),
            water_map: WaterMap::default(),
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

    fn changer<T: Sample>(&self, shape: Shape) -> Result<Changer<T>, VideoError> {
        let flicker = self.flicker.then(Flicker::default);
        let frames = self.frames()?;
        Ok(Changer { frames, shape, flicker, before: Vec::new(), samples: Vec::new(), seen: Seen::default() })
    }
}

/// What was seen of the frames.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Seen {
    /// Frames by the verdict on their water: good, doubtful, failed.
    pub(super) verdicts: [u64; 3],
    /// Frames by each of [`Reason::ALL`].
    pub(super) reasons: [u64; Reason::ALL.len()],
    /// The sum of the shares of values that were clipped.
    pub(super) clipped: f64,
}

/// Changes one frame after another.
pub(super) trait Change: Send {
    fn change(&mut self, frame: &mut Frame) -> Result<(), VideoError>;
    fn seen(&self) -> Seen;
    fn flicker(&self) -> Option<Flicker>;
}

struct Changer<T> {
    frames: Frames<T>,
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
        let Self { frames, shape, flicker, before, samples, seen } = self;
        let (width, height) = (shape.width, shape.height);
        T::on_frame(&mut frame.bytes, samples, |samples| {
            if flicker.is_some() {
                before.clear();
                before.extend_from_slice(samples);
            }
            let mut image = ImageMut::new(width, height, samples)?;
            let FrameReport { clipping, quality } = frames.change(image.reborrow())?;
            seen.add(clipping.share(), quality);
            if let Some(flicker) = flicker {
                flicker.add(ImageRef::new(width, height, before)?, image)?;
            }
            Ok(())
        })
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
        let Some(quality) = quality else { return };
        let [good, doubtful, failed] = &mut self.verdicts;
        let count = match quality.verdict {
            Verdict::Good => good,
            Verdict::Doubtful => doubtful,
            Verdict::Failed => failed,
        };
        *count = count.saturating_add(1);
        for (count, reason) in self.reasons.iter_mut().zip(Reason::ALL) {
            *count = count.saturating_add(u64::from(quality.reasons.contains(*reason)));
        }
    }
}
