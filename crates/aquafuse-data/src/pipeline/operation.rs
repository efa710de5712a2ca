//! Operations on an image: its water is exchanged or removed.

use aquafuse::formation::{BoundedRestoration, RestoreBounds, RestoreOptions, restore_mut};
use aquafuse::fusion::{Bounded, Bounds, Clipping, Model, Options, fuse_mut};
use aquafuse::image::{Encoded, Encoding, Image, Linear, Sample, SizeError};
use aquafuse::waterbody::Estimate;

use crate::image_file::Pixels;
use crate::pipeline::Analysis;

/// An operation on an image, in encoding `E`.
#[derive(Clone, Debug)]
#[allow(clippy::large_enum_variant, reason = "there is one a run, and it is seldom moved")]
pub enum Operation<E: Encoding = Encoded> {
    /// Put it into another water.
    Fuse {
        /// The estimate of the reference's water.
        reference: Estimate<E>,
        /// How to fuse.
        options: Options,
    },
    /// Remove its water.
    Restore(RestoreOptions),
}

/// The outcome of an operation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outcome {
    /// Values that were clipped.
    pub clipping: Clipping,
    /// Which safety bounds acted.
    pub limited: Limited,
    /// The share of the image's contrast (deviation of green) that is left, of [`Model::Exchange`] alone: thick water
    /// hides a scene.
    pub contrast_left: Option<f64>,
}

impl Outcome {
    /// A scene with less contrast left than this is hidden.
    pub const VANISHED: f64 = 0.1;

    /// Whether the water hides the scene.
    pub fn has_vanished(&self) -> bool {
        self.contrast_left.is_some_and(|left| left < Self::VANISHED)
    }
}

/// Which safety bounds acted: those of fusion, or those of restoration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Limited {
    /// Of a fusion.
    pub fusion: Bounds,
    /// Of a restoration.
    pub restoration: RestoreBounds,
}

impl Limited {
    /// Whether any acted.
    pub fn any(self) -> bool {
        self != Self::default()
    }
}

impl<E: Space> Operation<E> {
    /// Changes the pixels that `found` was estimated from.
    ///
    /// # Errors
    ///
    /// [`SizeError`] when pixels and depth map differ in size; the pixels are then unchanged.
    pub fn apply(&self, pixels: &mut Pixels, found: &Analysis<E>) -> Result<Outcome, SizeError> {
        match pixels {
            Pixels::Bytes(layers) => E::apply(&mut layers.image, found, self),
            Pixels::Words(layers) => E::apply(&mut layers.image, found, self),
            Pixels::Floats(layers) => E::apply(&mut layers.image, found, self),
        }
    }

    /// Changes an image in the encoding of the water.
    fn on<T: Sample>(&self, image: &mut Image<T, E>, found: &Analysis<E>) -> Result<Outcome, SizeError> {
        match self {
            Self::Fuse { reference, options } => {
                let bounded = Bounded::new(&found.estimate, reference, *options);
                let hides = options.model == Model::Exchange;
                let before = hides.then(|| deviation(image));
                let clipping = fuse_mut(&mut *image, &found.depth, bounded.waters(), &bounded.options)?;
                let limited = Limited { fusion: bounded.bounds, ..Limited::default() };
                // An image that had no contrast has lost none.
                let left = before.map(|before| if before > 0.0 { deviation(image) / before } else { 1.0 });
                Ok(Outcome { clipping, limited, contrast_left: left })
            }
            Self::Restore(options) => {
                let bounded = BoundedRestoration::new(&*image, &found.depth, &found.estimate, options)?;
                let clipping = restore_mut(image, &found.depth, &bounded.water, &bounded.options)?;
                let limited = Limited { restoration: bounded.bounds, ..Limited::default() };
                Ok(Outcome { clipping, limited, contrast_left: None })
            }
        }
    }

    /// Bytes a pixel that it takes beside the image.
    pub(crate) fn bytes_a_pixel(&self) -> u64 {
        E::BYTES_A_PIXEL
    }
}

/// Standard deviation of green.
fn deviation<T: Sample, E: Encoding>(image: &Image<T, E>) -> f64 {
    let (mut sum, mut squares, mut count) = (0.0, 0.0, 0.0);
    for [_, green, _] in image.pixels() {
        let green = f64::from(green.to_unit());
        (sum, squares, count) = (sum + green, squares + green * green, count + 1.0);
    }
    let mean: f64 = sum / count;
    (squares / count - mean * mean).max(0.0).sqrt()
}

/// An encoding that images of files can be worked on in.
pub trait Space: Encoding {
    /// Changes an image as its file holds it.
    ///
    /// # Errors
    ///
    /// [`SizeError`] when image and depth map differ in size; the image is then unchanged.
    fn apply<T: Sample>(
        image: &mut Image<T>,
        found: &Analysis<Self>,
        operation: &Operation<Self>,
    ) -> Result<Outcome, SizeError>;
    /// Bytes a pixel that this takes beside the image.
    const BYTES_A_PIXEL: u64;
    /// The name in reports.
    const NAME: &'static str;
}

