//! What was measured beside a hole, carried into it as far as the image shows no edge.
//!
//! Weighted least squares (Farbman et al., "Edge-Preserving Decompositions", 2008) with a confidence for each value, solved along
//! rows and columns in turn (Min et al., "Fast Global Image Smoothing", 2014): measured distances count whole, what colour says
//! in a hole counts little, and neighbours agree the more, the more alike their brightness is. A pier that is measured in part
//! is one thing then, and the ground goes over into open water without a step.

use crate::depth::map::{Guesses, Water, at};
use crate::image::ImageRef;

/// Cells along the shorter side; a cell is one pixel at least.
const CELLS: usize = 200;
/// Cells at most, however long an image is: each takes fifty bytes.
const MOST_CELLS: f32 = 1e6;
/// How strongly neighbours agree, where there are so many cells, and the step of ln brightness at which that has fallen to a half.
/// Depth that was taken away from seven images, around their holes and in blocks, is found again with two thirds of the error that
/// colour and the colours nearby leave.
const SMOOTH: f32 = 400.0;
const EDGE: f32 = 0.02;
/// What is added to a brightness, so that the noise of black is no edge.
const DARKEST: f32 = 0.02;
/// How much a guess by colour counts, where a measured pixel counts 1: for things, and for open water. With as little for water as for
/// things, the water around a pier came as near as the pier, over a sixth of the image's height.
const THINGS: f32 = 0.02;
const WATER: f32 = 0.7;
/// Rounds of rows and columns.
const ROUNDS: i32 = 3;
/// Measured pixels so near to a hole say nothing: there the outlines of map and image often differ.
const OUTLINE: usize = 3;

/// A pixel that was not measured, by its colour.
#[derive(Clone, Copy)]
pub(super) struct Guess {
    pub(super) distance: f32,
    /// 0 on things, 1 in open water.
    pub(super) water: f32,
}

/// Fills what is not `valid` in the distances of `image`, by guesses and by what was measured beside them; `far` is the far end
/// of what was measured.
pub(super) fn fill(
    image: ImageRef<'_, u8>,
    distances: &mut [f32],
    valid: &[bool],
    far: f32,
    guess: impl Fn(usize) -> Guess,
) -> Guesses {
    let (width, height) = image.size();
    let side = (width.min(height) as f32 / CELLS as f32).max(1.0);
    let side = side.max((width as f32 * height as f32 / MOST_CELLS).sqrt());
    let cells = [width, height].map(|length| ((length as f32 / side) as usize).max(1));
    let trusted = trusted(valid, [width, height]);
    // Distances by what is left of a signal: between a thing and open water the middle is then the middle of what is seen.
    let scale = 0.5 * far.max(f32::MIN_POSITIVE);
    let mut sums = vec![Sums::default(); cells[0] * cells[1]];
    for (i, pixel) in image.pixels().enumerate() {
        let cell = cell(i / width, height, cells[1]) * cells[0] + cell(i % width, width, cells[0]);
        let (counts, water) = match valid[i] {
            true => (f32::from(u8::from(trusted[i])), 0.0),
            false => {
                let Guess { distance, water } = guess(i);
                distances[i] = distance;
                (THINGS + (WATER - THINGS) * water, water)
            }
        };
        let brightness = pixel.iter().map(|&value| f32::from(value)).sum::<f32>() / (3.0 * 255.0);
        sums[cell].add(brightness, counts, (-distances[i] / scale).exp(), water);
    }
    let brightness: Vec<f32> =
        sums.iter().map(|cell| (cell.brightness / cell.pixels + DARKEST).ln()).collect();
    let smooth = Smooth::new(&brightness, cells);
    let mean = |of: fn(&Sums) -> f32| smooth.of(sums.iter().map(|cell| of(cell) / cell.pixels).collect());
    let counts = mean(|cell| cell.counts);
    let by_count = |sums: Vec<f32>| -> Vec<f32> {
        // What nothing counts in, nor beside it, is as far as can be.
        sums.iter().zip(&counts).map(|(sum, counts)| (sum / counts.max(1e-9)).clamp(0.0, 1.0)).collect()
    };
    let (left, shares) = (by_count(mean(|cell| cell.left)), by_count(mean(|cell| cell.water)));
    let guesses = Guesses::new(far, Water { cells, shares }, distances);
    for i in (0..distances.len()).filter(|&i| !valid[i]) {
        let left = at(&left, cells, [i % width, i / width], [width, height]);
        distances[i] = -scale * left.max(f32::MIN_POSITIVE).ln();
    }
    guesses
}

/// Sums over the pixels of a cell.
#[derive(Clone, Default)]
struct Sums {
    pixels: f32,
    brightness: f32,
    /// What its pixels count, and by that what is left of a signal from them, and open water.
    counts: f32,
    left: f32,
    water: f32,
}

impl Sums {
    fn add(&mut self, brightness: f32, counts: f32, left: f32, water: f32) {
        self.pixels += 1.0;
        self.brightness += brightness;
        self.counts += counts;
        self.left += counts * left;
        self.water += counts * water;
    }
}

/// The cell of a pixel.
fn cell(at: usize, length: usize, cells: usize) -> usize {
    (2 * at + 1) * cells / (2 * length)
}

/// How much the neighbours of each cell agree with it, along rows and columns.
struct Smooth {
    cells: [usize; 2],
    /// With the next cell of the row, and of the column.
    along: [Vec<f32>; 2],
}

