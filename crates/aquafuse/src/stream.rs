//! Frame after frame into one water: what a frame needs is kept for the next.

use crate::depth::{DepthMap, DepthModel};
use crate::fusion::{self, Bounded, Clipping};
use crate::image::{Image, ImageMut, ImageRef, SizeError};
use crate::smooth::{self, Smoothing};
use crate::waterbody::{self, Estimate, EstimateOptions, Scratch};

/// Fuses the frames of a sequence with one reference.
///
/// Depth is estimated of every frame, the content's water of every [`Options::every`]-th. Frames may differ in size.
/// Once the memory for a frame is there, the next of that size takes nothing more that grows with the image. The
/// result is that of [`depth`](crate::depth), [`waterbody`] and [`fusion`] called
/// one by one, to the bit, whatever the number of threads.
///
/// # Examples
///
/// ```
/// use aquafuse::{depth, stream::{Options, Stream}, truth, waterbody};
///
/// let size = truth::Size { width: 96, height: 64 };
/// let seen = |seed, water: usize| truth::Scene::new(seed, size).seen_through(&truth::waters()[water].water);
/// let reference = seen(2, 1).to_samples::<u8>();
/// let water = waterbody::estimate(&reference, &depth::estimate(&reference), &Default::default())?;
///
/// let mut stream = Stream::new(water, Options::default());
/// let mut fused = reference.clone();
/// for seed in 3..6 {
///     let frame = seen(seed, 0).to_samples::<u8>();
///     stream.fuse_into(&frame, &mut fused)?;
///     assert_ne!(fused, frame);
/// }
/// # Ok::<(), aquafuse::image::SizeError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Stream {
    reference: Estimate,
    options: Options,
    content: Option<Estimate>,
    /// Frames since the content's water was estimated.
    age: usize,
    levels: Vec<u8>,
    scratch: Scratch,
    /// What an image consists of before it is smoothed.
    samples: Vec<u8>,
}

/// How the frames of a [`Stream`] are fused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// The way from colour to depth.
    pub depth: DepthModel,
    /// How waters are estimated.
    pub estimate: EstimateOptions,
    /// How they are fused.
    pub fusion: fusion::Options,
    /// How the fused frames are smoothed.
    pub smoothing: Smoothing,
    /// The content's water is estimated of the first frame and of each so many frames; 0 counts as 1. Default: 1,
    /// every frame by itself. What lies at each depth is of the frame estimated too, where F is a table.
    pub every: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            depth: DepthModel::default(),
            estimate: EstimateOptions::default(),
            fusion: fusion::Options::default(),
            smoothing: Smoothing::None,
            every: 1,
        }
    }
}

impl Stream {
    /// A stream into the water of `reference`.
    pub fn new(reference: Estimate, options: Options) -> Self {
        let (levels, scratch, samples) = (Vec::new(), Scratch::default(), Vec::new());
        Self { reference, options, content: None, age: 0, levels, scratch, samples }
    }

    /// Takes another water for the frames to come.
    pub fn refer_to(&mut self, reference: Estimate) {
        self.reference = reference;
    }

    /// The content's water that the last frame was fused by; none before the first.
    pub fn content(&self) -> Option<&Estimate> {
        self.content.as_ref()
    }

