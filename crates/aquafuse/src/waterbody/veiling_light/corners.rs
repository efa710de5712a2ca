//! The corners of a picture, where open water is looked for when nothing far has its colour.

use super::histogram::Histogram;
use super::hue::is_bluish_green;
use crate::image::Image;

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

    pub(super) fn opposite(self) -> Self {
        match self {
            Self::First => Self::Last,
            Self::Last => Self::First,
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
    }
}

/// Side of a corner as a share of the picture's side.
const CORNER_SHARE: f64 = 0.20;

/// Bluish-green colours of the two corners, 20 % x 20 % of the picture each, at the edge that is up.
pub(super) fn corners(image: &Image<u8>, edge: TopEdge) -> Histogram {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orientation_moves_the_corners_that_count_as_top() {
        let colour = |x: usize| if x < 8 { [10, 100, 150] } else { [200, 250, 10] };
        let samples = (0..40).flat_map(|_| (0..40).flat_map(colour)).collect();
        let image = Image::from_raw(40, 40, samples).unwrap();
        let up_left = corners(&image, TopEdge::from_exif(6));
        let up_right = corners(&image, TopEdge::from_exif(8));
        assert_eq!((up_left.count, up_right.count), (128, 0));
        assert_eq!(corners(&image, TopEdge::from_exif(1)).count, 64);
    }
}
