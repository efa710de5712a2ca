//! How far the depth of a place and a colour lies from the curve of the whole image, by what was measured nearby.

use super::LEVELS;

/// Cells along the shorter side at the finest scale, and ranges of colour depth, equally full.
const CELLS: usize = 32;
const RANGES: usize = 16;
/// So much of a cell's area counts for what the next coarser scale says: fewer pixels than that say little.
const COARSER: f32 = 0.25;
/// Measured pixels so near to a hole say nothing: there the outlines of map and image often differ.
const OUTLINE: usize = 3;

/// Distances less the curve, at each place and for each colour.
///
/// At every scale a cell's mean is drawn to what the scale of twice the side says there, the more the fewer pixels it has; the
/// coarsest is drawn to 0, the curve itself. A wall that is measured in part thus goes on at its own distance, and water far from
/// anything measured keeps the curve's.
pub(super) struct Nearby {
    /// From the coarsest to the finest.
    scales: Vec<Scale>,
    /// The place of each level of colour depth among the ranges.
    places: [f32; LEVELS],
}

/// Means in cells, range after range.
struct Scale {
    /// Cells in a row, and rows of them.
    cells: [usize; 2],
    size: [usize; 2],
    means: Vec<f32>,
}

/// Two neighbours and what the second counts.
type Between = [(usize, f32); 2];

impl Nearby {
    /// By the pixels of an image of this width: whether each is measured, its level of colour depth, and its distance less the curve.
    pub(super) fn new(width: usize, valid: &[bool], levels: &[u8], off: impl Fn(usize) -> f32) -> Self {
        let size = [width, levels.len() / width];
        let places = places(levels);
        let trusted = trusted(valid, size);
        let finest = (size[0].min(size[1]) as f32 / CELLS as f32).max(1.0);
        let mut sides = vec![finest];
        while sides[sides.len() - 1] < size[0].max(size[1]) as f32 {
            sides.push(2.0 * sides[sides.len() - 1]);
        }
        let mut nearby = Self { scales: Vec::new(), places };
        for side in sides.into_iter().rev() {
            let cells = size.map(|length| (length as f32 / side).ceil().max(1.0) as usize);
            let mut sums = vec![[0.0_f32; 2]; cells[0] * cells[1] * RANGES];
            for i in (0..levels.len()).filter(|&i| trusted[i]) {
                let cell = cell(i / width, size[1], cells[1]) * cells[0] + cell(i % width, size[0], cells[0]);
                let off = off(i);
                for (range, weight) in between(nearby.places[usize::from(levels[i])], RANGES) {
                    let [sum, count] = &mut sums[cell * RANGES + range];
                    *sum += weight * off;
                    *count += weight;
                }
            }
            let area = COARSER * (size[0] * size[1]) as f32 / (cells[0] * cells[1]) as f32;
            let middle = |at: usize, axis: usize| (at as f32 + 0.5) * size[axis] as f32 / cells[axis] as f32;
            let means = sums.iter().enumerate().map(|(i, [sum, count])| {
                let (cell, range) = (i / RANGES, i % RANGES);
                let (x, y) = (middle(cell % cells[0], 0), middle(cell / cells[0], 1));
                (sum + area * nearby.at_place(x, y, range as f32 + 0.5)) / (count + area)
            });
            let means = means.collect();
            nearby.scales.push(Scale { cells, size, means });
        }
        nearby
    }

    /// At a pixel of this level of colour depth.
    pub(super) fn at(&self, x: usize, y: usize, level: u8) -> f32 {
        self.at_place(x as f32 + 0.5, y as f32 + 0.5, self.places[usize::from(level)])
    }

    /// By the finest scale there is yet.
    fn at_place(&self, x: f32, y: f32, range: f32) -> f32 {
        let Some(Scale { cells, size, means }) = self.scales.last() else { return 0.0 };
        let along = |at: f32, axis: usize| between(at * cells[axis] as f32 / size[axis] as f32, cells[axis]);
        let mut mean = 0.0;
        for (row, of_row) in along(y, 1) {
            for (column, of_column) in along(x, 0) {
                for (range, of_range) in between(range, RANGES) {
                    let cell = row * cells[0] + column;
                    mean += of_row * of_column * of_range * means[cell * RANGES + range];
                }
            }
        }
        mean
    }
}

/// The cell of a pixel.
fn cell(at: usize, length: usize, cells: usize) -> usize {
    (2 * at + 1) * cells / (2 * length)
}

/// The two cells whose middles `at` lies between, and their weights; cell i reaches from i to i + 1.
fn between(at: f32, cells: usize) -> Between {
    let at = (at - 0.5).clamp(0.0, (cells - 1) as f32);
    let before = at as usize;
    let share = at - before as f32;
    [(before, 1.0 - share), ((before + 1).min(cells - 1), share)]
}

/// The place of each level among ranges that hold equally many pixels.
fn places(levels: &[u8]) -> [f32; LEVELS] {
    let mut counts = [0_usize; LEVELS];
    levels.iter().for_each(|&level| counts[usize::from(level)] += 1);
    let mut before = 0;
    counts.map(|count| {
        let middle = before as f32 + 0.5 * count as f32;
        before += count;
        middle * RANGES as f32 / levels.len() as f32
    })
}

/// Measured pixels that are far enough from holes.
fn trusted(valid: &[bool], [width, height]: [usize; 2]) -> Vec<bool> {
    let around = |at: usize, length: usize| at.saturating_sub(OUTLINE)..(at + OUTLINE + 1).min(length);
    let all = |of: &[bool], i: usize, step: usize, at: usize, length: usize| {
        around(at, length).all(|other| of[i + other * step - at * step])
    };
    let rows: Vec<bool> = (0..valid.len()).map(|i| all(valid, i, 1, i % width, width)).collect();
    (0..valid.len()).map(|i| all(&rows, i, width, i / width, height)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: [usize; 2] = [96, 64];

    /// Two walls of one colour, the left one 2 nearer than the curve says and the right one as it says, and above them water of
    /// another colour.
    fn walls(hole: impl Fn(usize, usize) -> bool) -> Nearby {
        let place = |i: usize| (i % SIZE[0], i / SIZE[0]);
        let pixels = SIZE[0] * SIZE[1];
        let levels: Vec<u8> = (0..pixels).map(|i| if place(i).1 < 16 { 200 } else { 90 }).collect();
        let valid: Vec<bool> =
            (0..pixels).map(|i| levels[i] == 90 && !hole(place(i).0, place(i).1)).collect();
        Nearby::new(SIZE[0], &valid, &levels, |i| if place(i).0 < 48 { -2.0 } else { 0.0 })
    }

    #[test]
    fn a_wall_goes_on_at_its_own_distance() {
        let found = walls(|x, y| (10..20).contains(&x) && (30..40).contains(&y));
        assert!((found.at(15, 35, 90) + 2.0).abs() < 0.2, "{}", found.at(15, 35, 90));
        assert!(found.at(80, 35, 90).abs() < 0.2);
    }

    #[test]
    fn another_colour_keeps_the_curve() {
        let found = walls(|_, _| false);
        assert!(found.at(15, 2, 200).abs() < 0.1, "{}", found.at(15, 2, 200));
    }

    #[test]
    fn outlines_say_nothing() {
        let valid: Vec<bool> = (0..SIZE[0] * SIZE[1]).map(|i| i % SIZE[0] < 40).collect();
        let found = trusted(&valid, SIZE);
        assert!(found[36] && !found[37] && found[0]);
    }
}
