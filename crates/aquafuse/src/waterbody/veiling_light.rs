//! The colour of the water at infinity, read off the farthest pixels.

use std::marker::PhantomData;

use super::open_water;
use crate::depth::LEVELS;
use crate::image::{Encoded, Encoding, Image, Sample};

/// Veiling light B∞: the colour that remains when nothing but water is in sight, per channel in `[0, 1]`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(transparent, bound = ""))]
pub struct VeilingLight<E: Encoding = Encoded> {
    rgb: [f32; 3],
    #[cfg_attr(feature = "serde", serde(skip))]
    encoding: PhantomData<E>,
}

impl<E: Encoding> VeilingLight<E> {
    /// Veiling light of this colour; values outside `[0, 1]` are clipped, a NaN becomes 0.
    pub fn new(rgb: [f32; 3]) -> Self {
        Self { rgb: rgb.map(f32::from_unit), encoding: PhantomData }
    }

    /// Red, green and blue in `[0, 1]`.
    pub fn rgb(&self) -> [f32; 3] {
        self.rgb
    }
}

/// The stored edge of a picture that is up as seen.
///
/// Pixels stay in stored order, so for a camera held on its side "the top corners" are not the first
/// rows. The EXIF orientation tag tells which edge it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TopEdge {
    /// Row 0 is up: orientation 1 and 2, or none given.
    #[default]
    First,
    /// The last row is up: orientation 3 and 4.
    Last,
    /// Column 0 is up: orientation 5 and 6.
    Left,
    /// The last column is up: orientation 7 and 8.
    Right,
}

impl TopEdge {
    /// The edge that an EXIF orientation tag (1 to 8) puts on top; unknown values count as 1.
    pub fn from_exif(orientation: u8) -> Self {
        match orientation {
            3 | 4 => Self::Last,
            5 | 6 => Self::Left,
            7 | 8 => Self::Right,
            _ => Self::First,
        }
    }

    fn opposite(self) -> Self {
        match self {
            Self::First => Self::Last,
            Self::Last => Self::First,
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
    }
}

/// Where the veiling light was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(rename_all = "snake_case"))]
pub enum VeilingLightSource {
    /// Smooth open water of one colour.
    OpenWater,
    /// The farthest bluish-green pixels: the paper's way.
    Farthest,
    /// Too few of those: the bluish-green pixels of the two top corners.
    TopCorners,
    /// Too few there as well: those of the two bottom corners.
    BottomCorners,
    /// None of these: the farthest pixels whatever their colour.
    Unfiltered,
}

/// Share of the picture the paper takes from the far end. Less follows noise, more reaches objects.
const FARTHEST_SHARE: f64 = 0.05;
/// With no more usable pixels than this the paper no longer trusts the far end.
const FEW_PIXELS: u64 = 100;
/// Side of a corner as a share of the picture's side.
const CORNER_SHARE: f64 = 0.20;

pub(super) struct Found<E: Encoding> {
    pub(super) veiling_light: VeilingLight<E>,
    pub(super) source: VeilingLightSource,
    pub(super) share: f32,
}

/// Which way to the veiling light is tried first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum VeilingLightMethod {
    /// The commonest colour of smooth bluish-green places; where there are few, the published way.
    #[default]
    OpenWater,
    /// The paper's: the median of the farthest 5 %, with its fallbacks.
    Published,
}

/// The veiling light by this method, with all its fallbacks.
pub(super) fn estimate<E: Encoding>(
    image: &Image<u8>,
    levels: &[u8],
    top: TopEdge,
    method: VeilingLightMethod,
) -> Found<E> {
    let open_water = match method {
        VeilingLightMethod::OpenWater => open_water::find(image, levels),
        VeilingLightMethod::Published => None,
    };
    match open_water {
        Some((veiling_light, share)) => {
            Found { veiling_light, source: VeilingLightSource::OpenWater, share: share as f32 }
        }
        None => published(image, levels, top),
    }
}

/// Median of the farthest bluish-green pixels, with the paper's fallbacks in its order.
fn published<E: Encoding>(image: &Image<u8>, levels: &[u8], top: TopEdge) -> Found<E> {
    use VeilingLightSource::{BottomCorners, Farthest, TopCorners, Unfiltered};
    let pixels = image.pixels();
    let attempts: [(VeilingLightSource, &dyn Fn() -> Histogram); 3] = [
        (Farthest, &|| farthest(pixels, levels, is_bluish_green)),
        (TopCorners, &|| corners(image, top)),
        (BottomCorners, &|| corners(image, top.opposite())),
    ];
    let usable = attempts.into_iter().find_map(|(source, read)| {
        let histogram = read();
        (histogram.count > FEW_PIXELS).then_some((source, histogram))
    });
    let (source, histogram) = usable.unwrap_or_else(|| (Unfiltered, farthest(pixels, levels, |_| true)));
    Found {
        veiling_light: VeilingLight::new(histogram.median().map(E::from_encoded)),
        source,
        share: (histogram.count as f64 / pixels.len() as f64) as f32,
    }
}

