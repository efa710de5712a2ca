//! An image and what belongs to its pixels, as small as they are shown, and upright.

use crate::drawing::DrawError;
use crate::image_file::{ImageFile, Pixels};
use ::image::{ImageBuffer, Rgb, imageops};
use aquafuse::depth::DepthMap;
use aquafuse::formation::{BoundedRestoration, RestoreOptions, restore};
use aquafuse::image::{Image, Sample};
use aquafuse::waterbody::Estimate;

pub(super) struct View<'a> {
    image_file: &'a ImageFile,
    /// The image as shown, but in stored order.
    small: Image<u8>,
}

impl<'a> View<'a> {
    /// The image as large as fits into `room`.
    pub(super) fn new(image_file: &'a ImageFile, room: (u32, u32)) -> Self {
        let colours = image_file.bytes();
        let (width, height) = (colours.width() as u32, colours.height() as u32);
        let (across, down) = if image_file.metadata.orientation() > 4 { (room.1, room.0) } else { room };
        let scale = (f64::from(across) / f64::from(width)).min(f64::from(down) / f64::from(height));
        let side = |length: u32, most: u32| ((f64::from(length) * scale).round() as u32).clamp(1, most);
        let (across, down) = (side(width, across), side(height, down));
        let large = ImageBuffer::<Rgb<u8>, &[u8]>::from_raw(width, height, colours.as_raw());
        let small = imageops::thumbnail(&large.expect("three samples a pixel"), across, down);
        let small = Image::from_raw(across as usize, down as usize, small.into_raw());
        Self { image_file, small: small.expect("three samples a pixel") }
    }

    pub(super) fn content(&self) -> Image<u8> {
        self.upright(self.small.clone())
    }

    /// Something of each colour, as grey.
    pub(super) fn grey(&self, of: impl Fn([u8; 3]) -> u8) -> Image<u8> {
        self.upright(self.with_samples(self.small.pixels().iter().flat_map(|&colour| [of(colour); 3])))
    }

    /// Something of each distance from 0 to 1, as grey.
    pub(super) fn grey_of(&self, z: &DepthMap, of: impl Fn(f32) -> f32) -> Image<u8> {
        self.upright(self.with_samples(z.distances().into_iter().flat_map(|z| [u8::from_unit(of(z)); 3])))
    }

    /// White where `mask`, a value for each pixel of the image, is true; the image, darkened, elsewhere.
    pub(super) fn mask(&self, mask: &[bool]) -> Image<u8> {
        let (width, _) = self.image_file.pixels.size();
        let pixels = self.small.pixels().iter().zip(self.places());
        let samples = pixels.flat_map(|(&[r, g, b], (x, y))| match mask[y * width + x] {
            true => [255; 3],
            false => [r, g, b].map(|value| value / 2),
        });
        self.upright(self.with_samples(samples))
    }

    /// A depth map of the image as small as that is shown, in stored order: each place has the distance of
    /// one pixel, for a mean over the edge of a thing is no distance.
    pub(super) fn depth(&self, z: &DepthMap) -> DepthMap {
        let (width, height) = self.small.size();
        let distances = self.places().map(|(x, y)| z.at(x, y)).collect();
        DepthMap::from_distances(width, height, z.kind(), distances).expect("they were distances before")
    }

    /// The image without its water; `z` is [`View::depth`].
    pub(super) fn restored(&self, z: &DepthMap, estimate: &Estimate) -> Result<Image<u8>, DrawError> {
        let bounded = BoundedRestoration::new(&self.small, z, estimate, &RestoreOptions::default())?;
        Ok(self.upright(restore(&self.small, z, &bounded.water, &bounded.options)?.convert()))
    }

    /// Column and row of the pixel that stands for each place.
    fn places(&self) -> impl Iterator<Item = (usize, usize)> {
        let ((width, height), (across, down)) = (self.image_file.pixels.size(), self.small.size());
        let at = |i: usize, of: usize, length: usize| (2 * i + 1) * length / (2 * of);
        (0..down).flat_map(move |y| (0..across).map(move |x| (at(x, across, width), at(y, down, height))))
    }

    fn with_samples(&self, samples: impl Iterator<Item = u8>) -> Image<u8> {
        let (width, height) = self.small.size();
        Image::from_raw(width, height, samples.collect()).expect("three samples a pixel")
    }

    fn upright(&self, image: Image<u8>) -> Image<u8> {
        Pixels::from(image).turned(self.image_file.metadata.orientation()).into_bytes()
    }
}
