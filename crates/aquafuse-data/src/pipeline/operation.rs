//! Operations on an image: its water is exchanged or removed, or its levels are set.

use aquafuse::formation::{BoundedRestoration, RestoreBounds, RestoreOptions, restore_mut};
use aquafuse::fusion::{Bounded, Bounds, Clipping, Options, TransferLaw, fuse_mut};
use aquafuse::image::{Encoding, Image, ImageError, Sample};
use aquafuse::levels::{Levels, LevelsOptions, lightness};
use aquafuse::stream::Steady;
use aquafuse::waterbody::Estimate;

use super::encoding::{PixelEncoding, Space, WaterEstimate, with_estimate};
use super::estimate::Analysis;
use super::sampled::Sampled;
use crate::image_file::Pixels;

/// What is done to each image.
#[derive(Clone, Copy, Debug)]
#[allow(clippy::large_enum_variant, reason = "there is one a run, and it is seldom moved")]
pub enum Operation {
    /// The image is seen in another water, in the encoding of that water.
    Fuse {
        /// The reference's water, with its verdict.
        reference: WaterEstimate,
        /// How to fuse.
        options: Options,
    },
    /// As [`Fuse`](Self::Fuse), with the lightness that the image had.
    Clarify {
        /// The clear water, with its verdict.
        reference: WaterEstimate,
        /// How to fuse.
        options: Options,
    },
    /// The image is seen as if through air, and its levels are set.
    Restore {
        /// How to restore.
        options: RestoreOptions,
        /// How to set the levels of what is restored.
        levels: LevelsOptions,
        /// Which values to work on.
        encoding: PixelEncoding,
    },
    /// The levels of the image are set, without an estimate of its water.
    Enhance {
        /// How to set them.
        levels: LevelsOptions,
    },
}

/// An operation cannot be applied to an analysis.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OperationError {
    /// Image and depth map differ in size.
    #[error(transparent)]
    Size(#[from] ImageError),
    /// The water of the operation is of another encoding than the analysis.
    #[error(
        "the water is for {operation} values, but the image was analysed in {analysis} values; use one encoding for both"
    )]
    Encodings {
        /// That of the operation.
        operation: PixelEncoding,
        /// That of the analysis.
        analysis: PixelEncoding,
    },
    /// The operation needs an analysis.
    #[error("this operation needs the water of the image; analyse the image first")]
    NoAnalysis,
}

/// The outcome of an operation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// Values that were clipped.
    pub clipping: Clipping,
    /// Which safety bounds acted.
    pub limited: Limited,
    /// The share of the image's contrast (deviation of green) that is left: thick water hides a scene.
    pub contrast_left: f64,
    /// How much the image changed: the mean distance of colours in CIELab (ΔE 1976), over a grid of pixels.
    pub change: f64,
    /// The levels that were set.
    pub levels: Option<Levels>,
}

/// What an operation did.
#[derive(Default)]
struct Done {
    clipping: Clipping,
    limited: Limited,
    levels: Option<Levels>,
}

impl Outcome {
    /// A scene with less contrast left than this is hidden.
    pub const VANISHED: f64 = 0.1;
    /// An image that changed by less (ΔE) has hardly changed: the eye finds the difference side by side at best.
    pub const UNCHANGED: f64 = 5.0;

