//! A map as a function of colour that changes from place to place: He, Sun and Tang, "Guided Image Filtering" (2013), with
//! colour as guide.
//!
//! Around each cell of a [`Grid`] the map is fitted by `a · U + b`, and between the middles of cells these functions are
//! interpolated: the map then follows the edges of the image, which cells are too coarse for.

use std::any::TypeId;
use std::ops::Range;

use crate::grid::{BLOCK, Grid, Window};
use crate::image::{Encoded, Encoding, Sample};
use crate::packed::{channels, pack};
use crate::simd::{self, Level, Work};

/// Cells to either side of which a function is fitted.
const REACH: usize = 2;

/// `a · U + b`: red, green and blue of a, for colours in steps of a byte, then b.
type Affine = [f32; 4];

/// A map over an image.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Guided {
    /// Twice the middles of the cells' columns and rows, in pixels.
    columns: Vec<usize>,
    rows: Vec<usize>,
    /// What the middles before and after each column of pixels count there.
    before: Vec<f32>,
    after: Vec<f32>,
    fits: Vec<Affine>,
}

impl Guided {
    /// The map whose values in the cells of `grid` are `map`, where their mean colours are `colours`, encoded. `flat` is the
    /// variance of colours, in units of `[0, 1]`, below which they do not guide.
    pub(crate) fn new(grid: &Grid, colours: &[[f32; 3]], map: &[f32], flat: f32) -> Self {
        let middles =
            |borders: &[usize]| borders.windows(2).map(|pair| pair[0] + pair[1] - 1).collect::<Vec<_>>();
        let (columns, width) = (middles(grid.columns()), grid.columns()[grid.size().0]);
        let weights = (0..=columns.len()).flat_map(|place| {
            let [from, to] = beside(&columns, place);
            pixels(&columns, width, place).map(move |x| weights(from, to, x).into())
        });
        let (before, after) = weights.unzip();
        let fits = fit(grid.size().0, colours, map, flat);
        Self { columns, rows: middles(grid.rows()), before, after, fits }
    }

    /// The map at column `x`, row `y` where the image has this encoded colour.
    pub(crate) fn at(&self, x: usize, y: usize, [r, g, b]: [f32; 3]) -> f32 {
        let (above, below, down) = between(&self.rows, y);
        let (left, right, across) = between(&self.columns, x);
        let fit = |row: usize, column: usize| &self.fits[row * self.columns.len() + column];
        let [above, below] = [above, below].map(|row| mixed(fit(row, left), fit(row, right), across));
        let [of_r, of_g, of_b, one] = mixed(&above, &below, down);
        of_r * (255.0 * r) + of_g * (255.0 * g) + of_b * (255.0 * b) + one
    }

    /// The map, row after row.
    pub(crate) fn rows(&self) -> Rows<'_> {
        let width = self.before.len();
        let spread = || Spread { row: None, fits: std::array::from_fn(|_| vec![0.0; width]) };
        Rows { map: self, above: spread(), below: spread(), words: Vec::new(), values: vec![0.0; width] }
    }
}

/// A map one row at a time, in memory of its own. Rows that follow one another share most of the work.
pub(crate) struct Rows<'a> {
    map: &'a Guided,
    above: Spread,
    below: Spread,
    words: Vec<u32>,
    values: Vec<f32>,
}

/// The functions of a row of cells, between whose middles they are interpolated: one for each column of pixels.
struct Spread {
    row: Option<usize>,
    fits: [Vec<f32>; 4],
}

impl Spread {
    fn fill(&mut self, map: &Guided, row: usize) {
        if self.row != Some(row) {
            self.row = Some(row);
            let line = &map.fits[row * map.columns.len()..][..map.columns.len()];
            simd::widest(Fill { fits: &mut self.fits, map, line });
        }
    }
}

/// Functions at each column of pixels, from those of a row of cells.
struct Fill<'a> {
    fits: &'a mut [Vec<f32>; 4],
    map: &'a Guided,
    line: &'a [Affine],
}

