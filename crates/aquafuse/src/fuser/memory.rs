//! What one image leaves for the next.

use std::borrow::Cow;

use crate::depth::{Buffers, DepthMap};
use crate::image::{ImageError, ImageMut, ImageRef, Sample};
use crate::scene_area::{Border, Margins, SceneArea};
use crate::stream::Steady;
use crate::waterbody::Glimpse;

/// What an image needs and the next of its size can use again.
#[derive(Clone, Debug, Default)]
pub(crate) struct Memory<T> {
    pub(super) depth: Buffers,
    /// What the network saw last.
    pub(crate) glimpse: Glimpse,
    /// What an image consists of before it is smoothed.
    pub(super) samples: Vec<T>,
    /// The part of the last image that is scene, and of how many images it has been.
    pub(super) area: Option<SceneArea>,
    area_age: u32,
    /// What a sequence of frames has shown.
    pub(crate) steady: Option<Steady>,
}

/// Images of one size after which the border is looked for again: that of a film does not change, and a look at each frame
/// would take as long as the rest of a small one.
const BORDER_EVERY: u32 = 64;

impl<T> Memory<T> {
    /// The part of an image that is scene: for some images that of the first, so that a border does not come and go from
    /// frame to frame.
    pub(super) fn area(&mut self, image: ImageRef<'_, T>, border: Border) -> Result<SceneArea, ImageError>
    where
        T: Sample,
    {
        let is_fresh = self.area_age < BORDER_EVERY;
        let last = self.area.take().filter(|area| is_fresh && area.image_size() == image.size());
        self.area_age = if last.is_some() { self.area_age + 1 } else { 1 };
        Ok(last.map_or_else(|| SceneArea::of(image, border), Ok)?)
    }

    /// Changes the part of an image that is scene, in place; the sides that were left as they are.
    pub(crate) fn on_scene<R>(
        &mut self,
        mut image: ImageMut<'_, T>,
        border: Border,
        depth: Option<&DepthMap>,
        change: impl FnOnce(ImageMut<'_, T>, Option<&DepthMap>, &mut Self) -> Result<R, ImageError>,
    ) -> Result<(R, Margins), ImageError>
    where
        T: Sample,
    {
        let area = self.area(image.as_ref(), border)?;
        let result = if area.is_whole() {
            change(image, depth, self)?
        } else {
            let mut scene = area.cut(image.as_ref());
            let depth = depth.map(|depth| depth.cut(&area)).transpose()?;
            let result = change(scene.view_mut(), depth.as_ref(), self)?;
            area.put_back(&scene, image.reborrow())?;
            result
        };
        let margins = area.margins();
        self.area = Some(area);
        Ok((result, margins))
    }

    pub(crate) fn take_back(&mut self, depth: Cow<'_, DepthMap>) {
        if let Cow::Owned(depth) = depth {
            self.depth = depth.into_buffers();
        }
    }
}