    /// Whether the water hides the scene.
    pub fn has_vanished(&self) -> bool {
        self.contrast_left < Self::VANISHED
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

impl Operation {
    /// The encoding that it works in, and that an image must be analysed in.
    pub fn encoding(&self) -> PixelEncoding {
        match self {
            Self::Fuse { reference, .. } | Self::Clarify { reference, .. } => reference.encoding(),
            Self::Restore { encoding, .. } => *encoding,
            Self::Enhance { .. } => PixelEncoding::Encoded,
        }
    }

    /// Whether it needs depth and water of the image.
    pub fn needs_analysis(&self) -> bool {
        !matches!(self, Self::Enhance { .. })
    }

    /// The water of a fusion, and how to fuse.
    pub(crate) fn fusion(&self) -> Option<(&WaterEstimate, &Options)> {
        match self {
            Self::Fuse { reference, options } | Self::Clarify { reference, options } => {
                Some((reference, options))
            }
            Self::Restore { .. } | Self::Enhance { .. } => None,
        }
    }

    /// Changes the pixels that `found` was estimated from.
    ///
    /// # Errors
    ///
    /// [`OperationError`] when pixels and depth map differ in size, operation and analysis in encoding, or an analysis is
    /// needed and there is none; the pixels are then unchanged.
    pub fn apply(
        &self,
        pixels: &mut Pixels,
        found: Option<&Analysis<WaterEstimate>>,
    ) -> Result<Outcome, OperationError> {
        self.apply_by(pixels, found, None)
    }

    /// As [`apply`](Self::apply) for the next frame of a sequence, with the water and the levels of the sequence.
    ///
    /// # Errors
    ///
    /// As [`apply`](Self::apply).
    pub fn apply_next(
        &self,
        pixels: &mut Pixels,
        found: Option<&Analysis<WaterEstimate>>,
        steady: &mut Steady,
    ) -> Result<Outcome, OperationError> {
        steady.look(&*pixels.bytes());
        self.apply_by(pixels, found, Some(steady))
    }

    fn apply_by(
        &self,
        pixels: &mut Pixels,
        found: Option<&Analysis<WaterEstimate>>,
        steady: Option<&mut Steady>,
    ) -> Result<Outcome, OperationError> {
        match pixels {
            Pixels::Bytes(layers) => self.measured(&mut layers.image, found, steady),
            Pixels::Words(layers) => self.measured(&mut layers.image, found, steady),
            Pixels::Floats(layers) => self.measured(&mut layers.image, found, steady),
        }
    }

    /// Changes an image, and measures how much.
    fn measured<T: Sample>(
        &self,
        image: &mut Image<T>,
        found: Option<&Analysis<WaterEstimate>>,
        steady: Option<&mut Steady>,
    ) -> Result<Outcome, OperationError> {
        let before = Sampled::of(image);
        let Done { clipping, limited, levels } = self.change(image, found, steady)?;
        let after = Sampled::of(image);
        let (contrast_left, change) = (after.contrast_beside(&before), after.change_from(&before));
        Ok(Outcome { clipping, limited, contrast_left, change, levels })
    }

    /// Changes an image as its file holds it.
    fn change<T: Sample>(
        &self,
        image: &mut Image<T>,
        found: Option<&Analysis<WaterEstimate>>,
        steady: Option<&mut Steady>,
    ) -> Result<Done, OperationError> {
        if let Self::Enhance { levels: options } = self {
            let (clipping, levels) = match steady {
                Some(steady) => steady.enhance_mut(image, options),
                None => {
                    let levels = Levels::of(&*image, options);
                    (levels.apply(image), levels)
                }
            };
            return Ok(Done { clipping, levels: Some(levels), ..Done::default() });
        }
        let found = found.ok_or(OperationError::NoAnalysis)?;
        let (operation, analysis) = (self.encoding(), found.estimate.encoding());
        if operation != analysis {
            return Err(OperationError::Encodings { operation, analysis });
        }
        match self {
            Self::Restore { options, levels, .. } => restored(image, found, options, levels, steady),
            Self::Clarify { .. } => {
                let before = lightness(&*image);
                let outcome = self.fused(image, found, steady)?;
                let levels = Levels::of_lightness(&*image, before);
                levels.apply(image);
                Ok(Done { levels: Some(levels), ..outcome })
            }
            _ => self.fused(image, found, steady),
        }
    }

    /// Encoded values in place, light decoded to floats and encoded again.
    fn fused<T: Sample>(
        &self,
        image: &mut Image<T>,
        found: &Analysis<WaterEstimate>,
        steady: Option<&mut Steady>,
    ) -> Result<Done, OperationError> {
        match &found.estimate {
            WaterEstimate::Encoded(own) => self.fuse(image, found, own, steady),
            WaterEstimate::Linear(own) => {
                let mut light = image.to_linear();
                let outcome = self.fuse(&mut light, found, own, steady)?;
                *image = light.to_encoded().convert();
                Ok(outcome)
            }
        }
    }

    /// Fuses an image in the encoding of its water.
    fn fuse<T: Sample, E: Space>(
        &self,
        image: &mut Image<T, E>,
        found: &Analysis<WaterEstimate>,
        own: &Estimate<E>,
        steady: Option<&mut Steady>,
    ) -> Result<Done, OperationError> {
        let (operation, analysis) = (self.encoding(), found.estimate.encoding());
        let fusion = self.fusion().and_then(|(reference, options)| bounded(own, reference, *options));
        let bounded = fusion.ok_or(OperationError::Encodings { operation, analysis })?;
        let clipping = match steady {
            Some(steady) => steady.fuse_mut(&mut *image, &found.depth, own, &found.share, &bounded)?,
            None => {
                let waters = bounded.waters().with_share(&found.share);
                fuse_mut(&mut *image, &found.depth, waters, &bounded.options)?
            }
        };
        let limited = Limited { fusion: bounded.bounds, ..Limited::default() };
        Ok(Done { clipping, limited, levels: None })
    }

    /// The depth factor F that a fusion uses at each of the pixels that `found` was estimated from, row by row, within the safety
    /// bounds. `None` for an operation without F, and for two encodings, which [`apply`](Self::apply) refuses.
    pub(crate) fn depth_factors(
        &self,
        pixels: &Pixels,
        found: &Analysis<WaterEstimate>,
    ) -> Option<Vec<[f32; 3]>> {
        fn of<T: Sample, E: Space>(
            image: &Image<T>,
            found: &Analysis<WaterEstimate>,
            law: &TransferLaw<E>,
        ) -> Vec<[f32; 3]> {
            let factor = |x: usize, y: usize, pixel: &[T; 3]| {
                law.depth_factor(found.depth.at(x, y), found.share.at(x, y, pixel.map(Sample::to_unit)))
            };
            let rows = image.pixels().chunks(image.size().0).enumerate();
            let of_row = |(y, row): (usize, &[[T; 3]])| {
                row.iter().enumerate().map(|(x, pixel)| factor(x, y, pixel)).collect::<Vec<_>>()
            };
            rows.flat_map(of_row).collect()
        }
        let (reference, options) = self.fusion()?;
        with_estimate!(&found.estimate, own => {
            let bounded = bounded(own, reference, *options)?;
            let law = TransferLaw::new(bounded.waters(), &bounded.options);
            Some(match pixels {
                Pixels::Bytes(layers) => of(&layers.image, found, &law),
                Pixels::Words(layers) => of(&layers.image, found, &law),
                Pixels::Floats(layers) => of(&layers.image, found, &law),
            })
        })
    }

    /// Bytes a pixel that it takes beside the image.
    pub(crate) fn bytes_a_pixel(&self) -> u64 {
        self.encoding().bytes_a_pixel()
    }
}

/// Restores an image in the encoding of its water, and sets its levels.
fn restored<T: Sample>(
    image: &mut Image<T>,
    found: &Analysis<WaterEstimate>,
    options: &RestoreOptions,
    levels: &LevelsOptions,
    steady: Option<&mut Steady>,
) -> Result<Done, OperationError> {
    match &found.estimate {
        WaterEstimate::Encoded(own) => {
            let bounded = BoundedRestoration::new(&*image, &found.depth, own, options)?;
            if levels.sets_nothing() {
                return Ok(restored_alone(image, found, own, &bounded, steady)?);
            }
            Ok(levelled(image, found, own, &bounded, levels, steady)?)
        }
        WaterEstimate::Linear(own) => {
            let mut light = image.to_linear();
            let bounded = BoundedRestoration::new(&light, &found.depth, own, options)?;
            if levels.sets_nothing() {
                let done = restored_alone(&mut light, found, own, &bounded, steady)?;
                *image = light.to_encoded().convert();
                return Ok(done);
            }
            drop(light);
            Ok(levelled(image, found, own, &bounded, levels, steady)?)
        }
    }
}

/// Restores an image whose levels stay.
fn restored_alone<T: Sample, E: Encoding>(
    image: &mut Image<T, E>,
    found: &Analysis<WaterEstimate>,
    own: &Estimate<E>,
    bounded: &BoundedRestoration<E>,
    steady: Option<&mut Steady>,
) -> Result<Done, ImageError> {
    let clipping = match steady {
        Some(steady) => steady.restore_mut(image, &found.depth, own, bounded)?,
        None => restore_mut(image, &found.depth, &bounded.water, &bounded.options)?,
    };
    let limited = Limited { restoration: bounded.bounds, ..Limited::default() };
    Ok(Done { clipping, limited, levels: None })
}

/// Restores an image and sets its levels in one pass.
fn levelled<T: Sample, E: Encoding>(
    image: &mut Image<T>,
    found: &Analysis<WaterEstimate>,
    own: &Estimate<E>,
    bounded: &BoundedRestoration<E>,
    options: &LevelsOptions,
    steady: Option<&mut Steady>,
) -> Result<Done, ImageError> {
    let (clipping, levels) = match steady {
        Some(steady) => steady.restore_and_level_mut(image, &found.depth, own, bounded, options)?,
        None => {
            let levels = bounded.levels(&*image, &found.depth, options)?;
            (bounded.restore_and_level_mut(image, &found.depth, &levels)?, levels)
        }
    };
    let limited = Limited { restoration: bounded.bounds, ..Limited::default() };
    Ok(Done { clipping, limited, levels: Some(levels) })
}

/// The waters and options of a fusion within the safety bounds; `None` for waters of two encodings.
fn bounded<E: Space>(own: &Estimate<E>, reference: &WaterEstimate, options: Options) -> Option<Bounded<E>> {
    Some(Bounded::new(own, &E::estimate(reference)?, options))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image_file::ImageFile;
    use crate::pipeline::{DepthSource, analyse, analyse_in};
    use aquafuse::fusion::{Gain, Incidence, Model};
    use aquafuse::levels::Setting;
    use aquafuse::truth::{Scene, Size, waters};
    use aquafuse::waterbody::{Attenuation, Quality, WaterShare};

    fn image_files() -> [ImageFile; 2] {
        [0, 1].map(|i| {
            let scene = Scene::new(i as u64, Size { width: 64, height: 48 });
            ImageFile::new(scene.seen_through(&waters()[i].water).convert::<u8>())
        })
    }

    fn fused(encoding: PixelEncoding, theta: f32) -> [Image<u8>; 2] {
        let [content, reference] = image_files();
        let found = analyse_in(encoding, &content, &DepthSource::default()).unwrap();
        let reference = analyse_in(encoding, &reference, &DepthSource::default()).unwrap().estimate;
        let options = Options::for_model(Model::Physical)
            .with_incidence(Incidence::from_degrees(theta).unwrap())
            .with_gain(Gain::new(1.0).unwrap());
        let mut pixels = content.pixels.clone();
        Operation::Fuse { reference, options }.apply(&mut pixels, Some(&found)).unwrap();
        [content.pixels.into_bytes(), pixels.into_bytes()]
    }

    #[test]
    fn at_ninety_degrees_linear_light_returns_every_byte() {
        let [before, after] = fused(PixelEncoding::Linear, 90.0);
        assert_eq!(before, after);
    }

    #[test]
    fn in_linear_light_the_fusion_is_another_one() {
        let [[_, encoded], [before, linear]] =
            [fused(PixelEncoding::Encoded, 0.0), fused(PixelEncoding::Linear, 0.0)];
        assert!(linear != before && linear != encoded);
    }

    #[test]
    fn a_water_of_linear_light_never_meets_encoded_values() {
        let [content, reference] = image_files();
        let found = analyse_in(PixelEncoding::Encoded, &content, &DepthSource::default()).unwrap();
        let reference =
            analyse_in(PixelEncoding::Linear, &reference, &DepthSource::default()).unwrap().estimate;
        let mut pixels = content.pixels.clone();
        let refused =
            Operation::Fuse { reference, options: Options::default() }.apply(&mut pixels, Some(&found));
        assert!(matches!(refused, Err(OperationError::Encodings { .. })), "{refused:?}");
        assert_eq!(pixels.into_bytes(), content.pixels.into_bytes());
    }

    #[test]
    fn thick_water_hides_the_scene_and_says_so() {
        let [content, reference] = image_files();
        let mut found = analyse(&content, &DepthSource::default()).unwrap();
        // Of a doubtful one exchange would keep the direct signal.
        found.estimate.quality = Quality::default();
        let found = found.into();
        let thick = |times: f32| {
            let mut reference = analyse(&reference, &DepthSource::default()).unwrap().estimate;
            let beta = reference.water.backscatter_coefficient.map(|beta| beta * times);
            reference.water.backscatter_coefficient = beta;
            reference.quality = Quality::default();
            let curve = |c: usize| {
                let mu = reference.water.attenuation[c].mu();
                let held = reference.water.attenuation[c].held_beyond();
                Attenuation::new([mu[0] * times, mu[1], mu[2] * times, mu[3]], held).unwrap()
            };
            reference.water.attenuation = [0, 1, 2].map(curve);
            let options = Options::for_model(Model::Exchange);
            let mut pixels = content.pixels.clone();
            Operation::Fuse { reference: reference.into(), options }.apply(&mut pixels, Some(&found)).unwrap()
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
            share: WaterShare::none(scene.depth.size()),
            estimate: WaterEstimate::from(Estimate::given(water)),
        };
        let mut pixels = Pixels::from(scene.seen_through(&water));
        let options = RestoreOptions::default().with_max_gain([8.0; 3]);
        let levels = LevelsOptions::default().with_white(Setting::None).with_exposure(Setting::None);
        let outcome = Operation::Restore { options, levels, encoding: PixelEncoding::Encoded }
            .apply(&mut pixels, Some(&found))
            .unwrap();
        assert!(!outcome.limited.any(), "{:?}", outcome.limited);
        let Pixels::Floats(restored) = pixels else { panic!("floats stay floats") };
        let most = options.max_gain[0];
        let places = restored.image.pixels().iter().zip(scene.clear.pixels()).zip(scene.depth.distances());
        for ((found, clear), z) in places {
            for c in (0..3).filter(|&c| water.illumination(z)[c] > 1.0 / most) {
                assert!((found[c] - clear[c]).abs() < 1e-4, "{} is not {}", found[c], clear[c]);
            }
        }
    }
}
