//! The depth models: from colour to depth.

use std::borrow::Cow;
use std::sync::OnceLock;

use super::map::Buffers;

#[cfg(feature = "network")]
use super::network;
use super::tables::{Square, Tables};
use super::{DARK, DepthMap, Eq3, layout, median, refine};
use crate::image::{ImageRef, Sample, TopEdge};

/// A depth model: from colour to relative depth.
///
/// All read **encoded** values and give z in `[0, 1]`, 0 near, and fail where red is dead:
/// everything then looks far. All but `Layout` and `Network` read `R` and `M = max(G, B)` of one pixel, and never rise with R
/// nor fall with M; those two read the whole image, and no such law holds for a pixel of it.
///
/// | model | depth | use it |
/// |---|---|---|
/// | [`Eq3`](Self::Eq3) | two exponentials | the paper's, refined by the image: the default |
/// | [`Eq3Median`](Self::Eq3Median) | the same | as published, with its 7x7 median |
/// | [`Ratio`](Self::Ratio) | logarithm of M / R: illumination cancels | in turbid water, and on red things near by |
/// | [`Ulap`](Self::Ulap) | a line | to compare with |
/// | [`UDepth`](Self::UDepth) | a line | to compare with |
/// | [`Layout`](Self::Layout) | height in the image, corrected by colour | only where the camera looked ahead and was held level |
/// | `Network`, with the feature `network` | the mean order of Eq. 3 and of a tiny network of our own, which looks at the whole image | where colour alone says little: red is dead, or things differ in colour |
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum DepthModel {
    /// Eq. 3 of the AquaFuse paper.
    Eq3(Eq3),
    /// Eq. 3 with our coefficients and the paper's 7x7 median in place of the refinement by the image; 256 levels.
    Eq3Median,
    /// `max(0, ln((M + e) / (R + e)) / ln((1 + e) / e))` with e = .02, as a difference of whole levels.
    Ratio,
    /// `0.53214829 + 0.51309827 M - 0.91066194 R`, the underwater light attenuation prior (Song et al. 2018).
    Ulap,
    /// `1 - (0.46353632 + 0.49598983 R - 0.38875134 M)`: the line of UDepth (Yu et al. 2022), whose larger
    /// values are nearer, inverted.
    UDepth,
    /// `1.3 n(l) + n(c) + 2 n(y)`, stretched from its 1st to its 99th percentile.
    ///
    /// `l` is the ratio before it is clipped at 0, `c` the likeness of a pixel's hue to the median colour of
    /// the top tenth of the image, both smoothed by a box of 1/16 of the width; `y` is 1 at the top and 0 at
    /// the bottom; `n` takes mean and deviation over the image away.
    ///
    /// **Wrong for a rolled camera and for one that looks down or up**: it takes for granted that what is
    /// higher in the image is farther. [`DepthModel::estimate_oriented`] takes the edge that is the top.
    Layout,
    /// `w + .8 (1 - w) (r + c) / 2`: r and c are the parts of all things that are nearer by the network of this crate and by Eq. 3,
    /// w the share of open water by the network.
    ///
    /// The network was trained on synthetic scenes alone and looks at shapes: [`Sight`](crate::network::Sight).
    #[cfg(feature = "network")]
    Network,
}

impl Default for DepthModel {
    fn default() -> Self {
        Self::Eq3(Eq3::OURS)
    }
}

