//! A restoration whose levels are set in the same pass: values are rounded once.

use std::marker::PhantomData;

use super::{BoundedRestoration, restore_by_mut, undoing};
use crate::depth::{DepthMap, InSteps};
use crate::image::{Clipping, Encoding, ImageError, ImageMut, ImageRef, Sample};
use crate::levels::{Before, Levels, LevelsOptions};
use crate::stream::{EffectTable, WaterEffect};

impl<E: Encoding> BoundedRestoration<E> {
    /// The levels of what [`restore_and_level_mut`](Self::restore_and_level_mut) restores. With depth from colour red is kept from
    /// leading where it did not.
    ///
    /// # Errors
    ///
    /// [`ImageError`] when image and depth map differ in size.
    pub fn levels<'a, T: Sample>(
        &self,
        image: impl Into<ImageRef<'a, T>>,
        depth: &DepthMap,
        options: &LevelsOptions,
    ) -> Result<Levels, ImageError> {
        let image = image.into();
        depth.check_fits(image.size())?;
        Ok(Levels::of_restored(image, options, self.depth_from_colour, &self.restored(depth)))
    }

    /// Restores an encoded image by Eq. 2 in the encoding of the water, and sets its levels.
    ///
    /// # Errors
    ///
    /// [`ImageError`] when image and depth map differ in size; the image is then unchanged.
    ///
    /// # Examples
    ///
    /// ```
    /// use aquafuse::{depth, formation::{BoundedRestoration, RestoreOptions}, image::Image, levels::LevelsOptions};
    /// use aquafuse::{truth, waterbody};
    ///
    /// let scene = truth::Scene::new(1, truth::Size { width: 96, height: 64 });
    /// let mut image: Image<u8> = scene.seen_through(&truth::waters()[0].water).convert();
    /// let z = depth::estimate(&image);
    /// let found = waterbody::estimate(&image, &z, &Default::default())?;
    /// let bounded = BoundedRestoration::new(&image, &z, &found, &RestoreOptions::default())?;
    /// let levels = bounded.levels(&image, &z, &LevelsOptions::default())?;
    /// bounded.restore_and_level_mut(&mut image, &z, &levels)?;
    /// # Ok::<(), aquafuse::image::ImageError>(())
    /// ```
    pub fn restore_and_level_mut<'a, T: Sample>(
        &self,
        image: impl Into<ImageMut<'a, T>>,
        depth: &DepthMap,
        levels: &Levels,
    ) -> Result<Clipping, ImageError> {
        let image = image.into();
        depth.check_fits(image.size())?;
        Ok(levels.apply_restored(image, &self.restored(depth)))
    }

    /// [`levels`](Self::levels) where this is the veiling light, and the rest is read from a table if there is one.
    pub(crate) fn levels_by<T: Sample>(
        &self,
        image: ImageRef<'_, T>,
        depth: &DepthMap,
        options: &LevelsOptions,
        veil: [f32; 3],
        effect: Option<&EffectTable>,
    ) -> Levels {
        let restored = restored::<E, _>(depth, self.by_effect(veil, effect));
        Levels::of_restored(image, options, self.depth_from_colour, &restored)
    }

    /// [`restore_and_level_mut`](Self::restore_and_level_mut), likewise.
    pub(crate) fn restore_and_level_by_mut<T: Sample>(
        &self,
        image: ImageMut<'_, T>,
        depth: &DepthMap,
        levels: &Levels,
        veil: [f32; 3],
        effect: Option<&EffectTable>,
    ) -> Clipping {
        levels.apply_restored(image, &restored::<E, _>(depth, self.by_effect(veil, effect)))
    }

    /// [`restore_mut`](super::restore_mut), likewise.
    pub(crate) fn restore_by_mut<T: Sample>(
        &self,
        image: ImageMut<'_, T, E>,
        depth: &DepthMap,
        veil: [f32; 3],
        effect: Option<&EffectTable>,
    ) -> Result<Clipping, ImageError> {
        restore_by_mut(image, depth, self.by_effect(veil, effect))
    }

    /// What the water does at a distance, and the gain that undoes it.
    pub(crate) fn effect(&self) -> impl Fn(f32) -> WaterEffect {
        let law = undoing(f32::INFINITY, &self.water, &self.options);
        move |z| {
            let factor = self.water.depth_factor(z);
            WaterEffect { factor, gain: law(z).0, after: factor }
        }
    }

    fn by_effect(&self, veil: [f32; 3], effect: Option<&EffectTable>) -> impl Fn(f32) -> Change {
        let own = self.effect();
        move |z| {
            let WaterEffect { factor, gain, .. } = effect.map_or_else(|| own(z), |effect| effect.at(z));
            (gain, std::array::from_fn(|c| veil[c] * (1.0 - factor[c])))
        }
    }

    fn restored<'a>(&self, depth: &'a DepthMap) -> Restored<'a, E, impl Fn(f32) -> Change + Sync> {
        restored(depth, undoing(depth.measured_to(), &self.water, &self.options))
    }
}

fn restored<E: Encoding, L: Fn(f32) -> Change + Sync>(depth: &DepthMap, law: L) -> Restored<'_, E, L> {
    let table = depth.in_steps().map(|steps| (steps, steps.table(&law)));
    Restored { depth, table, law, encoding: PhantomData::<E> }
}

/// Gain and backscatter.
type Change = ([f32; 3], [f32; 3]);

/// Eq. 2 in encoding `E`, from an encoded value to an encoded value.
struct Restored<'a, E, L> {
    depth: &'a DepthMap,
    /// Of depth in steps: the steps, and the law at each.
    table: Option<(InSteps<'a>, Vec<Change>)>,
    law: L,
    encoding: PhantomData<E>,
}

impl<E: Encoding, L: Fn(f32) -> Change + Sync> Before for Restored<'_, E, L> {
    const LEAD_FROM_BEHIND: f32 = 0.0;

    #[inline(always)]
    fn at(&self, x: usize, y: usize, raw: [f32; 3]) -> [f32; 3] {
        let (gain, backscatter) = match &self.table {
            Some((steps, table)) => table[steps.place(y * self.depth.width() + x)],
            None => (self.law)(self.depth.at(x, y)),
        };
        std::array::from_fn(|c| E::to_encoded((E::from_encoded(raw[c]) - backscatter[c]) * gain[c]))
    }
}