impl Smooth {
    fn new(brightness: &[f32], cells: [usize; 2]) -> Self {
        let along = [1, cells[0]].map(|next| {
            let alike = |pair: (&f32, &f32)| (1.0 + ((pair.0 - pair.1) / EDGE).powi(2)).recip();
            brightness.iter().zip(&brightness[next.min(brightness.len())..]).map(alike).collect()
        });
        Self { cells, along }
    }

    /// The map, smooth where neighbours agree.
    fn of(&self, mut map: Vec<f32>) -> Vec<f32> {
        let [columns, rows] = self.cells;
        // A place reaches as far in an image of fewer cells.
        let smooth = SMOOTH * (columns.min(rows) as f32 / CELLS as f32).powi(2);
        for round in 0..ROUNDS {
            let strength = 1.5 * smooth * 4.0_f32.powi(ROUNDS - 1 - round) / (4.0_f32.powi(ROUNDS) - 1.0);
            for y in 0..rows {
                solve(&mut map, &self.along[0], strength, [y * columns, 1, columns]);
            }
            for x in 0..columns {
                solve(&mut map, &self.along[1], strength, [x, columns, rows]);
            }
        }
        map
    }
}

/// Along a line of a map (its first value, its step and its length), x of least `Σ (x - map)² + strength Σ alike (x - next x)²`: three
/// diagonals, solved from one end to the other and back.
fn solve(map: &mut [f32], alike: &[f32], strength: f32, [first, step, length]: [usize; 3]) {
    let mut ratios = Vec::with_capacity(length);
    let [mut before, mut ratio, mut value] = [0.0; 3];
    for at in (first..).step_by(step).take(length) {
        let after = if ratios.len() + 1 < length { strength * alike[at] } else { 0.0 };
        let diagonal = 1.0 + before * (1.0 - ratio) + after;
        value = (map[at] + before * value) / diagonal;
        ratio = after / diagonal;
        map[at] = value;
        ratios.push(ratio);
        before = after;
    }
    for at in (0..length.saturating_sub(1)).rev() {
        let place = first + at * step;
        map[place] += ratios[at] * map[place + step];
    }
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
    use crate::image::Image;

    const SIZE: (usize, usize) = (160, 120);
    const FAR: f32 = 10.0;

    /// Water of one colour and in the middle a darker pier, of which the part below row 80 is measured at 6; colour takes both for
    /// open water, at 40.
    fn pier() -> (Vec<f32>, Guesses) {
        let is_pier = |x: usize| (70..90).contains(&x);
        let pixel = |i: usize| if is_pier(i % SIZE.0) { [10, 40, 66] } else { [11, 46, 80] };
        let image = Image::<u8>::from_raw(SIZE.0, SIZE.1, (0..SIZE.0 * SIZE.1).flat_map(pixel).collect());
        let valid: Vec<bool> =
            (0..SIZE.0 * SIZE.1).map(|i| is_pier(i % SIZE.0) && i / SIZE.0 >= 80).collect();
        let mut distances: Vec<f32> = valid.iter().map(|&valid| if valid { 6.0 } else { 0.0 }).collect();
        let guess = |_| Guess { distance: 4.0 * FAR, water: 1.0 };
        let guesses = fill(image.unwrap().view(), &mut distances, &valid, FAR, guess);
        (distances, guesses)
    }

    #[test]
    fn a_pier_that_is_measured_in_part_goes_on_without_a_step_and_the_water_beside_it_stays_far() {
        let (z, _) = pier();
        let at = |x: usize, y: usize| z[y * SIZE.0 + x];
        assert_eq!(at(80, 90), 6.0);
        assert!(at(80, 78) < 0.3 * 4.0 * FAR, "{}", at(80, 78));
        let upwards: Vec<f32> = (10..80).rev().map(|y| at(80, y)).collect();
        assert!(upwards.windows(2).all(|pair| pair[1] >= pair[0] && pair[1] < 1.3 * pair[0]), "{upwards:?}");
        assert!(at(56, 100) > 2.0 * FAR && at(30, 20) > 3.9 * FAR, "{} {}", at(56, 100), at(30, 20));
    }

    #[test]
    fn what_is_measured_is_no_open_water_and_holes_are_what_colour_says() {
        let (_, guesses) = pier();
        let water = |x: usize, y: usize| guesses.water_at([x, y], [SIZE.0, SIZE.1]);
        assert!(water(80, 100) < 0.15, "{}", water(80, 100));
        assert!(water(30, 20) > 0.95 && water(80, 10) > 0.7, "{} {}", water(30, 20), water(80, 10));
    }

    #[test]
    fn a_line_is_solved() {
        let (values, alike, strength) = ([3.0_f32, 1.0, 4.0, 1.0, 5.0], [0.5_f32, 1.0, 0.1, 2.0, 0.0], 3.0);
        let mut x = values;
        solve(&mut x, &alike, strength, [0, 1, 5]);
        for i in 0..5 {
            let next = if i < 4 { alike[i] * (x[i] - x[i + 1]) } else { 0.0 };
            let before = if i > 0 { alike[i - 1] * (x[i] - x[i - 1]) } else { 0.0 };
            assert!((x[i] + strength * (next + before) - values[i]).abs() < 1e-5, "{x:?}");
        }
    }
}