impl DepthModel {
    /// All models with our coefficients, in the order of the table above.
    pub const ALL: &'static [Self] = &[
        Self::Eq3(Eq3::OURS),
        Self::Eq3Median,
        Self::Ratio,
        Self::Ulap,
        Self::UDepth,
        Self::Layout,
        #[cfg(feature = "network")]
        Self::Network,
    ];

    /// The name used on the command line and in reports; Eq. 3 with other coefficients than ours is `fitted`,
    /// which the command line calls by its file.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Eq3(eq3) if *eq3 == Eq3::OURS => "eq3",
            Self::Eq3(_) => "fitted",
            Self::Eq3Median => "eq3-median",
            Self::Ratio => "ratio",
            Self::Ulap => "ulap",
            Self::UDepth => "udepth",
            Self::Layout => "layout",
            #[cfg(feature = "network")]
            Self::Network => "network",
        }
    }

    /// Depth of an image whose first row is up: the model at each pixel, refined by the image
    /// (guided filter, He, Sun and Tang 2013, with colour as guide). `Eq3Median` takes the median instead.
    ///
    /// # Examples
    ///
    /// ```
    /// use aquafuse::{depth::DepthModel, image::Image};
    ///
    /// // Grey is at the camera for `Ratio`, whatever its brightness.
    /// let image = Image::<u8>::from_raw(2, 1, vec![30, 30, 30, 200, 200, 200])?;
    /// assert_eq!(DepthModel::Ratio.estimate(&image).distances(), [0.0, 0.0]);
    /// # Ok::<(), aquafuse::image::ImageError>(())
    /// ```
    #[must_use]
    pub fn estimate<'a, T: Sample>(&self, image: impl Into<ImageRef<'a, T>>) -> DepthMap {
        self.estimate_oriented(image, TopEdge::First)
    }

    /// Depth of an image whose edge `top` is up as seen. Only [`DepthModel::Layout`] asks which it is.
    ///
    /// # Examples
    ///
    /// ```
    /// use aquafuse::{depth::DepthModel, image::{Image, TopEdge}};
    ///
    /// // One colour shows nothing: what is left is height, here from the right to the left.
    /// let image = Image::<u8>::from_raw(64, 8, vec![90; 64 * 8 * 3])?;
    /// let z = DepthModel::Layout.estimate_oriented(&image, TopEdge::Right);
    /// assert!(z.at(60, 4) > 0.8 && z.at(3, 4) < 0.2);
    /// # Ok::<(), aquafuse::image::ImageError>(())
    /// ```
    #[must_use]
    pub fn estimate_oriented<'a, T: Sample>(
        &self,
        image: impl Into<ImageRef<'a, T>>,
        top: TopEdge,
    ) -> DepthMap {
        self.estimate_in(image.into(), top, Buffers::default())
    }

    /// [`DepthModel::estimate_oriented`] in the memory of another map.
    pub(crate) fn estimate_in<T: Sample>(
        &self,
        image: ImageRef<'_, T>,
        top: TopEdge,
        buffers: Buffers,
    ) -> DepthMap {
        let (width, height) = image.size();
        let depth = if T::FINE
            && let Some(tables) = self.tables()
        {
            let fill = |y, row: &mut [u16]| tables.fine_row(image.row(y), row);
            let levels = match self {
                Self::Eq3Median => median::filter(width, vec![0; width * height], fill),
                _ => refine::in_fine_levels(image, &refine::fit(image, fill)),
            };
            DepthMap::from_fine_levels(width, height, levels).expect("one level a pixel")
        } else if let Some(square) = self.square() {
            let fill = |y, row: &mut [u8]| square.row(image.row(y), row);
            match self {
                Self::Eq3Median => {
                    let mut levels = buffers.levels;
                    levels.resize(width * height, 0);
                    let levels = median::filter(width, levels, fill);
                    DepthMap::from_levels(width, height, levels).expect("one level a pixel")
                }
                _ => refine::in_steps(image, &refine::fit(image, fill), buffers),
            }
        } else {
            let levels = self.levels(image, top);
            let fill = |y, row: &mut [u8]| row.copy_from_slice(&levels[y * width..][..width]);
            refine::in_steps(image, &refine::fit(image, fill), buffers)
        };
        depth.made_by(*self)
    }

    /// Depth of an image whose first row is up, before it is refined.
    #[must_use]
    pub fn estimate_unfiltered<'a, T: Sample>(&self, image: impl Into<ImageRef<'a, T>>) -> DepthMap {
        let image = image.into();
        let (width, height) = image.size();
        let map = DepthMap::from_levels(width, height, self.levels(image, TopEdge::First));
        map.expect("one level a pixel").made_by(*self)
    }

    /// Relative depth of one encoded colour, in `[0, 1]`; none if the model is no function of one pixel.
    pub(crate) fn of_colours(&self) -> Option<impl Fn([f32; 3]) -> f32> {
        let tables = self.tables()?;
        Some(move |rgb: [f32; 3]| {
            let [r, g, b] = rgb.map(u8::from_unit);
            f32::from(tables.level(r, g.max(b))) / 255.0
        })
    }

    pub(super) fn levels<T: Sample>(&self, image: ImageRef<'_, T>, top: TopEdge) -> Vec<u8> {
        #[cfg(feature = "network")]
        if matches!(self, Self::Network) {
            return network::levels(image, top);
        }
        let Some(square) = self.square() else { return layout::levels(image, top) };
        let mut levels = vec![0; image.width() * image.height()];
        for (pixels, levels) in image.rows().zip(levels.chunks_exact_mut(image.width())) {
            square.row(pixels, levels);
        }
        levels
    }

    /// The level of every colour; that of our coefficients is made once.
    fn square(&self) -> Option<Cow<'static, Square>> {
        static OURS: OnceLock<Square> = OnceLock::new();
        if matches!(self, Self::Eq3Median) || *self == Self::default() {
            return Some(Cow::Borrowed(OURS.get_or_init(|| Eq3::OURS.tables().square())));
        }
        Some(Cow::Owned(self.tables()?.square()))
    }

    /// The model as tables; none if it is no function of one pixel.
    fn tables(&self) -> Option<Tables> {
        Some(match self {
            Self::Eq3(eq3) => eq3.tables(),
            Self::Eq3Median => Eq3::OURS.tables(),
            Self::Ratio => {
                let whole_range = ((1.0 + DARK) / DARK).ln();
                Tables::of_difference(|value| ((value + DARK) / DARK).ln() / whole_range)
            }
            Self::Ulap => Tables::of_terms(|red| 0.532_148_29 - 0.910_661_94 * red, |max| 0.513_098_27 * max),
            Self::UDepth => {
                Tables::of_terms(|red| 0.536_463_68 - 0.495_989_83 * red, |max| 0.388_751_34 * max)
            }
            Self::Layout => return None,
            #[cfg(feature = "network")]
            Self::Network => return None,
        })
    }
}

