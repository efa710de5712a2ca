//! The far region as a network sees it.

use super::{Region, colour_of, far_colour, median};
use crate::image::{ImageRef, TopEdge};
use crate::network::Sight;
use crate::waterbody::cells::Cells;

/// Share of the image that the region is.
const SHARE: f32 = 0.1;
/// What the surest places hold of water where open water is as likely in view as not, and how fast likelihood grows with it.
const EVEN: f32 = 0.7;
const STEEP: f32 = 12.0;

impl Region {
    /// The region of the image in cells, by a network.
    pub(in crate::waterbody) fn by_network(cells: Cells, image: ImageRef<'_, u8>, top: TopEdge) -> Self {
        let sight = Sight::of(image, top);
        let logits = sight.logits_between(cells.grid().columns(), cells.grid().rows());
        let (inside, read, colour) = far_colour(&cells, &logits, SHARE);
        let typical = median(inside.iter().map(|&cell| logits[cell]).collect());
        let seen = (1.0 + (-STEEP * (sight.surest() - EVEN)).exp()).recip();
        let middle = colour_of(&inside, &cells);
        Self { cells, evidence: logits.clone(), logits: Some(logits), typical, colour, read, middle, inside, seen }
    }
}