    /// The water of an image in the memory of this stream, estimated as the contents' is: a new reference, say.
    pub fn estimate<'a>(&mut self, image: impl Into<ImageRef<'a, u8>>) -> Estimate {
        let image = image.into();
        let depth = self.depth_of(image);
        let found = self.water_of(image, &depth);
        self.levels = depth.into_levels();
        found
    }

    /// Fuses a frame into `fused`, which keeps nothing of what it was.
    ///
    /// # Errors
    ///
    /// [`SizeError`] when the two differ in size.
    pub fn fuse_into<'a, 'b>(
        &mut self,
        frame: impl Into<ImageRef<'a, u8>>,
        fused: impl Into<ImageMut<'b, u8>>,
    ) -> Result<Clipping, SizeError> {
        let (frame, fused) = (frame.into(), fused.into());
        crate::image::check_same_size(frame.size(), fused.size())?;
        if self.options.smoothing == Smoothing::Bilateral {
            let (rough, clipping) = self.rough(frame);
            self.smooth(rough, fused);
            return Ok(clipping);
        }
        let (depth, bounded) = self.look_at(frame);
        let clipping = fusion::fuse_into(frame, &depth, bounded.waters(), &bounded.options, fused)?;
        self.levels = depth.into_levels();
        Ok(clipping)
    }

    /// [`Stream::fuse_into`] in place.
    pub fn fuse_mut<'a>(&mut self, frame: impl Into<ImageMut<'a, u8>>) -> Clipping {
        let frame = frame.into();
        if self.options.smoothing == Smoothing::Bilateral {
            let (rough, clipping) = self.rough(frame.as_ref());
            self.smooth(rough, frame);
            return clipping;
        }
        let (depth, bounded) = self.look_at(frame.as_ref());
        let clipping = fusion::fuse_mut(frame, &depth, bounded.waters(), &bounded.options);
        self.levels = depth.into_levels();
        clipping.expect("the depth map was made for this frame")
    }

    /// A frame fused and not smoothed yet, in the memory of the last one.
    fn rough(&mut self, frame: ImageRef<'_, u8>) -> (Image<u8>, Clipping) {
        let (depth, bounded) = self.look_at(frame);
        let mut samples = std::mem::take(&mut self.samples);
        samples.resize(3 * frame.width() * frame.height(), 0);
        let mut rough =
            Image::from_raw(frame.width(), frame.height(), samples).expect("there is room for all");
        let clipping = fusion::fuse_into(frame, &depth, bounded.waters(), &bounded.options, &mut rough);
        self.levels = depth.into_levels();
        (rough, clipping.expect("depth map and room were made for this frame"))
    }

    fn smooth(&mut self, rough: Image<u8>, smoothed: ImageMut<'_, u8>) {
        smooth::bilateral_into(&rough, smoothed).expect("the sizes are those of one frame");
        self.samples = rough.into_raw();
    }

    fn look_at(&mut self, frame: ImageRef<'_, u8>) -> (DepthMap, Bounded<crate::image::Encoded>) {
        let depth = self.depth_of(frame);
        let content = match self.content.filter(|_| self.age < self.options.every) {
            Some(known) => known,
            None => {
                self.age = 0;
                self.water_of(frame, &depth)
            }
        };
        self.age += 1;
        self.content = Some(content);
        (depth, Bounded::new(&content, &self.reference, self.options.fusion))
    }

    fn depth_of(&mut self, frame: ImageRef<'_, u8>) -> DepthMap {
        self.options.depth.estimate_in(frame, self.options.estimate.top, std::mem::take(&mut self.levels))
    }

    fn water_of(&mut self, frame: ImageRef<'_, u8>, depth: &DepthMap) -> Estimate {
        let found = waterbody::estimate_in(frame, depth, &self.options.estimate, &mut self.scratch);
        found.expect("the depth map was made for this frame")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fusion::Model;
    use crate::truth::{Scene, Size, waters};

    fn image(seed: u64, water: usize, width: usize, height: usize) -> Image<u8> {
        Scene::new(seed, Size { width, height }).seen_through(&waters()[water].water).to_samples()
    }

    fn one_by_one(frame: &Image<u8>, reference: &Estimate, options: &Options) -> (Image<u8>, Clipping) {
        let z = options.depth.estimate(frame);
        let own = waterbody::estimate(frame, &z, &options.estimate).unwrap();
        let bounded = Bounded::new(&own, reference, options.fusion);
        let fused = fusion::fuse(frame, &z, bounded.waters(), &bounded.options).unwrap();
        (options.smoothing.apply(fused.image), fused.clipping)
    }

    #[test]
    fn a_stream_is_its_steps_one_by_one_at_any_size() {
        for model in Model::ALL {
            for (i, depth) in DepthModel::ALL.into_iter().enumerate() {
                let (fusion, smoothing) = (fusion::Options::for_model(model), Smoothing::ALL[i % 2]);
                let options = Options { depth, fusion, smoothing, ..Options::default() };
                let mut stream = Stream::new(
                    Stream::new(image_estimate(), options).estimate(&image(2, 1, 96, 64)),
                    options,
                );
                for (seed, (width, height)) in
                    [(33, 65), (1, 1), (1, 40), (40, 1), (7, 7), (96, 64)].into_iter().enumerate()
                {
                    let frame = image(seed as u64, seed % 3, width, height);
                    let expected = one_by_one(&frame, &stream.reference, &options);
                    let (mut fused, mut in_place) = (image(9, 2, width, height), frame.clone());
                    let clipping = stream.fuse_into(&frame, &mut fused).unwrap();
                    assert_eq!((fused, clipping), expected);
                    let clipping = stream.fuse_mut(&mut in_place);
                    assert_eq!((in_place, clipping), expected);
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
        let mut stream = Stream::new(image_estimate(), Options { every: 3, ..Options::default() });
        let frames: Vec<_> = (0..5).map(|seed| image(seed, 0, 64, 48)).collect();
        let found: Vec<_> = frames
            .iter()
            .map(|frame| {
                stream.fuse_mut(&mut frame.clone());
                *stream.content().unwrap()
            })
            .collect();
        assert_eq!((found[1], found[2], found[4]), (found[0], found[0], found[3]));
        assert_eq!(found[3], stream.estimate(&frames[3]));
        assert_ne!(found[3], found[0]);
    }

    #[test]
    fn sizes_that_differ_are_an_error() {
        let mut stream = Stream::new(image_estimate(), Options::default());
        let error = stream.fuse_into(&image(1, 0, 8, 8), &mut image(1, 0, 8, 9)).unwrap_err();
        assert_eq!(error, SizeError::Mismatch { left: (8, 8), right: (8, 9) });
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
                let mut stream = Stream::new(image_estimate(), Options::default());
                let mut fused = frame.clone();
                let clipping = stream.fuse_into(&frame, &mut fused).unwrap();
                (fused, clipping, stream.content)
            })
        };
        assert_eq!(fused_on(1), fused_on(3));
    }
}