/// Whether a colour can be open water, by its green and blue alone.
///
/// The paper filters "non-background colors within the bluish-green range, ignoring the red channel" and
/// gives no rule. Ours: not black (the larger of the two is at least 1/16: below is night or shadow, not
/// water), not blown out (the smaller is below 15/16: lamps, white boards, the sun), and neither channel
/// under 1/8 of the other (purer green or blue is paint or a plant; water of one hue still scatters both).
pub(super) fn is_bluish_green(&[_, green, blue]: &[u8; 3]) -> bool {
    let (low, high) = (green.min(blue), green.max(blue));
    high >= 16 && low < 240 && low >= high / 8
}

/// Colours of whole depth levels from the far end until 5 % of the picture's pixels are in.
///
/// It stops at the median depth: what is nearer than half of the picture is not far, whatever its colour,
/// and a bluish fish must not pass for the water. (Without the stop the corners could never be reached:
/// they hold no pixel that the far end would not have taken first.)
fn farthest(pixels: &[[u8; 3]], levels: &[u8], keep: impl Fn(&[u8; 3]) -> bool) -> Histogram {
    let mut all = [0_u64; LEVELS];
    let mut kept = [0_u64; LEVELS];
    for (pixel, &level) in pixels.iter().zip(levels) {
        all[usize::from(level)] += 1;
        kept[usize::from(level)] += u64::from(keep(pixel));
    }
    let total = pixels.len() as f64;
    let (mut passed, mut taken) = (0, 0);
    let nearest_taken = (0..LEVELS).rev().find(|&level| {
        passed += all[level];
        taken += kept[level];
        taken as f64 >= FARTHEST_SHARE * total || passed as f64 >= 0.5 * total
    });
    let nearest_taken = nearest_taken.unwrap_or(0);
    let mut histogram = Histogram::default();
    for (pixel, &level) in pixels.iter().zip(levels) {
        if usize::from(level) >= nearest_taken && keep(pixel) {
            histogram.add(pixel);
        }
    }
    histogram
}

/// Bluish-green colours of the two corners, 20 % x 20 % of the picture each, at the edge that is up.
fn corners(image: &Image<u8>, edge: TopEdge) -> Histogram {
    let (width, height) = image.size();
    let side = |length: usize| (length as f64 * CORNER_SHARE).ceil() as usize;
    let (columns, rows) = (side(width), side(height));
    let at_left = |x: usize| x < columns;
    let at_right = |x: usize| x >= width - columns;
    let at_first = |y: usize| y < rows;
    let at_last = |y: usize| y >= height - rows;
    let mut histogram = Histogram::default();
    for (y, row) in image.rows().enumerate() {
        for (x, pixel) in row.iter().enumerate() {
            let inside = match edge {
                TopEdge::First => at_first(y) && (at_left(x) || at_right(x)),
                TopEdge::Last => at_last(y) && (at_left(x) || at_right(x)),
                TopEdge::Left => at_left(x) && (at_first(y) || at_last(y)),
                TopEdge::Right => at_right(x) && (at_first(y) || at_last(y)),
            };
            if inside && is_bluish_green(pixel) {
                histogram.add(pixel);
            }
        }
    }
    histogram
}

/// Counts of each byte per channel: an exact median without sorting.
struct Histogram {
    count: u64,
    bins: [[u64; 256]; 3],
}

impl Default for Histogram {
    fn default() -> Self {
        Self { count: 0, bins: [[0; 256]; 3] }
    }
}

impl Histogram {
    fn add(&mut self, pixel: &[u8; 3]) {
        self.count += 1;
        for (bins, &value) in self.bins.iter_mut().zip(pixel) {
            bins[usize::from(value)] += 1;
        }
    }

