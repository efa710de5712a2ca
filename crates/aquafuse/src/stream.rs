//! Frame after frame into one water: what a frame needs is kept for the next.

mod clear;
mod effect;
mod glance;
mod levels;
mod steady;

pub use clear::{EnhanceStream, RestoreReport, RestoreStream};
pub(crate) use effect::{EffectTable, WaterEffect};
pub use steady::Steady;

use crate::fuser::{Fuser, Memory, Report};
use crate::image::{ImageError, ImageMut, ImageRef, Sample};
use crate::waterbody::Estimate;

/// Fuses the frames of a sequence with one reference, as its [`Fuser`] fuses images, with a water that changes smoothly ([`Steady`]).
///
/// A first frame, and each one where nothing is averaged ([`Stream::steady_over`]), is what the fuser makes of it, to the bit (but
/// for a border that changes).
///
/// Depth is estimated of every frame, the content's water of every one or of [every so many](Stream::every). Frames
/// may differ in size. Once the memory for a frame is there, the next of that size takes nothing more that grows with
/// the image, whatever the number of threads.
///
/// A border is looked for in the first frame and in each sixty-fourth one, and kept in the frames between, so that it does not come
/// and go. Where the border is known, [`Options::border`](crate::fuser::Options::border) should say so; of frames
/// with a border the scene is copied.
///
/// # Examples
///
/// ```
/// use aquafuse::{Fuser, stream::Stream, truth};
///
/// let size = truth::Size { width: 96, height: 64 };
/// let seen = |seed, water: usize| truth::Scene::new(seed, size).seen_through(&truth::waters()[water].water);
/// let reference = seen(2, 1).convert::<u8>();
///
/// let mut stream = Stream::new(Fuser::new(&reference)?);
/// let mut fused = reference.clone();
/// for seed in 3..6 {
///     let frame = seen(seed, 0).convert::<u8>();
///     stream.fuse_into(&frame, &mut fused)?;
///     assert_ne!(fused, frame);
/// }
/// # Ok::<(), aquafuse::image::ImageError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Stream<'z, T = u8> {
    fuser: Fuser<'z>,
    every: usize,
    /// The content's water, where it is not estimated.
    given: Option<Estimate>,
    content: Option<Estimate>,
    /// Frames since the content's water was estimated.
    age: usize,
    memory: Memory<T>,
}

impl<'z> Stream<'z> {
    /// A stream of frames of bytes that are fused by `fuser`.
    pub fn new(fuser: Fuser<'z>) -> Self {
        Self::of_samples(fuser)
    }
}

impl<'z, T: Sample> Stream<'z, T> {
    /// A stream of frames of samples of any type: of 16 bits, say, for video of 10 bits.
    pub fn of_samples(fuser: Fuser<'z>) -> Self {
        Self { fuser, every: 1, given: None, content: None, age: 0, memory: Memory::default() }
            .steady_over(Steady::FRAMES)
    }

    /// Averages the water over about so many frames, in a mean that forgets. Default: 8. 1, or 0: each frame by itself.
    #[must_use]
    pub fn steady_over(mut self, frames: usize) -> Self {
        self.memory.steady = (frames > 1).then(|| Steady::over(frames));
        match self.given {
            Some(content) => self.content_water(content),
            None => self,
        }
    }

    /// Estimates the content's water of the first frame and of each so many frames; 0 counts as 1. Without this, of
    /// every frame by itself. What lies at each depth is of the frame estimated too, where F is a table.
    #[must_use]
    pub fn every(mut self, frames: usize) -> Self {
        self.every = frames;
        self
    }

    /// Takes `content` for the water of every frame, instead of estimates: the water of the whole sequence, by
    /// [`waterbody::pool`](crate::waterbody::pool), or a known one. The exposure is then not followed.
    #[must_use]
    pub fn content_water(mut self, content: Estimate) -> Self {
        self.given = Some(content);
        if let Some(steady) = &mut self.memory.steady {
            steady.ignore_exposure();
        }
        self
    }

    /// Takes another water for the frames to come.
    pub fn refer_to(&mut self, reference: Estimate) {
        self.fuser.refer_to(reference);
        // A bound on the gain depends on the reference.
        if let Some(steady) = &mut self.memory.steady {
            steady.reset();
        }
    }

    /// The content's water that the last frame was fused by; none before the first.
    pub fn content(&self) -> Option<&Estimate> {
        self.content.as_ref()
    }

