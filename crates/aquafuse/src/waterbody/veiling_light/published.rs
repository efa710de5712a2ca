//! The paper's way: the median of the farthest pixels, with fallbacks.

use super::corners::corners;
use super::histogram::Histogram;
use super::hue::is_bluish_green;
use super::places::Places;
use super::reading::{ROUNDING, Reading, VeilingLightSource};
use crate::depth::LEVELS;
use crate::image::TopEdge;
use crate::waterbody::Seen;

/// Share of the image the paper takes from the far end. Less follows noise, more reaches objects.
const FARTHEST_SHARE: f64 = 0.05;
/// With no more usable pixels than this the paper no longer trusts the far end.
const FEW_PIXELS: u64 = 100;

/// Quantile that stands for the darkest of the farthest things.
const DARK: f64 = 0.05;

/// Median of the farthest bluish-green pixels, with the paper's fallbacks in its order.
pub(super) fn read(seen: Seen<'_>, top: TopEdge) -> Reading {
    use VeilingLightSource::{BottomCorners, Farthest, TopCorners, Unfiltered};
    let far = |of_any_colour| {
        let (nearest, histogram) = farthest(seen, |pixel| of_any_colour || is_bluish_green(pixel));
        (Places::Far { nearest, of_any_colour }, histogram)
    };
    let at = |edge| (Places::Corners(edge), corners(seen.image, edge));
    let attempts = [(Farthest, None), (TopCorners, Some(top)), (BottomCorners, Some(top.opposite()))];
    let usable = attempts.into_iter().find_map(|(source, edge)| {
        let (places, histogram) = edge.map_or_else(|| far(false), at);
        (histogram.count > FEW_PIXELS).then_some((source, places, histogram))
    });
    let (source, places, histogram) = usable.unwrap_or_else(|| {
        let (places, histogram) = far(true);
        (Unfiltered, places, histogram)
    });
    reading(histogram.median(), source, &histogram, places, seen)
}

/// The same where open water was looked for and not found, and depth is measured: what is farthest is then a thing, of any colour,
/// brighter than the water by its own light. Halfway from its darkest to its median is nearer to the water.
pub(in crate::waterbody) fn read_things(seen: Seen<'_>) -> Reading {
    let (nearest, histogram) = farthest(seen, |_| true);
    let (dark, median) = (histogram.quantile(DARK), histogram.median());
    let rgb = std::array::from_fn(|c| 0.5 * (dark[c] + median[c]));
    let places = Places::Far { nearest, of_any_colour: true };
    reading(rgb, VeilingLightSource::Unfiltered, &histogram, places, seen)
}

fn reading(
    rgb: [f32; 3],
    source: VeilingLightSource,
    histogram: &Histogram,
    places: Places,
    seen: Seen<'_>,
) -> Reading {
    Reading {
        rgb,
        source,
        share: histogram.count as f64 / seen.count() as f64,
        places,
        standard_error: [0.0; 3],
        seen: None,
        level: None,
        noise: ROUNDING,
    }
}

