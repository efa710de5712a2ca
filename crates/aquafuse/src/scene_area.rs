//! The part of an image that shows the scene: what a border, the round of a fish-eye or transparency leaves.
//!
//! Bars, padding and overlays are no water. They must not enter an estimate, and nothing may be painted on them. So a
//! caller cuts the scene out ([`SceneArea::cut`]), works on it as on any image, and puts it back
//! ([`SceneArea::put_back`]): what lies outside keeps every byte, and the scene comes out as it would without a
//! border.
//!
//! # Examples
//!
//! A grey gradient between two black bars:
//!
//! ```
//! use aquafuse::image::Image;
//! use aquafuse::scene_area::{Border, SceneArea};
//!
//! let row = |y: usize| if (8..40).contains(&y) { (100..148).collect() } else { vec![0_u8; 48] };
//! let samples = (0..48).flat_map(row).flat_map(|grey| [grey; 3]).collect();
//! let mut image = Image::<u8>::from_raw(48, 48, samples)?;
//!
//! let area = SceneArea::of(&image, Border::Auto)?;
//! assert_eq!(area.margins().to_string(), "8,0,8,0");
//! let scene = area.cut(&image);
//! assert_eq!(scene.size(), (48, 32));
//! area.put_back(&scene, &mut image)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod bars;
mod border;
mod mirror;
mod round;

use crate::image::{Encoding, Image, ImageError, ImageMut, ImageRef, Sample, check_same_size};

pub use border::{Border, BorderError, Margins};

/// Which pixels of an image show the scene: a rectangle, and within it all pixels or some.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneArea {
    image: (usize, usize),
    margins: Margins,
    /// Of each pixel within the margins, row by row, whether it shows the scene; `None`: all do.
    shown: Option<Vec<bool>>,
}

impl SceneArea {
    /// All pixels of an image of `size` columns and rows.
    #[must_use]
    pub fn whole(size: (usize, usize)) -> Self {
        Self { image: size, margins: Margins::default(), shown: None }
    }

