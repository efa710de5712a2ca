//! What a person wants to know of a network of depth while it runs: that it is slow, and that it did not have to.

use std::sync::Once;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use aquafuse_data::depth_network::{CACHE, CacheCounts, DepthNetwork};

/// An image for which a network takes longer is worth a word.
const LONG: Duration = Duration::from_secs(20);

/// Says once that a network is slow.
pub(crate) struct Slow(Once);

impl Slow {
    pub(crate) fn new() -> Self {
        Self(Once::new())
    }

    /// What to say after an image.
    pub(crate) fn said(&self, network: Option<&DepthNetwork>) -> Option<String> {
        let slowest = network?.slowest();
        let mut said = None;
        if slowest > LONG {
            self.0.call_once(|| {
                said = Some(format!(
                    "the network took {} s for the depth of one image; a smaller --depth-model-size is quicker, if it takes any size",
                    slowest.as_secs()
                ));
            });
        }
        said
    }
}

/// Says once, after the first frame of a video, how long a network will take.
pub(crate) struct Long {
    frames: AtomicU64,
    said: Once,
}

impl Long {
    pub(crate) fn new() -> Self {
        Self { frames: AtomicU64::new(0), said: Once::new() }
    }

    /// How many frames there are, about, if that is known.
    pub(crate) fn begins(&self, frames: Option<u64>) {
        self.frames.store(frames.unwrap_or(0), Ordering::Relaxed);
    }

    /// What to say after a frame.
    pub(crate) fn said(&self, network: Option<&DepthNetwork>) -> Option<String> {
        let one = network?.slowest().as_secs_f64();
        let mut said = None;
        self.said.call_once(|| {
            #[allow(clippy::cast_precision_loss, reason = "minutes need no more")]
            let all = match self.frames.load(Ordering::Relaxed) {
                0 => String::new(),
                frames => format!(", about {:.0} min for {frames} frames", one * frames as f64 / 60.0),
            };
            said = Some(format!("the network took {one:.1} s for the depth of the first frame{all}"));
        });
        said
    }
}

/// What to say of the maps that are kept, after a run.
pub(crate) fn kept(network: Option<&DepthNetwork>) -> Option<String> {
    let CacheCounts { found, kept, damaged, not_kept, .. } = network?.cached()?;
    let mut parts = Vec::new();
    if found > 0 {
        parts.push(format!("{found} kept from before"));
    }
    if kept > 0 {
        parts.push(format!("{kept} computed and kept in {CACHE}, which may be deleted"));
    }
    if damaged > 0 {
        parts.push(format!("{damaged} damaged there and computed again"));
    }
    if not_kept > 0 {
        parts
            .push(format!("{not_kept} computed and not kept, for 2 GiB are or the folder cannot be written"));
    }
    (!parts.is_empty()).then(|| format!("maps of the network: {}", parts.join(", ")))
}