crate::names::named!(DepthModel, "depth model");

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Image, Kernels as _};
    use proptest::prelude::*;

    fn levels_of(model: DepthModel, pixels: &[[u8; 3]]) -> Vec<u8> {
        let image = Image::<u8>::from_raw(pixels.len(), 1, pixels.concat()).unwrap();
        model.levels(image.view(), TopEdge::First)
    }

    fn model() -> impl Strategy<Value = DepthModel> {
        let pixelwise = DepthModel::ALL.iter().copied().filter(|model| model.tables().is_some());
        prop::sample::select(pixelwise.collect::<Vec<_>>())
    }

    #[test]
    fn ratio_is_one_table_and_one_saturating_subtraction() {
        let table = |value: u8| {
            (255.0 * ((f64::from(value) / 255.0 + DARK) / DARK).ln() / ((1.0 + DARK) / DARK).ln()).round()
        };
        for (red, max) in [(0, 255), (255, 0), (0, 0), (10, 90), (90, 10), (77, 78)] {
            let expected = (table(max) - table(red)).max(0.0);
            assert_eq!(f64::from(levels_of(DepthModel::Ratio, &[[red, max, 0]])[0]), expected);
        }
    }

    #[test]
    fn the_lines_are_those_published() {
        let rounded = |depth: f64| (255.0 * depth.clamp(0.0, 1.0)).round();
        for (red, max) in [(0.0, 0.0), (0.2, 0.4), (0.4, 0.2), (0.8, 1.0)] {
            let pixel = [(255.0 * red) as u8, 0, (255.0 * max) as u8];
            let ulap = rounded(0.53214829 + 0.51309827 * max - 0.91066194 * red);
            let udepth = rounded(1.0 - (0.46353632 + 0.49598983 * red - 0.38875134 * max));
            assert_eq!(f64::from(levels_of(DepthModel::Ulap, &[pixel])[0]), ulap);
            assert_eq!(f64::from(levels_of(DepthModel::UDepth, &[pixel])[0]), udepth);
        }
    }

    proptest! {
        #[test]
        fn depth_never_rises_with_red(model in model(), r in 0..255_u8, g: u8, b: u8) {
            let levels = levels_of(model, &[[r, g, b], [r + 1, g, b]]);
            prop_assert!(levels[0] >= levels[1]);
        }

        #[test]
        fn depth_never_falls_with_green_or_blue(model in model(), r: u8, g in 0..255_u8, b in 0..255_u8) {
            let levels = levels_of(model, &[[r, g, b], [r, g + 1, b], [r, g, b + 1]]);
            prop_assert!(levels[0] <= levels[1] && levels[0] <= levels[2]);
        }

        #[test]
        fn fine_depth_is_that_of_bytes_and_rises_and_falls_as_it_does(model in model(), r: u8, m: u8, more: u16) {
            let tables = model.tables().unwrap();
            let (red, max) = (r.to_word(), m.to_word());
            prop_assert!(tables.fine(red, max).to_byte().abs_diff(tables.level(r, m)) <= 1);
            prop_assert!(tables.fine(red.saturating_add(more), max) <= tables.fine(red, max));
            prop_assert!(tables.fine(red, max.saturating_add(more)) >= tables.fine(red, max));
        }

        #[test]
        fn green_and_blue_are_interchangeable(model in model(), r: u8, g: u8, b: u8) {
            let levels = levels_of(model, &[[r, g, b], [r, b, g]]);
            prop_assert_eq!(levels[0], levels[1]);
        }
    }
}