impl Work for Fill<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { fits, map: Guided { columns, before, after, .. }, line } = self;
        for place in 0..=line.len() {
            let ([from, to], pixels) = (beside(line, place), pixels(columns, before.len(), place));
            let (before, after) = (&before[pixels.clone()], &after[pixels.clone()]);
            for (k, fits) in fits.iter_mut().enumerate() {
                let (from, to) = (from[k], to[k]);
                for ((fit, before), after) in fits[pixels.clone()].iter_mut().zip(before).zip(after) {
                    *fit = before * from + after * to;
                }
            }
        }
    }
}

impl Rows<'_> {
    /// The map at the pixels of row `y`.
    pub(crate) fn row<T: Sample, E: Encoding>(&mut self, y: usize, pixels: &[[T; 3]]) -> &mut [f32] {
        let (from, to, weights) = between(&self.map.rows, y);
        if self.below.row == Some(from) {
            std::mem::swap(&mut self.above, &mut self.below);
        }
        self.above.fill(self.map, from);
        self.below.fill(self.map, to);
        let Self { above, below, words, values, .. } = self;
        let between = Between { above: &above.fits, below: &below.fits, weights };
        match T::bytes(pixels.as_flattened()) {
            Some(bytes) if TypeId::of::<E>() == TypeId::of::<Encoded>() => {
                words.resize(values.len(), 0);
                pack(Level::best(), bytes.as_chunks().0, words);
                simd::widest(OfWords { words, between, values });
            }
            _ => {
                for (x, (value, pixel)) in values.iter_mut().zip(pixels).enumerate() {
                    *value = between.at(x, pixel.map(|sample| 255.0 * E::to_encoded(sample.to_unit())));
                }
            }
        }
        values
    }
}

/// The functions of two rows of cells, and what they count at a row of pixels between them.
#[derive(Clone, Copy)]
struct Between<'a> {
    above: &'a [Vec<f32>; 4],
    below: &'a [Vec<f32>; 4],
    weights: [f32; 2],
}

impl Between<'_> {
    /// The map at column `x` where the image has this colour, in steps of a byte.
    #[inline(always)]
    fn at(&self, x: usize, [r, g, b]: [f32; 3]) -> f32 {
        let [up, down] = self.weights;
        let [of_r, of_g, of_b, one] =
            std::array::from_fn(|k| up * self.above[k][x] + down * self.below[k][x]);
        of_r * r + of_g * g + of_b * b + one
    }
}

/// The map at a row of packed pixels.
struct OfWords<'a> {
    words: &'a [u32],
    between: Between<'a>,
    values: &'a mut [f32],
}

impl Work for OfWords<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { words, between: Between { above, below, weights: [up, down] }, values } = self;
        let width = values.len();
        let words = &words[..width];
        let [r0, g0, b0, one0] = above.each_ref().map(|plane| &plane[..width]);
        let [r1, g1, b1, one1] = below.each_ref().map(|plane| &plane[..width]);
        for x in 0..width {
            // By way of signed numbers, for which processors have an instruction.
            let [r, g, b] = channels(words[x]).map(|value| value as i32 as f32);
            let of_r = up * r0[x] + down * r1[x];
            let of_g = up * g0[x] + down * g1[x];
            let of_b = up * b0[x] + down * b1[x];
            values[x] = of_r * r + of_g * g + of_b * b + (up * one0[x] + down * one1[x]);
        }
    }
}

/// The middles before and after a place, and their weights there.
fn between(middles: &[usize], place: usize) -> (usize, usize, [f32; 2]) {
    let after = middles.partition_point(|&middle| middle < 2 * place);
    let [from, to] = [after.saturating_sub(1), after.min(middles.len() - 1)];
    (from, to, weights(middles[from], middles[to], place))
}

/// The cells before and after a gap between middles; the first before the first, the last after the last.
#[inline(always)]
fn beside<T: Copy>(cells: &[T], gap: usize) -> [T; 2] {
    [gap.saturating_sub(1), gap.min(cells.len() - 1)].map(|cell| cells[cell])
}