    /// Encoded per-channel median in `[0, 1]`; of an even number, the mean of the middle two.
    fn median(&self) -> [f32; 3] {
        let at = |bins: &[u64; 256], rank: u64| {
            let mut seen = 0;
            let value = bins.iter().position(|count| {
                seen += count;
                seen > rank
            });
            value.unwrap_or(0) as f32
        };
        let (low, high) = (self.count.saturating_sub(1) / 2, self.count / 2);
        self.bins.each_ref().map(|bins| (at(bins, low) + at(bins, high)) / 510.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WATER: [u8; 3] = [10, 100, 150];
    const PAINT: [u8; 3] = [200, 250, 10];

    /// A 40 x 40 picture painted by place, with depth by place.
    fn paint(
        colour: impl Fn(usize, usize) -> [u8; 3],
        z: impl Fn(usize, usize) -> u8,
    ) -> (Image<u8>, Vec<u8>) {
        let places = || (0..40).flat_map(|y| (0..40).map(move |x| (x, y)));
        let samples = places().flat_map(|(x, y)| colour(x, y)).collect();
        let levels = places().map(|(x, y)| z(x, y)).collect();
        (Image::from_raw(40, 40, samples).unwrap(), levels)
    }

    fn bytes(found: &Found<Encoded>) -> [f32; 3] {
        found.veiling_light.rgb().map(|v| v * 255.0)
    }

    #[test]
    fn the_farthest_five_percent_are_read() {
        let (image, levels) =
            paint(|_, y| if y < 3 { [9, 99, 149] } else { WATER }, |_, y| if y < 3 { 200 } else { 50 });
        let found = published::<Encoded>(&image, &levels, TopEdge::First);
        assert_eq!(found.source, VeilingLightSource::Farthest);
        assert!((found.share - 0.075).abs() < 1e-6);
        assert!(bytes(&found).iter().zip([9.0, 99.0, 149.0]).all(|(a, b)| (a - b).abs() < 1e-3));
    }

    #[test]
    fn a_hundred_pixels_are_not_enough() {
        // Two of forty rows are 5 % of the pixels, but only 80 of them.
        let (image, levels) = paint(|_, _| WATER, |_, y| if y < 2 { 200 } else { 50 });
        let found = published::<Encoded>(&image, &levels, TopEdge::First);
        assert_eq!(found.source, VeilingLightSource::TopCorners);
    }

    #[test]
    fn a_saturated_level_is_taken_whole_and_reported() {
        let (image, levels) = paint(|_, _| WATER, |_, y| if y < 30 { 255 } else { 10 });
        let found = published::<Encoded>(&image, &levels, TopEdge::First);
        assert!((found.share - 0.75).abs() < 1e-6);
    }

    #[test]
    fn paint_at_the_far_end_is_passed_over() {
        let (image, levels) =
            paint(|_, y| if y < 4 { PAINT } else { WATER }, |_, y| if y < 4 { 255 } else { 100 });
        let found = published::<Encoded>(&image, &levels, TopEdge::First);
        assert_eq!(found.source, VeilingLightSource::Farthest);
        assert!((bytes(&found)[2] - 150.0).abs() < 1e-3);
    }

    #[test]
    fn a_near_fish_of_the_waters_colour_is_not_the_water() {
        // The far half is paint, the near half water: too near to be read, but the near corners hold it.
        let half = |y: usize| y < 20;
        let (image, levels) =
            paint(|_, y| if half(y) { WATER } else { PAINT }, |_, y| if half(y) { 10 } else { 200 });
        let found = published::<Encoded>(&image, &levels, TopEdge::First);
        assert_eq!(found.source, VeilingLightSource::TopCorners);
        let found = published::<Encoded>(&image, &levels, TopEdge::Last);
        assert_eq!(found.source, VeilingLightSource::BottomCorners);
    }

    #[test]
    fn when_nothing_is_water_the_far_end_is_read_unfiltered() {
        let (image, levels) = paint(|x, _| if x > 36 { [9, 5, 9] } else { PAINT }, |x, _| x as u8);
        let found = published::<Encoded>(&image, &levels, TopEdge::First);
        assert_eq!(found.source, VeilingLightSource::Unfiltered);
        assert!((bytes(&found)[1] - 5.0).abs() < 1e-3);
    }

    #[test]
    fn orientation_moves_the_corners_that_count_as_top() {
        let (image, _) = paint(|x, _| if x < 8 { WATER } else { PAINT }, |_, _| 0);
        let up_left = corners(&image, TopEdge::from_exif(6));
        let up_right = corners(&image, TopEdge::from_exif(8));
        assert_eq!((up_left.count, up_right.count), (128, 0));
        assert_eq!(corners(&image, TopEdge::from_exif(1)).count, 64);
    }

    #[test]
    fn the_median_of_an_even_number_is_the_mean_of_the_middle_two() {
        let mut histogram = Histogram::default();
        histogram.add(&[0, 10, 20]);
        histogram.add(&[2, 20, 20]);
        let median = histogram.median().map(|v| v * 255.0);
        assert!((median[0] - 1.0).abs() < 1e-4 && (median[1] - 15.0).abs() < 1e-4);
    }
}
