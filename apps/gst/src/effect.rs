//! What is done to frames: a stream of the core, and what it said of the last frame.

use aquafuse::image::{ImageError, ImageMut};
use aquafuse::stream::{EnhanceStream, RestoreStream, Stream};
use aquafuse::waterbody::{Estimate, Verdict, pool};

/// Frames whose waters are pooled, where one water is wanted for all: as for videos.
pub const POOLED: usize = 24;

/// Changes one frame after another.
#[derive(Debug)]
pub enum Effect {
    /// Exchanges their water.
    Fuse(Box<Fusion>),
    /// Removes their water.
    Restore(Box<RestoreStream<'static>>),
    /// Sets their levels.
    Enhance(Box<EnhanceStream>),
    /// Leaves them alone.
    None,
}

/// A fusion, and the waters of its first frames where they are to be pooled.
#[derive(Debug)]
pub struct Fusion {
    stream: Stream<'static>,
    pooled: Option<Vec<Estimate>>,
}

/// What was seen of a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Seen {
    /// What the estimate of the frame's own water is worth; none where no water is estimated.
    pub verdict: Option<Verdict>,
    /// The share of values that were clipped.
    pub clipped: f64,
}

impl Fusion {
    /// By this stream; with `one_water`, the waters of the first [`POOLED`] frames are pooled and then kept.
    #[must_use]
    pub fn new(stream: Stream<'static>, one_water: bool) -> Self {
        Self { stream, pooled: one_water.then(Vec::new) }
    }

    fn change(&mut self, frame: ImageMut<'_, u8>) -> Result<Seen, ImageError> {
        let report = self.stream.fuse_mut(frame)?;
        if let Some(found) = &mut self.pooled {
            found.push(report.content);
            if found.len() == POOLED {
                if let Some(water) = pool(found) {
                    self.stream = self.stream.clone().content_water(water);
                }
                self.pooled = None;
            }
        }
        Ok(Seen { verdict: Some(report.content.quality.verdict), clipped: report.clipping.share() })
    }
}

impl Effect {
    /// Whether frames stay as they are.
    #[must_use]
    pub fn is_none(&self) -> bool {
        matches!(self, Self::None)
    }

    /// Changes the next frame in place.
    ///
    /// # Errors
    ///
    /// [`ImageError`] when the frame is no image; it is then unchanged.
    pub fn change(&mut self, frame: ImageMut<'_, u8>) -> Result<Seen, ImageError> {
        match self {
            Self::Fuse(fusion) => fusion.change(frame),
            Self::Restore(stream) => {
                let report = stream.restore_mut(frame)?;
                let verdict = Some(report.content.quality.verdict);
                Ok(Seen { verdict, clipped: report.clipping.share() })
            }
            Self::Enhance(stream) => {
                let (clipping, _) = stream.enhance_mut(frame)?;
                Ok(Seen { verdict: None, clipped: clipping.share() })
            }
            Self::None => Ok(Seen::default()),
        }
    }
}
