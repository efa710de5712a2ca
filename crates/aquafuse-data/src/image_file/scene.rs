//! The scene of an image, taken out of what surrounds it and put back.

use std::sync::Arc;

use aquafuse::image::Sample;
use aquafuse::scene_area::{Border, BorderError, SceneArea};

use super::{ImageFile, Layers, Pixels};

/// The whole image that a scene was cut from.
#[derive(Clone, Debug)]
pub(super) struct Whole {
    area: SceneArea,
    pixels: Pixels,
}

impl ImageFile {
    /// The image with only its scene in [`pixels`](Self::pixels), so that nothing else enters an estimate or is changed.
    /// What is cut off is kept, and [`joined`](Self::joined) puts it back around the scene, byte for byte.
    ///
    /// With [`Border::Auto`] transparent pixels are no scene either. With [`Border::None`] nothing is cut off.
    ///
    /// # Errors
    ///
    /// [`BorderError`] when a given border leaves no pixel.
    ///
    /// # Examples
    ///
    /// ```
    /// use aquafuse::image::Image;
    /// use aquafuse::scene_area::{Border, Margins};
    /// use aquafuse_data::image_file::ImageFile;
    ///
    /// let image = ImageFile::new(Image::<u8>::from_raw(1, 3, vec![0, 0, 0, 90, 100, 110, 0, 0, 0])?);
    /// let border = Border::Given(Margins { top: 1, bottom: 1, ..Margins::default() });
    /// let scene = image.cut_to_scene(border)?;
    /// assert_eq!(scene.pixels.size(), (1, 1));
    /// assert_eq!(scene.joined().pixels.size(), (1, 3));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn cut_to_scene(self, border: Border) -> Result<Self, BorderError> {
        if border == Border::None {
            return Ok(self);
        }
        let whole = self.joined();
        let area = match &whole.pixels {
            Pixels::Bytes(layers) => area_of(layers, border),
            Pixels::Words(layers) => area_of(layers, border),
            Pixels::Floats(layers) => area_of(layers, border),
        }?;
        if area.is_whole() {
            return Ok(whole);
        }
        let scene = match &whole.pixels {
            Pixels::Bytes(layers) => Pixels::Bytes(cut(layers, &area)),
            Pixels::Words(layers) => Pixels::Words(cut(layers, &area)),
            Pixels::Floats(layers) => Pixels::Floats(cut(layers, &area)),
        };
        let Self { pixels, metadata, damage, whole: _, water_map } = whole;
        Ok(Self { pixels: scene, metadata, damage, whole: Some(Arc::new(Whole { area, pixels })), water_map })
    }

    /// The whole image again, with the scene as it is now. An image that was not cut is returned as it is.
    #[must_use]
    pub fn joined(self) -> Self {
        let Self { pixels, metadata, damage, whole, water_map } = self;
        let pixels = match whole.map(Arc::unwrap_or_clone) {
            None => pixels,
            Some(Whole { area, pixels: mut all }) => {
                match (pixels, &mut all) {
                    (Pixels::Bytes(scene), Pixels::Bytes(all)) => put_back(&scene, all, &area),
                    (Pixels::Words(scene), Pixels::Words(all)) => put_back(&scene, all, &area),
                    (Pixels::Floats(scene), Pixels::Floats(all)) => put_back(&scene, all, &area),
                    _ => unreachable!("no work on a scene changes its samples"),
                }
                all
            }
        };
        Self { pixels, metadata, damage, whole: None, water_map }
    }

    /// Which part of the whole image the pixels are; `None` if they are all of it.
    pub fn area(&self) -> Option<&SceneArea> {
        self.whole.as_ref().map(|whole| &whole.area)
    }

    /// Columns and rows of the whole image.
    pub fn whole_size(&self) -> (usize, usize) {
        self.area().map_or_else(|| self.pixels.size(), SceneArea::image_size)
    }
}

fn area_of<T: Sample>(layers: &Layers<T>, border: Border) -> Result<SceneArea, BorderError> {
    let area = SceneArea::of(&layers.image, border)?;
    let clear = |alpha: &T| *alpha == T::default();
    Ok(match &layers.alpha {
        Some(alpha) if border == Border::Auto && alpha.iter().any(clear) => {
            let width = layers.image.width();
            area.only(|x, y| {
                y.checked_mul(width).and_then(|i| alpha.get(i.checked_add(x)?)).is_some_and(|a| !clear(a))
            })
        }
        _ => area,
    })
}

fn cut<T: Sample>(layers: &Layers<T>, area: &SceneArea) -> Layers<T> {
    let alpha = layers.alpha.as_ref().map(|alpha| area.cut_values(alpha.iter().copied()));
    Layers { image: area.cut(&layers.image), alpha }
}

/// Nothing changes opacity, so the whole image keeps its own.
fn put_back<T: Sample>(scene: &Layers<T>, all: &mut Layers<T>, area: &SceneArea) {
    area.put_back(&scene.image, &mut all.image).expect("no work on a scene changes its size");
}

#[cfg(test)]
mod tests {
    use super::*;
    use aquafuse::image::Image;
    use aquafuse::scene_area::Margins;

    fn image() -> Image<u8> {
        Image::from_raw(2, 3, (0..18).collect()).unwrap()
    }

    #[test]
    fn what_surrounds_a_scene_keeps_every_byte() {
        let border = Border::Given(Margins { top: 1, left: 1, ..Margins::default() });
        let mut scene = ImageFile::new(image()).cut_to_scene(border).unwrap();
        assert_eq!((scene.pixels.size(), scene.whole_size()), ((1, 2), (2, 3)));
        scene.pixels = Pixels::from(Image::<u8>::from_raw(1, 2, vec![200; 6]).unwrap());
        let expected = [0, 1, 2, 3, 4, 5, 6, 7, 8, 200, 200, 200, 12, 13, 14, 200, 200, 200];
        assert_eq!(scene.joined().pixels.into_bytes().into_raw(), expected);
    }

    #[test]
    fn transparent_pixels_are_no_scene() {
        let alpha = Some(vec![255, 255, 0, 255, 255, 255]);
        let pixels = Pixels::Bytes(Layers { image: image(), alpha: alpha.clone() });
        let mut scene = ImageFile::new(pixels.clone()).cut_to_scene(Border::Auto).unwrap();
        assert!(scene.area().is_some_and(SceneArea::has_outline));
        assert!(ImageFile::new(pixels).cut_to_scene(Border::None).unwrap().area().is_none());
        let white = Image::<u8>::from_raw(2, 3, vec![255; 18]).unwrap();
        scene.pixels = Pixels::Bytes(Layers { image: white, alpha });
        let joined = scene.joined().pixels.into_bytes().into_raw();
        assert_eq!(joined[6..9], [6, 7, 8]);
        assert!(joined[..6].iter().chain(&joined[9..]).all(|&byte| byte == 255));
    }
}
