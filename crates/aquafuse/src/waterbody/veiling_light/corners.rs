//! The corners of an image, where open water is looked for when nothing far has its colour.

use super::histogram::Histogram;
use super::hue::is_bluish_green;
use crate::image::{ImageRef, TopEdge};

/// Side of a corner as a share of the image's side.
const CORNER_SHARE: f64 = 0.20;

/// Bluish-green colours of the two corners, 20 % x 20 % of the image each, at the edge that is up.
pub(super) fn corners(image: ImageRef<'_, u8>, edge: TopEdge) -> Histogram {
    let inside = in_corners(image.size(), edge);
    let mut histogram = Histogram::default();
    for (y, row) in image.rows().enumerate() {
        for (x, pixel) in row.iter().enumerate() {
            if inside(x, y) && is_bluish_green(pixel) {
                histogram.add(pixel);
            }
        }
    }
    histogram
}

/// Whether a column and row of an image of this size lie in one of the two corners at this edge.
pub(super) fn in_corners((width, height): (usize, usize), edge: TopEdge) -> impl Fn(usize, usize) -> bool {
    let side = |length: usize| (length as f64 * CORNER_SHARE).ceil() as usize;
    let (columns, rows) = (side(width), side(height));
    move |x, y| {
        let (at_left, at_right) = (x < columns, x >= width - columns);
        let (at_first, at_last) = (y < rows, y >= height - rows);
        match edge {
            TopEdge::First => at_first && (at_left || at_right),
            TopEdge::Last => at_last && (at_left || at_right),
            TopEdge::Left => at_left && (at_first || at_last),
            TopEdge::Right => at_right && (at_first || at_last),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Image;

    #[test]
    fn orientation_moves_the_corners_that_count_as_top() {
        let colour = |x: usize| if x < 8 { [10, 100, 150] } else { [200, 250, 10] };
        let samples = (0..40).flat_map(|_| (0..40).flat_map(colour)).collect();
        let image = Image::from_raw(40, 40, samples).unwrap();
        let up_left = corners(image.view(), TopEdge::from_exif(6));
        let up_right = corners(image.view(), TopEdge::from_exif(8));
        assert_eq!((up_left.count, up_right.count), (128, 0));
        assert_eq!(corners(image.view(), TopEdge::from_exif(1)).count, 64);
    }
}