/// Colours of whole depth levels from the far end until 5 % of the image's pixels are in, and the nearest of
/// these levels.
///
/// It stops at the median depth: what is nearer than half of the image is not far, whatever its colour,
/// and a bluish fish must not pass for the water. (Without the stop the corners could never be reached:
/// they hold no pixel that the far end would not have taken first.)
fn farthest(seen: Seen<'_>, keep: impl Fn(&[u8; 3]) -> bool) -> (u8, Histogram) {
    let mut all = [0_u64; LEVELS];
    let mut kept = [0_u64; LEVELS];
    for (pixel, level) in seen.pixels() {
        all[usize::from(level)] += 1;
        kept[usize::from(level)] += u64::from(keep(pixel));
    }
    let total = seen.count() as f64;
    let (mut passed, mut taken) = (0, 0);
    let nearest_taken = (0..LEVELS).rev().find(|&level| {
        passed += all[level];
        taken += kept[level];
        taken as f64 >= FARTHEST_SHARE * total || passed as f64 >= 0.5 * total
    });
    let nearest_taken = nearest_taken.unwrap_or(0);
    let mut histogram = Histogram::default();
    for (pixel, level) in seen.pixels() {
        if usize::from(level) >= nearest_taken && keep(pixel) {
            histogram.add(pixel);
        }
    }
    (nearest_taken as u8, histogram)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Image;

    const WATER: [u8; 3] = [10, 100, 150];
    const PAINT: [u8; 3] = [200, 250, 10];

    /// A 40 x 40 image painted by place, with depth by place.
    fn paint(
        colour: impl Fn(usize, usize) -> [u8; 3],
        z: impl Fn(usize, usize) -> u8,
    ) -> (Image<u8>, Vec<u8>) {
        let places = || (0..40).flat_map(|y| (0..40).map(move |x| (x, y)));
        let samples = places().flat_map(|(x, y)| colour(x, y)).collect();
        let levels = places().map(|(x, y)| z(x, y)).collect();
        (Image::from_raw(40, 40, samples).unwrap(), levels)
    }

    fn bytes(found: &Reading) -> [f32; 3] {
        found.rgb.map(|v| v * 255.0)
    }

    #[test]
    fn the_farthest_five_percent_are_read() {
        let (image, levels) =
            paint(|_, y| if y < 3 { [9, 99, 149] } else { WATER }, |_, y| if y < 3 { 200 } else { 50 });
        let found = read(Seen::whole(image.view(), &levels), TopEdge::First);
        assert_eq!(found.source, VeilingLightSource::Farthest);
        assert!((found.share - 0.075).abs() < 1e-6);
        assert!(bytes(&found).iter().zip([9.0, 99.0, 149.0]).all(|(a, b)| (a - b).abs() < 1e-3));
    }

    #[test]
    fn a_hundred_pixels_are_not_enough() {
        // Two of forty rows are 5 % of the pixels, but only 80 of them.
        let (image, levels) = paint(|_, _| WATER, |_, y| if y < 2 { 200 } else { 50 });
        let found = read(Seen::whole(image.view(), &levels), TopEdge::First);
        assert_eq!(found.source, VeilingLightSource::TopCorners);
    }

    #[test]
    fn a_saturated_level_is_taken_whole_and_reported() {
        let (image, levels) = paint(|_, _| WATER, |_, y| if y < 30 { 255 } else { 10 });
        let found = read(Seen::whole(image.view(), &levels), TopEdge::First);
        assert!((found.share - 0.75).abs() < 1e-6);
    }

    #[test]
    fn paint_at_the_far_end_is_passed_over() {
        let (image, levels) =
            paint(|_, y| if y < 4 { PAINT } else { WATER }, |_, y| if y < 4 { 255 } else { 100 });
        let found = read(Seen::whole(image.view(), &levels), TopEdge::First);
        assert_eq!(found.source, VeilingLightSource::Farthest);
        assert!((bytes(&found)[2] - 150.0).abs() < 1e-3);
    }

    #[test]
    fn a_near_fish_of_the_waters_colour_is_not_the_water() {
        // The far half is paint, the near half water: too near to be read, but the near corners hold it.
        let half = |y: usize| y < 20;
        let (image, levels) =
            paint(|_, y| if half(y) { WATER } else { PAINT }, |_, y| if half(y) { 10 } else { 200 });
        let found = read(Seen::whole(image.view(), &levels), TopEdge::First);
        assert_eq!(found.source, VeilingLightSource::TopCorners);
        let found = read(Seen::whole(image.view(), &levels), TopEdge::Last);
        assert_eq!(found.source, VeilingLightSource::BottomCorners);
    }

    #[test]
    fn when_nothing_is_water_the_far_end_is_read_unfiltered() {
        let (image, levels) = paint(|x, _| if x > 36 { [9, 5, 9] } else { PAINT }, |x, _| x as u8);
        let found = read(Seen::whole(image.view(), &levels), TopEdge::First);
        assert_eq!(found.source, VeilingLightSource::Unfiltered);
        assert!((bytes(&found)[1] - 5.0).abs() < 1e-3);
    }

    #[test]
    fn measured_depth_says_what_is_farthest_whatever_its_colour() {
        let (image, levels) =
            paint(|_, y| if y < 4 { PAINT } else { WATER }, |_, y| if y < 4 { 255 } else { 100 });
        let found = read_things(Seen::whole(image.view(), &levels));
        assert_eq!(found.source, VeilingLightSource::Unfiltered);
        assert!(bytes(&found).iter().zip(PAINT).all(|(a, b)| (a - f32::from(b)).abs() < 1e-3));
    }
}
