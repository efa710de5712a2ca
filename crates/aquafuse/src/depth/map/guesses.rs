//! What is a guess in a depth map that was measured in part.

use std::ops::Range;

use super::{Quantised, quantise};
use crate::scene_area::{Margins, SceneArea};

/// Where z is a guess, and what is counted instead.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Guesses {
    /// Beyond this distance z is a guess.
    beyond: f32,
    /// Columns and rows of cells over the map.
    cells: [usize; 2],
    /// How much of each cell is taken for open water, in `[0, 1]`; 0 where it was measured.
    water: Vec<f32>,
    /// Levels of z before what was measured was carried into holes: between a thing and open water nothing lies at that z, and
    /// estimators would count it.
    levels: Vec<u8>,
    step: f32,
}

/// Shares of open water by cells, row by row.
pub(in crate::depth) struct Water {
    pub(in crate::depth) cells: [usize; 2],
    pub(in crate::depth) shares: Vec<f32>,
}

impl Guesses {
    /// Guesses beyond this distance, by how much of the map is taken for open water; `counted` are its distances with holes filled
    /// by their colour alone.
    pub(in crate::depth) fn new(beyond: f32, Water { cells, shares }: Water, counted: &[f32]) -> Self {
        debug_assert!(shares.len() == cells[0] * cells[1]);
        let Quantised { levels, step, .. } = quantise(counted);
        Self { beyond, cells, water: shares, levels: levels.into_owned(), step }
    }

    /// The distance beyond which z is a guess.
    pub(super) fn beyond(&self) -> f32 {
        self.beyond
    }

    /// How much is taken for open water at a pixel of a map of this size.
    pub(in crate::depth) fn water_at(&self, pixel: [usize; 2], size: [usize; 2]) -> f32 {
        at(&self.water, self.cells, pixel, size)
    }

    /// The map that estimators count.
    pub(super) fn quantised(&self) -> Quantised<'_> {
        Quantised { levels: (&self.levels).into(), step: self.step, beyond: Some(u8::MAX) }
    }

    /// Those of the scene alone.
    pub(super) fn cut(&self, area: &SceneArea) -> Self {
        let ((columns, rows), (width, height)) = (area.image_size(), area.size());
        let Margins { top, left, .. } = area.margins();
        let within = [left..left + width, top..top + height];
        let middle = |within: &Range<usize>, cell: usize, cells: usize| {
            within.start + within.len() * (2 * cell + 1) / (2 * cells)
        };
        let of_row = |y: usize| (0..self.cells[0]).map(move |x| [x, y]);
        let water = (0..self.cells[1]).flat_map(of_row).map(|place| {
            let pixel = [0, 1].map(|axis| middle(&within[axis], place[axis], self.cells[axis]));
            self.water_at(pixel, [columns, rows])
        });
        Self { water: water.collect(), levels: area.cut_values(self.levels.iter().copied()), ..*self }
    }

    /// Those of a map of `from` columns and rows, for a map of `to`.
    pub(super) fn resized(&self, from: [usize; 2], to: [usize; 2]) -> Self {
        let nearest = |at: usize, axis: usize| (2 * at + 1) * from[axis] / (2 * to[axis]);
        let of_row = |y: usize| {
            let line = &self.levels[nearest(y, 1) * from[0]..][..from[0]];
            (0..to[0]).map(move |x| line[nearest(x, 0)])
        };
        Self { levels: (0..to[1]).flat_map(of_row).collect(), water: self.water.clone(), ..*self }
    }
}

/// Values of cells at a pixel of an image of this size, between the middles of cells.
pub(in crate::depth) fn at(values: &[f32], cells: [usize; 2], pixel: [usize; 2], size: [usize; 2]) -> f32 {
    let place = |axis: usize| (pixel[axis] as f32 + 0.5) * cells[axis] as f32 / size[axis] as f32;
    let ([left, right], across) = between(place(0), cells[0]);
    let (rows, down) = between(place(1), cells[1]);
    let [above, below] = rows.map(|row| {
        let line = &values[row * cells[0]..];
        line[left] + across * (line[right] - line[left])
    });
    above + down * (below - above)
}

/// The two cells whose middles `at` lies between, and what the second counts; cell i reaches from i to i + 1.
fn between(at: f32, cells: usize) -> ([usize; 2], f32) {
    let at = (at - 0.5).clamp(0.0, (cells - 1) as f32);
    let before = at as usize;
    ([before, (before + 1).min(cells - 1)], at - before as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Image;
    use crate::scene_area::Border;

    /// Open water in the upper half of 8 x 8 pixels.
    fn upper_half() -> Guesses {
        let water =
            Water { cells: [8, 8], shares: (0..64).map(|i| if i < 32 { 1.0 } else { 0.0 }).collect() };
        let counted: Vec<f32> = (0..64).map(|i| (i / 8 + 1) as f32).collect();
        Guesses::new(5.0, water, &counted)
    }

    #[test]
    fn a_part_of_a_map_keeps_what_is_known_of_it() {
        let margins = Margins { top: 2, right: 0, bottom: 0, left: 4 };
        let image = Image::<u8>::from_raw(8, 8, vec![9; 192]).unwrap();
        let (whole, area) = (upper_half(), SceneArea::of(&image, Border::Given(margins)).unwrap());
        let part = whole.cut(&area);
        assert_eq!((part.beyond(), part.quantised().step), (5.0, whole.quantised().step));
        let levels = whole.quantised().levels;
        assert_eq!(part.quantised().levels, area.cut_values(levels.iter().copied()));
        assert!(part.water_at([1, 0], [4, 6]) > 0.9 && part.water_at([1, 5], [4, 6]) < 0.1);
    }

    #[test]
    fn a_map_of_another_size_keeps_its_places() {
        let twice = upper_half().resized([8, 8], [16, 24]);
        let levels = twice.quantised().levels.into_owned();
        assert_eq!(levels.len(), 16 * 24);
        assert_eq!((levels[0], levels[16 * 24 - 1]), (upper_half().levels[0], upper_half().levels[63]));
        assert!(twice.water_at([8, 4], [16, 24]) > 0.9 && twice.water_at([8, 20], [16, 24]) < 0.1);
    }
}