impl Space for Encoded {
    /// In place.
    fn apply<T: Sample>(
        image: &mut Image<T>,
        found: &Analysis<Self>,
        operation: &Operation<Self>,
    ) -> Result<Outcome, SizeError> {
        operation.on(image, found)
    }
    const BYTES_A_PIXEL: u64 = 0;
    const NAME: &'static str = "encoded";
}

impl Space for Linear {
    /// Decoded to floats, and encoded again.
    fn apply<T: Sample>(
        image: &mut Image<T>,
        found: &Analysis<Self>,
        operation: &Operation<Self>,
    ) -> Result<Outcome, SizeError> {
        let mut light = image.to_linear();
        let outcome = operation.on(&mut light, found)?;
        *image = light.to_encoded().to_samples();
        Ok(outcome)
    }
    /// The light, the same encoded, and the samples.
    const BYTES_A_PIXEL: u64 = 3 * (4 + 4 + 4);
    const NAME: &'static str = "linear";
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image_file::ImageFile;
    use crate::pipeline::{DepthSource, analyse};
    use aquafuse::fusion::{Gain, Incidence};
    use aquafuse::truth::{Scene, Size, waters};
    use aquafuse::waterbody::Attenuation;

    fn image_files() -> [ImageFile; 2] {
        [0, 1].map(|i| {
            let scene = Scene::new(i as u64, Size { width: 64, height: 48 });
            ImageFile::new(scene.seen_through(&waters()[i].water).to_samples::<u8>())
        })
    }

    fn fused<E: Space>(theta: f32) -> [Image<u8>; 2] {
        let [content, reference] = image_files();
        let found = analyse::<E>(&content, &DepthSource::default()).unwrap();
        let reference = analyse::<E>(&reference, &DepthSource::default()).unwrap().estimate;
        let options = Options {
            incidence: Incidence::from_degrees(theta).unwrap(),
            gain: Gain::new(1.0).unwrap(),
            ..Options::for_model(Model::Physical)
        };
        let mut pixels = content.pixels.clone();
        Operation::Fuse { reference, options }.apply(&mut pixels, &found).unwrap();
        [content.pixels.into_bytes(), pixels.into_bytes()]
    }

    #[test]
    fn at_ninety_degrees_linear_light_returns_every_byte() {
        let [before, after] = fused::<Linear>(90.0);
        assert_eq!(before, after);
    }

    #[test]
    fn in_linear_light_the_fusion_is_another_one() {
        let [[_, encoded], [before, linear]] = [fused::<Encoded>(0.0), fused::<Linear>(0.0)];
        assert!(linear != before && linear != encoded);
    }

    #[test]
    fn thick_water_hides_the_scene_and_says_so() {
        let [content, reference] = image_files();
        let found = analyse::<Encoded>(&content, &DepthSource::default()).unwrap();
        let thick = |times: f32| {
            let mut reference = analyse(&reference, &DepthSource::default()).unwrap().estimate;
            let beta = reference.water.backscatter_coefficient.map(|beta| beta * times);
            reference.water.backscatter_coefficient = beta;
            let curve = |c: usize| {
                let mu = reference.water.attenuation[c].mu();
                let held = reference.water.attenuation[c].held_beyond();
                Attenuation::new([mu[0] * times, mu[1], mu[2] * times, mu[3]], held).unwrap()
            };
            reference.water.attenuation = [0, 1, 2].map(curve);
            let options = Options::for_model(Model::Exchange);
            let mut pixels = content.pixels.clone();
            Operation::Fuse { reference, options }.apply(&mut pixels, &found).unwrap()
        };
        assert!(!thick(1.0).has_vanished(), "{:?}", thick(1.0));
        assert!(thick(60.0).has_vanished(), "{:?}", thick(60.0));
    }

    #[test]
    fn restoring_takes_out_what_forming_put_in() {
        let scene = Scene::new(4, Size { width: 64, height: 48 });
        let water = waters()[1].water;
        let found = Analysis {
            depth: scene.depth.clone(),
            depth_source: DepthSource::default(),
            supplied: None,
            estimate: Estimate::given(water),
        };
        let mut pixels = Pixels::from(scene.seen_through(&water));
        let outcome = Operation::Restore(RestoreOptions::default()).apply(&mut pixels, &found).unwrap();
        assert!(!outcome.limited.any(), "{:?}", outcome.limited);
        let Pixels::Floats(restored) = pixels else { panic!("floats stay floats") };
        let most = RestoreOptions::default().max_gain[0];
        let places = restored.image.pixels().iter().zip(scene.clear.pixels()).zip(scene.depth.distances());
        for ((found, clear), z) in places {
            for c in (0..3).filter(|&c| water.illumination(z)[c] > 1.0 / most) {
                assert!((found[c] - clear[c]).abs() < 1e-4, "{} is not {}", found[c], clear[c]);
            }
        }
    }
}