    /// The water of an image in the memory of this stream, estimated as the contents' is, from colour alone: a new
    /// reference, say.
    pub fn estimate<'a>(&mut self, image: impl Into<ImageRef<'a, T>>) -> Estimate {
        let found = self.fuser.options().estimate_in(image.into(), None, &mut self.memory);
        found.expect("the depth map was made for this image")
    }

    /// Fuses a frame into `fused`, which keeps nothing of what it was.
    ///
    /// # Errors
    ///
    /// [`ImageError`] when the two, or the fuser's depth map, differ in size; `fused` is then unchanged.
    pub fn fuse_into<'a, 'b>(
        &mut self,
        frame: impl Into<ImageRef<'a, T>>,
        fused: impl Into<ImageMut<'b, T>>,
    ) -> Result<Report, ImageError> {
        self.fuse_from(Some(frame.into()), fused.into())
    }

    /// [`Stream::fuse_into`] in place.
    ///
    /// # Errors
    ///
    /// [`ImageError`] when the fuser's depth map, if it has one, is of another size; the frame is then unchanged.
    pub fn fuse_mut<'a>(&mut self, frame: impl Into<ImageMut<'a, T>>) -> Result<Report, ImageError> {
        self.fuse_from(None, frame.into())
    }

    fn fuse_from(
        &mut self,
        frame: Option<ImageRef<'_, T>>,
        fused: ImageMut<'_, T>,
    ) -> Result<Report, ImageError> {
        let known = self.given.or(self.content.filter(|_| self.age < self.every));
        let report = self.fuser.fuse_in(frame, fused, known, &mut self.memory)?;
        self.age = if known.is_some() { self.age + 1 } else { 1 };
        self.content = Some(report.content);
        Ok(report)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::depth::DepthModel;
    use crate::fuser::Options;
    use crate::fusion::{self, Bounded, Clipping, Model};
    use crate::image::Image;
    use crate::smooth::Smoothing;
    use crate::truth::{Scene, Size, waters};
    use crate::waterbody::{self, EstimateOptions};

    fn image(seed: u64, water: usize, width: usize, height: usize) -> Image<u8> {
        Scene::new(seed, Size { width, height }).seen_through(&waters()[water].water).convert()
    }

    fn one_by_one(frame: &Image<u8>, reference: &Estimate, options: &Options) -> (Image<u8>, Clipping) {
        let z = options.depth_model.estimate(frame);
        let (own, share) = waterbody::estimate_with_share(frame, &z, &options.estimate).unwrap();
        let bounded = Bounded::new(&own, reference, options.fusion);
        let fused = fusion::fuse(frame, &z, bounded.waters().with_share(&share), &bounded.options).unwrap();
        (options.smoothing.apply(fused.image), fused.clipping)
    }

    #[test]
    fn a_border_is_kept_from_frame_to_frame() {
        let bare = image(3, 0, 96, 80);
        let mut barred = bare.clone();
        barred.view_mut().rows_mut().take(12).for_each(|row| row.fill([16; 3]));
        let mut stream = Stream::new(Fuser::new(&image(2, 1, 96, 80)).unwrap());
        let mut fused = bare.clone();
        let first = stream.fuse_into(&barred, &mut fused).unwrap().margins;
        assert_eq!(first.top, 12);
        // A frame that seems to have none, or to be one, between others.
        assert_eq!(stream.fuse_into(&bare, &mut fused).unwrap().margins, first);
        let all = (0..64).map(|_| stream.fuse_into(&bare, &mut fused).unwrap().margins.top);
        assert_eq!(all.last(), Some(0));
    }

    #[test]
    fn a_stream_is_its_fuser_and_that_its_steps_one_by_one_at_any_size() {
        for &model in Model::ALL {
            for (i, depth_model) in DepthModel::ALL.iter().copied().enumerate() {
                let (fusion, smoothing) = (fusion::Options::for_model(model), Smoothing::ALL[i % 2]);
                let options = Options { depth_model, fusion, smoothing, ..Options::default() };
                let fuser = Fuser::with_options(&image(2, 1, 96, 64), options).unwrap();
                let mut stream = Stream::new(fuser.clone());
                assert_eq!(stream.estimate(&image(2, 1, 96, 64)), *fuser.reference());
                for (seed, (width, height)) in
                    [(33, 65), (1, 1), (1, 40), (40, 1), (7, 7), (96, 64)].into_iter().enumerate()
                {
                    let frame = image(seed as u64, seed % 3, width, height);
                    let expected = one_by_one(&frame, fuser.reference(), &options);
                    let (mut fused, mut in_place) = (image(9, 2, width, height), frame.clone());
                    let report = stream.fuse_into(&frame, &mut fused).unwrap();
                    assert_eq!((&fused, report.clipping), (&expected.0, expected.1));
                    assert_eq!(stream.fuse_mut(&mut in_place), Ok(report));
                    assert_eq!(in_place, fused);
                    // The front door gives the same.
                    let outcome = fuser.fuse(&frame).unwrap();
                    assert_eq!((outcome.image, outcome.report), (fused, report));
                }
            }
        }
    }

    fn image_estimate() -> Estimate {
        let image = image(1, 1, 48, 32);
        waterbody::estimate(&image, &crate::depth::estimate(&image), &EstimateOptions::default()).unwrap()
    }

    #[test]
    fn the_contents_water_is_that_of_every_third_frame() {
        let mut stream = Stream::new(image_estimate().into()).every(3);
        let frames: Vec<_> = (0..5).map(|seed| image(seed, 0, 64, 48)).collect();
        let found: Vec<_> = frames
            .iter()
            .map(|frame| {
                stream.fuse_mut(&mut frame.clone()).unwrap();
                *stream.content().unwrap()
            })
            .collect();
        assert_eq!((found[1], found[2], found[4]), (found[0], found[0], found[3]));
        assert_eq!(found[3], stream.estimate(&frames[3]));
        assert_ne!(found[3], found[0]);
    }

    #[test]
    fn sizes_that_differ_are_an_error() {
        let mut stream = Stream::new(image_estimate().into());
        let error = stream.fuse_into(&image(1, 0, 8, 8), &mut image(1, 0, 8, 9)).unwrap_err();
        assert_eq!(error, ImageError::Mismatch { left: (8, 8), right: (8, 9) });
    }

    #[cfg(feature = "threads")]
    #[test]
    fn threads_change_no_bit() {
        // Tiles of a scene, so many that threads are woken and the image is thinned out.
        let (tile, width, height) = (image(4, 0, 301, 203), 1801, 1203);
        let row = |y: usize| tile.row(y % 203).iter().cycle().take(width).flatten().copied();
        let frame = Image::from_raw(width, height, (0..height).flat_map(row).collect()).unwrap();
        let fused_on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let mut stream = Stream::new(image_estimate().into());
                let mut fused = frame.clone();
                let report = stream.fuse_into(&frame, &mut fused).unwrap();
                (fused, report, stream.content)
            })
        };
        assert_eq!(fused_on(1), fused_on(3));
    }
}