/// The pixels of a gap, of so many: from the middle before it on.
#[inline(always)]
fn pixels(middles: &[usize], count: usize, gap: usize) -> Range<usize> {
    let first = |gap: usize| middles.get(gap).map_or(count, |middle| middle.div_ceil(2));
    gap.checked_sub(1).map_or(0, first)..first(gap)
}

/// What two middles, each twice what it is, count at a place between them: the nearer the more. Mirrored they are exchanged, to
/// the bit.
#[inline(always)]
fn weights(near: usize, far: usize, place: usize) -> [f32; 2] {
    if near == far {
        return [1.0, 0.0];
    }
    let scale = ((far - near) as f32).recip();
    [(far - 2 * place) as f32 * scale, (2 * place - near) as f32 * scale]
}

#[inline(always)]
fn mixed(from: &Affine, to: &Affine, [of_from, of_to]: [f32; 2]) -> Affine {
    std::array::from_fn(|k| of_from * from[k] + of_to * to[k])
}

/// For each cell the affine function of colour, in `[0, 1]`, that follows `map` around it, a mean of those of its neighbours.
fn fit(columns: usize, colours: &[[f32; 3]], map: &[f32], flat: f32) -> Vec<Affine> {
    simd::widest(Fit { columns, colours, map, flat })
}

struct Fit<'a> {
    columns: usize,
    colours: &'a [[f32; 3]],
    map: &'a [f32],
    flat: f32,
}

impl Work for Fit<'_> {
    type Output = Vec<Affine>;

    #[inline(always)]
    fn run(self) -> Vec<Affine> {
        let columns = self.columns;
        let size = (columns, self.map.len() / columns);
        let (mut means, mut fits) = (Window::new(QUANTITIES, size, REACH), Window::new(4, size, REACH));
        let mut smoothed = vec![[0.0; 4]; self.map.len()];
        // A row of means is a row of fits, of which the means are what is asked for.
        for turn in 0..fits.turns().end + REACH {
            if turn < size.1 {
                self.write(turn, &mut means);
                means.add(turn);
            }
            let Some(y) = turn.checked_sub(REACH) else { continue };
            if y < size.1 {
                means.average(turn);
                self.solve(&means, &mut fits);
                fits.add(y);
            }
            if let Some(y) = fits.average(y) {
                let [r, g, b, one] = [0, 1, 2, 3].map(|k| fits.mean(k));
                for (x, fit) in smoothed[y * columns..][..columns].iter_mut().enumerate() {
                    *fit = [r[x] / 255.0, g[x] / 255.0, b[x] / 255.0, one[x]];
                }
            }
        }
        smoothed
    }
}

/// What is averaged: three colours, the map, its products with them, and theirs with one another.
const QUANTITIES: usize = 13;
const MAP: usize = 3;
const WITH_MAP: usize = 4;
const WITH_ONE_ANOTHER: usize = 7;

impl Fit<'_> {
    /// Writes row `y` of all quantities.
    #[inline(always)]
    fn write(&self, y: usize, window: &mut Window) {
        let cells = y * self.columns..(y + 1) * self.columns;
        for c in 0..3 {
            for (value, colour) in window.next(c).iter_mut().zip(&self.colours[cells.clone()]) {
                *value = colour[c];
            }
        }
        window.next(MAP).copy_from_slice(&self.map[cells]);
        for c in 0..3 {
            window.multiply(WITH_MAP + c, c, MAP);
        }
        for (k, (a, b)) in PAIRS.into_iter().enumerate() {
            window.multiply(WITH_ONE_ANOTHER + k, a, b);
        }
    }

    /// Writes a row of fits by a row of means.
    #[inline(always)]
    fn solve(&self, means: &Window, fits: &mut Window) {
        for from in (0..self.columns).step_by(BLOCK) {
            let [r, g, b, map] = [0, 1, 2, MAP].map(|k| means.block(k, from));
            let with_map = [0, 1, 2].map(|c| means.block(WITH_MAP + c, from));
            let squares = [0, 1, 2, 3, 4, 5].map(|k| means.block(WITH_ONE_ANOTHER + k, from));
            let mut solved = [[0.0; BLOCK]; 4];
            for x in 0..BLOCK {
                let colour = [r[x], g[x], b[x]];
                let mut with_one_another = [0.0; 6];
                for k in 0..6 {
                    let (a, b) = PAIRS[k];
                    let flat = if a == b { self.flat } else { 0.0 };
                    with_one_another[k] = squares[k][x] - colour[a] * colour[b] + flat;
                }
                let right = [
                    with_map[0][x] - colour[0] * map[x],
                    with_map[1][x] - colour[1] * map[x],
                    with_map[2][x] - colour[2] * map[x],
                ];
                let [of_r, of_g, of_b] = solve(with_one_another, right);
                let one = map[x] - of_r * colour[0] - of_g * colour[1] - of_b * colour[2];
                (solved[0][x], solved[1][x], solved[2][x], solved[3][x]) = (of_r, of_g, of_b, one);
            }
            for (k, solved) in solved.iter().enumerate() {
                let row = &mut fits.next(k)[from..];
                let count = row.len().min(BLOCK);
                row[..count].copy_from_slice(&solved[..count]);
            }
        }
    }
}

