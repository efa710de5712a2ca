//! Which pixels a veiling light was read from, for whoever wants to see them.

use std::ops::Range;

use super::corners::in_corners;
use super::hue::is_bluish_green;
use crate::image::TopEdge;
use crate::waterbody::Seen;

/// Where a reading comes from, small enough to travel with it.
pub(in crate::waterbody) enum Places {
    /// These columns and rows.
    Cells(Vec<[Range<usize>; 2]>),
    /// Every pixel of this level of depth or a farther one; the bluish-green ones, or all.
    Far { nearest: u8, of_any_colour: bool },
    /// The bluish-green pixels of the two corners at this edge.
    Corners(TopEdge),
}

impl Places {
    /// Whether each pixel was read, row by row from the top.
    pub(in crate::waterbody) fn mask(&self, seen: Seen<'_>) -> Vec<bool> {
        let (width, height) = seen.image.size();
        match self {
            Self::Cells(cells) => {
                let mut mask = vec![false; width * height];
                for [columns, rows] in cells {
                    for y in rows.clone() {
                        mask[y * width + columns.start..y * width + columns.end].fill(true);
                    }
                }
                mask
            }
            Self::Far { nearest, of_any_colour } => {
                let read = |(pixel, level)| level >= *nearest && (*of_any_colour || is_bluish_green(pixel));
                seen.pixels().map(read).collect()
            }
            Self::Corners(edge) => {
                let inside = in_corners((width, height), *edge);
                let read = |(i, pixel)| inside(i % width, i / width) && is_bluish_green(pixel);
                seen.image.pixels().enumerate().map(read).collect()
            }
        }
    }
}
