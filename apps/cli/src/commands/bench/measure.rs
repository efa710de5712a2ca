//! Frames and stages, timed.

use std::hint::black_box;
use std::time::{Duration, Instant};

use aquafuse::Fuser;
use aquafuse::depth::{self, DepthMap};
use aquafuse::formation::{BoundedRestoration, RestoreOptions};
use aquafuse::fusion::{self, Bounded, Model};
use aquafuse::image::{Encoded, Image, ImageError};
use aquafuse::levels::LevelsOptions;
use aquafuse::smooth::{Smoothing, bilateral_into};
use aquafuse::stream::Stream;
use aquafuse::truth::{Scene, Size, waters};
use aquafuse::waterbody::{self, Estimate};
use clap::ValueEnum;
use serde::Serialize;

/// The model that is measured: the pipeline in OpenCV, which stands beside it, is timed with this one.
pub(super) const MODEL: Model = Model::Aquafuse;

/// How long one case is measured without --frames.
const TRIED: Duration = Duration::from_millis(500);
const FEWEST_FRAMES: usize = 5;

/// What is estimated for each frame.
#[derive(Clone, Copy, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "snake_case")]
pub(super) enum Reference {
    /// Estimate only the content.
    Cached,
    /// Estimate content and reference.
    Estimated,
    /// Estimate the water of every eighth content.
    Streamed,
}

/// Frames from one estimate of [`Reference::Streamed`] to the next.
const EVERY: usize = 8;

impl Reference {
    pub(super) const ALL: [Self; 3] = [Self::Cached, Self::Estimated, Self::Streamed];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Cached => "cached",
            Self::Estimated => "estimated",
            Self::Streamed => "streamed",
        }
    }
}

/// A median, in the units that people ask for.
#[derive(Clone, Copy, Serialize)]
pub(super) struct Speed {
    pub(super) ms_per_frame: f64,
    pub(super) fps: f64,
    pub(super) ns_per_pixel: f64,
}

/// Milliseconds of each stage by itself.
#[derive(Clone, Copy, Serialize)]
pub(super) struct Stages {
    depth: f64,
    waterbody: f64,
    fusion: f64,
    bilateral: f64,
}

/// A place seen through two waters.
pub(super) struct Images {
    content: Image<u8>,
    reference: Image<u8>,
}

/// Larger images repeat a place of this size: to make more of it would take minutes.
const LARGEST_PLACE: Size = Size { width: 1920, height: 1080 };

impl Images {
    pub(super) fn new(size: Size) -> Result<Self, ImageError> {
        let (width, height) = (size.width.min(LARGEST_PLACE.width), size.height.min(LARGEST_PLACE.height));
        let (scene, [blue, green, ..]) = (Scene::new(1, Size { width, height }), waters());
        let [content, reference] = [blue, green].map(|named| {
            let place: Image<u8> = scene.seen_through(&named.water).convert();
            let rows: Vec<_> = place.rows().collect();
            let row = |y: usize| rows[y % height].iter().cycle().take(size.width).flatten().copied();
            Image::from_raw(size.width, size.height, (0..size.height).flat_map(row).collect())
        });
        Ok(Self { content: content?, reference: reference? })
    }

    pub(super) fn size(&self) -> Size {
        let (width, height) = self.content.size();
        Size { width, height }
    }

    /// Whole frames, one after the other.
    pub(super) fn fused(
        &self,
        reference: Reference,
        smoothing: Smoothing,
        frames: Option<u32>,
    ) -> Result<Speed, ImageError> {
        let mut stream = Stream::new(Fuser::new(&self.reference)?.model(MODEL).smoothing(smoothing));
        let mut fused = self.content.clone();
        // As many at once as one estimate serves.
        let at_once = if let Reference::Streamed = reference { EVERY } else { 1 };
        stream = stream.every(at_once);
        self.speed(at_once, frames, || {
            if let Reference::Estimated = reference {
                let water = stream.estimate(&self.reference);
                stream.refer_to(water);
            }
            (0..at_once).try_for_each(|_| stream.fuse_into(&self.content, &mut fused).map(drop))
        })
    }

    /// The content without its water, its levels set.
    pub(super) fn restored(&self, frames: Option<u32>) -> Result<Speed, ImageError> {
        let (options, levels) = (RestoreOptions::default(), LevelsOptions::default());
        self.speed(1, frames, || {
            let (z, found) = estimate(&self.content)?;
            let bounded = BoundedRestoration::new(&self.content, &z, &found, &options)?;
            let mut clear = self.content.clone();
            let levels = bounded.levels(&clear, &z, &levels)?;
            bounded.restore_and_level_mut(&mut clear, &z, &levels)?;
            black_box(clear);
            Ok(())
        })
    }

    /// Each stage of a frame by itself.
    pub(super) fn stages(&self, frames: Option<u32>) -> Result<Stages, ImageError> {
        let (content, (z, own)) = (&self.content, estimate(&self.content)?);
        let bounded = Bounded::new(&own, &estimate(&self.reference)?.1, fusion::Options::for_model(MODEL));
        let mut fused = content.clone();
        Ok(Stages {
            depth: median(frames, || {
                black_box(depth::estimate(content));
                Ok(())
            })?,
            waterbody: median(frames, || {
                waterbody::estimate::<Encoded>(content, &z, &Default::default()).map(|found| {
                    black_box(found);
                })
            })?,
            fusion: median(frames, || {
                fusion::fuse_into(content, &z, bounded.waters(), &bounded.options, &mut fused).map(drop)
            })?,
            bilateral: median(frames, || bilateral_into(content, &mut fused))?,
        })
    }

    /// The speed of frames, of which each run makes so many.
    fn speed(
        &self,
        at_once: usize,
        frames: Option<u32>,
        run: impl FnMut() -> Result<(), ImageError>,
    ) -> Result<Speed, ImageError> {
        let runs = frames.map(|frames| frames.div_ceil(at_once as u32));
        let ms_per_frame = median(runs, run)? / at_once as f64;
        let pixels = self.content.pixels().len() as f64;
        Ok(Speed { ms_per_frame, fps: 1e3 / ms_per_frame, ns_per_pixel: 1e6 * ms_per_frame / pixels })
    }
}

fn estimate(image: &Image<u8>) -> Result<(DepthMap, Estimate), ImageError> {
    let z = depth::estimate(image);
    let found = waterbody::estimate(image, &z, &Default::default())?;
    Ok((z, found))
}

/// The median of so many runs after one that does not count, in milliseconds.
fn median(runs: Option<u32>, mut run: impl FnMut() -> Result<(), ImageError>) -> Result<f64, ImageError> {
    run()?;
    let (began, mut spent) = (Instant::now(), Vec::new());
    let done = |spent: &[f64]| match runs {
        Some(runs) => spent.len() >= runs as usize,
        None => spent.len() >= FEWEST_FRAMES && began.elapsed() >= TRIED,
    };
    while !done(&spent) {
        let began = Instant::now();
        run()?;
        spent.push(began.elapsed().as_secs_f64() * 1e3);
    }
    spent.sort_by(f64::total_cmp);
    Ok(spent[spent.len() / 2])
}