    /// The pixels of an image that show the scene.
    ///
    /// With [`Border::Auto`] these are found: first the straight bars at its sides, then the circle of a fish-eye. A bar
    /// has one colour, of which text may cover a part, and ends at a straight edge. Flat open water at the side of
    /// an image ends at no such edge. A mirrored image has the mirrored border, and so has a turned one.
    ///
    /// # Errors
    ///
    /// [`BorderError`] when a given border leaves no pixel.
    pub fn of<'a, T: Sample, E: Encoding>(
        image: impl Into<ImageRef<'a, T, E>>,
        border: Border,
    ) -> Result<Self, BorderError> {
        let image = image.into();
        match border {
            Border::None => Ok(Self::whole(image.size())),
            Border::Given(margins) => match margins.leave(image.size()) {
                Some(_) => Ok(Self { margins, ..Self::whole(image.size()) }),
                None => Err(BorderError::NothingLeft { margins, image: image.size() }),
            },
            Border::Auto => {
                let area = Self { margins: bars::find(image), ..Self::whole(image.size()) };
                Ok(match round::find(image, area.margins) {
                    Some(circle) => area.only(|x, y| circle.contains(x, y)),
                    None => area,
                })
            }
        }
    }

    /// Those of its pixels, at column and row of the image, that `shows` is true of. Where it is true of none, all stay.
    #[must_use]
    pub fn only(self, shows: impl Fn(usize, usize) -> bool) -> Self {
        let (width, height) = self.size();
        let Margins { top, left, .. } = self.margins;
        let is_shown = |x: usize, y: usize| self.shown.as_ref().is_none_or(|shown| shown[y * width + x]);
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let shown: Vec<bool> = places.map(|(x, y)| is_shown(x, y) && shows(left + x, top + y)).collect();
        if shown.iter().all(|&shown| shown) || !shown.contains(&true) {
            return self;
        }
        self.tightened(&shown)
    }

    /// The same within the smallest rectangle that holds what is `shown`, of which there is something.
    fn tightened(self, shown: &[bool]) -> Self {
        let (width, height) = self.size();
        let rows: Vec<bool> = shown.chunks(width).map(|row| row.contains(&true)).collect();
        let columns: Vec<bool> =
            (0..width).map(|x| shown.iter().skip(x).step_by(width).any(|&s| s)).collect();
        let [(above, below), (before, behind)] = [&rows, &columns].map(|shown| {
            let first = shown.iter().take_while(|&&shown| !shown).count();
            (first, shown.iter().rev().take_while(|&&shown| !shown).count())
        });
        let kept = shown[above * width..(height - below) * width]
            .chunks(width)
            .flat_map(|row| row[before..width - behind].iter().copied())
            .collect::<Vec<_>>();
        let Margins { top, right, bottom, left } = self.margins;
        let margins =
            Margins { top: top + above, right: right + behind, bottom: bottom + below, left: left + before };
        Self { margins, shown: kept.contains(&false).then_some(kept), ..self }
    }

    /// Whether every pixel of the image shows the scene.
    pub fn is_whole(&self) -> bool {
        self.margins == Margins::default() && self.shown.is_none()
    }

    /// The rows and columns at the sides of the image that show nothing of the scene.
    pub fn margins(&self) -> Margins {
        self.margins
    }

    /// Columns and rows of the image.
    pub fn image_size(&self) -> (usize, usize) {
        self.image
    }

    /// Columns and rows within the margins.
    pub fn size(&self) -> (usize, usize) {
        self.margins.leave(self.image).expect("an area has pixels")
    }

    /// Whether the pixel at column `x`, row `y` of the image shows the scene.
    pub fn contains(&self, x: usize, y: usize) -> bool {
        let (width, height) = self.size();
        let Margins { top, left, .. } = self.margins;
        (left..left + width).contains(&x)
            && (top..top + height).contains(&y)
            && self.shown.as_ref().is_none_or(|shown| shown[(y - top) * width + x - left])
    }

    /// How much of the image shows the scene, in `(0, 1]`.
    pub fn share(&self) -> f64 {
        let (width, height) = self.size();
        let shown = match &self.shown {
            Some(shown) => shown.iter().filter(|&&shown| shown).count(),
            None => width * height,
        };
        shown as f64 / (self.image.0 * self.image.1) as f64
    }

    /// Whether pixels within the margins are left out: those around the circle of a fish-eye, or transparent ones.
    pub fn has_outline(&self) -> bool {
        self.shown.is_some()
    }

    /// The scene as an image of its own. Pixels within the margins that do not show it are filled: there the scene is
    /// mirrored at its outline, so that estimates and filters read scene alone.
    ///
    /// # Panics
    ///
    /// When the image has another size than the area.
    #[must_use]
    pub fn cut<'a, T: Sample, E: Encoding>(&self, image: impl Into<ImageRef<'a, T, E>>) -> Image<T, E> {
        let image = image.into();
        assert_eq!(image.size(), self.image, "the area is that of another image");
        let pixels = self.cut_values(image.pixels().copied());
        let (width, height) = self.size();
        let mut scene =
            Image::from_raw(width, height, pixels.into_flattened()).expect("as many as there are");
        if let Some(shown) = &self.shown {
            mirror::fill(&mut scene, shown);
        }
        scene
    }

    /// What lies within the margins, of one value for each pixel of the image, row by row.
    #[must_use]
    pub fn cut_values<V>(&self, values: impl IntoIterator<Item = V>) -> Vec<V> {
        let (across, _) = self.image;
        let (width, height) = self.size();
        let Margins { top, left, .. } = self.margins;
        let inside = |i: usize| (left..left + width).contains(&(i % across));
        let rows = values.into_iter().enumerate().skip(top * across).take(height * across);
        rows.filter(|&(i, _)| inside(i)).map(|(_, value)| value).collect()
    }

    /// One value for each pixel of the image: `values` within the margins, row by row, and `outside` where the scene is
    /// not shown.
    ///
    /// # Panics
    ///
    /// When there are not as many values as pixels within the margins.
    #[must_use]
    pub fn spread<V: Clone>(&self, values: &[V], outside: &V) -> Vec<V> {
        let (width, height) = self.size();
        assert_eq!(values.len(), width * height, "one value for each pixel within the margins");
        let mut all = vec![outside.clone(); self.image.0 * self.image.1];
        self.each_run(|from, to| all[to.clone()].clone_from_slice(&values[from]));
        all
    }

    /// Writes `scene` back into the image it was cut from; pixels that do not show the scene keep what they are.
    ///
    /// # Errors
    ///
    /// [`ImageError`] when one of the two has another size than this area; `image` is then unchanged.
    pub fn put_back<'a, 'b, T: Sample, E: Encoding>(
        &self,
        scene: impl Into<ImageRef<'a, T, E>>,
        image: impl Into<ImageMut<'b, T, E>>,
    ) -> Result<(), ImageError> {
        let (scene, mut image) = (scene.into(), image.into());
        check_same_size(scene.size(), self.size())?;
        check_same_size(image.size(), self.image)?;
        let ((width, _), (across, _)) = (self.size(), self.image);
        self.each_run(|from, to| {
            let (source, target) = (scene.row(from.start / width), image.row_mut(to.start / across));
            let (x, left) = (from.start % width, to.start % across);
            target[left..left + to.len()].copy_from_slice(&source[x..x + from.len()]);
        });
        Ok(())
    }

    /// The runs of pixels in a row that show the scene: where each lies within the margins, and where in the image.
    fn each_run(&self, mut run: impl FnMut(std::ops::Range<usize>, std::ops::Range<usize>)) {
        let (width, height) = self.size();
        let Margins { top, left, .. } = self.margins;
        let mut at = |y: usize, from: usize, to: usize| {
            let start = (top + y) * self.image.0 + left;
            run(y * width + from..y * width + to, start + from..start + to);
        };
        for y in 0..height {
            match &self.shown {
                None => at(y, 0, width),
                Some(shown) => {
                    let mut x = 0;
                    for same in shown[y * width..][..width].chunk_by(|a, b| a == b) {
                        if same[0] {
                            at(y, x, x + same.len());
                        }
                        x += same.len();
                    }
                }
            }
        }
    }
}

/// So many places of a line are as good as all.
const ENOUGH: usize = 256;

/// Places of a line of so many pixels: all of a short one, an even part of a long one. They are their own mirror image.
fn places(length: usize) -> Vec<usize> {
    let step = length.div_ceil(ENOUGH);
    let half = (0..length.div_ceil(2)).step_by(step);
    let mut places: Vec<usize> = half.flat_map(|i| [i, length - 1 - i]).collect();
    places.sort_unstable();
    places.dedup();
    places
}

#[cfg(test)]
mod tests;