/// The entries of a symmetric matrix, in the order in which they are kept.
const PAIRS: [(usize, usize); 6] = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];

/// x of `M x = y`, M symmetric and positive definite.
#[inline(always)]
fn solve([rr, rg, rb, gg, gb, bb]: [f32; 6], [r, g, b]: [f32; 3]) -> [f32; 3] {
    // By cofactors: three unknowns need no pivots.
    let (c_rr, c_rg, c_rb) = (gg * bb - gb * gb, gb * rb - rg * bb, rg * gb - gg * rb);
    let (c_gg, c_gb, c_bb) = (rr * bb - rb * rb, rg * rb - rr * gb, rr * gg - rg * rg);
    let scale = (rr * c_rr + rg * c_rg + rb * c_rb).recip();
    [
        scale * (c_rr * r + c_rg * g + c_rb * b),
        scale * (c_rg * r + c_gg * g + c_gb * b),
        scale * (c_rb * r + c_gb * g + c_bb * b),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_matrix_times_its_solution_is_the_right_side() {
        let [x, y, z] = solve([2.0, 0.5, 0.25, 3.0, -0.5, 1.5], [1.0, -2.0, 0.5]);
        let sides = [2.0 * x + 0.5 * y + 0.25 * z, 0.5 * x + 3.0 * y - 0.5 * z, 0.25 * x - 0.5 * y + 1.5 * z];
        for (found, expected) in sides.into_iter().zip([1.0, -2.0, 0.5]) {
            assert!((found - expected).abs() < 1e-5, "{found} is not {expected}");
        }
    }

    #[test]
    fn a_map_that_is_an_edge_of_the_image_follows_it_within_a_cell() {
        // Left dark things, right bright water; the map is known in cells, and a pixel of either colour in the middle
        // cell is as its side.
        let colours: Vec<[f32; 3]> =
            (0..81).map(|i| if i % 9 < 4 { [0.1; 3] } else { [0.2, 0.5, 0.8] }).collect();
        let map: Vec<f32> = (0..81).map(|i| if i % 9 < 4 { 0.0 } else { 1.0 }).collect();
        let [r, g, b, one] = fit(9, &colours, &map, 1e-3)[4 * 9 + 4];
        let at = |colour: [f32; 3]| 255.0 * (r * colour[0] + g * colour[1] + b * colour[2]) + one;
        let [thing, water] = [at([0.1; 3]), at([0.2, 0.5, 0.8])];
        assert!(water > 0.95 && water - thing > 0.5, "{thing} {water}");
    }

    #[test]
    fn without_colours_to_guide_it_the_map_is_smoothed() {
        let map: Vec<f32> = (0..49).map(|i| (i % 7) as f32 / 6.0).collect();
        let [r, g, b, one] = fit(7, &[[0.5; 3]; 49], &map, 1e-3)[24];
        assert!((127.5 * (r + g + b) + one - 0.5).abs() < 1e-3);
    }
}
