//! Frames whose depth is not estimated from their colours: it comes from a network, or with each of them.

use std::any::TypeId;

use aquafuse::image::{Image, ImageError, ImageMut, Sample};
use aquafuse::stream::Steady;
use aquafuse::waterbody::{EstimateOptions, water_share};

use super::change::{ContentWater, Recipe};
use super::error::VideoError;
use super::frames::FrameReport;
use crate::image_file::{ImageFile, Pixels};
use crate::pipeline::{Analysis, WaterEstimate};

/// What is done to frames with depth, and what those so far have shown.
#[derive(Clone, Debug)]
pub(crate) struct AtDepth {
    recipe: Recipe,
    steady: Steady,
}

impl AtDepth {
    pub(crate) fn new(recipe: &Recipe) -> Self {
        Self { recipe: recipe.clone(), steady: Steady::over(recipe.steady_over) }
    }

    /// Changes the next frame by its depth and its water, which `analyse` finds in the scene. A frame for which it finds none is
    /// unchanged.
    pub(crate) fn change<T: Sample>(
        &mut self,
        mut frame: ImageMut<'_, T>,
        analyse: impl FnOnce(&ImageFile) -> Result<Analysis<WaterEstimate>, VideoError>,
    ) -> Result<FrameReport, VideoError> {
        let Self { recipe, steady } = self;
        let image = frame.as_ref().to_image();
        // Floats hold words as they are.
        let pixels = match TypeId::of::<T>() == TypeId::of::<u8>() {
            true => Pixels::from(image.convert::<u8>()),
            false => Pixels::from(image.convert::<f32>()),
        };
        let request = |error: &dyn std::fmt::Display| VideoError::Request(error.to_string());
        let file = ImageFile::new(pixels).with_water_map(recipe.water_map);
        let mut file = file.cut_to_scene(recipe.border).map_err(|error| request(&error))?;
        let mut found = analyse(&file)?;
        if let ContentWater::Given(water) = recipe.content_water {
            let options = EstimateOptions::default().with_water_map(recipe.water_map);
            let veil = &water.water.veiling_light;
            found.share = water_share(&*file.bytes(), &found.depth, veil, &options)?;
            found.estimate = WaterEstimate::Encoded(water);
        }
        let done = recipe.operation.apply_next(&mut file.pixels, Some(&found), steady);
        let clipping = done.map_err(|error| request(&error))?.clipping;
        file.pixels = file.pixels.smoothed(recipe.smoothing);
        let mut finish = |image: Image<T>| -> Result<(), ImageError> { frame.copy_from(image.view()) };
        match file.joined().pixels {
            Pixels::Bytes(layers) => finish(layers.image.convert()),
            Pixels::Words(layers) => finish(layers.image.convert()),
            Pixels::Floats(layers) => finish(layers.image.convert()),
        }?;
        Ok(FrameReport { clipping, quality: Some(found.estimate.quality()) })
    }
}
