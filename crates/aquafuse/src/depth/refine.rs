//! Depth from colour, refined by the image: smooth where its colours are, with edges where they have edges.
//!
//! The model is evaluated at each pixel and averaged over small cells; around each cell the means are fitted by an affine function
//! of colour ([`guided`](crate::guided)), and that function is evaluated at each pixel. A camera's noise and the blocks of JPEG
//! average out, and an edge is as sharp as in the image. The paper's median adds nothing to means over cells, so that it is left out.

use std::ops::Range;

use super::DepthMap;
use super::map::{Buffers, LAST_STEP, step_to_level};
use crate::bands;
use crate::grid::Grid;
use crate::guided::Guided;
use crate::image::{Encoded, ImageRef, Sample};
use crate::simd::{self, Whole as _, Work};

/// Cells along the shorter side, and pixels along a cell's side at least.
const CELLS: usize = 32;
const LEAST_SIDE: f32 = 4.0;
/// Rows of a cell that are read at least: enough for a mean.
const ROWS: usize = 8;
/// Variance of colours below which they do not guide depth.
pub(super) const FLAT: f32 = 4e-3;

/// What a model makes of pixels, before it is refined: bytes or words of which the largest is z = 1.
pub(super) trait Raw: Copy + Default + Send + Sync + Into<u32> {
    const ONE: f32;
}

impl Raw for u8 {
    const ONE: f32 = 255.0;
}

impl Raw for u16 {
    const ONE: f32 = 65535.0;
}

/// z of an image as a function of its colours. `fill` writes what the model makes of a row.
pub(super) fn fit<T: Sample, R: Raw>(
    image: ImageRef<'_, T>,
    fill: impl Fn(usize, &mut [R]) + Sync,
) -> Guided {
    let grid = Grid::new(image.size(), CELLS, LEAST_SIDE);
    let rows = grid.rows();
    let of = |rows: &[usize]| cells(image, &fill, grid.columns(), rows);
    let middle = rows.len() / 2;
    let pixels = image.width() * image.height();
    let (mut all, below) = bands::both(pixels, || of(&rows[..=middle]), || of(&rows[middle..]));
    all.extend(below);
    let (colours, map): (Vec<[f32; 3]>, Vec<f32>) = all.into_iter().unzip();
    Guided::new(&grid, &colours, &map, FLAT)
}

/// The map in steps, in the memory of another.
pub(super) fn in_steps<T: Sample>(image: ImageRef<'_, T>, map: &Guided, buffers: Buffers) -> DepthMap {
    let (width, height) = image.size();
    let Buffers { mut levels, mut steps } = buffers;
    levels.resize(width * height, 0);
    steps.resize(width * height, 0);
    bands::for_each_two(&mut steps, &mut levels, width, |first, steps, levels| {
        let mut rows = map.rows();
        let bands = steps.chunks_mut(width).zip(levels.chunks_mut(width));
        for (y, (steps, levels)) in (first..).zip(bands) {
            let values = &*rows.row::<T, Encoded>(y, image.row(y));
            simd::widest(Round { values, steps, levels });
        }
    });
    DepthMap::from_steps((width, height), steps, levels)
}

/// The map in steps of 1 / 65535.
pub(super) fn in_fine_levels<T: Sample>(image: ImageRef<'_, T>, map: &Guided) -> Vec<u16> {
    let (width, height) = image.size();
    let mut levels = vec![0; width * height];
    bands::for_each(&mut levels, width, |first, band| {
        let mut rows = map.rows();
        for (y, levels) in (first..).zip(band.chunks_mut(width)) {
            let values = &*rows.row::<T, Encoded>(y, image.row(y));
            for (level, value) in levels.iter_mut().zip(values) {
                *level = (f32::from(u16::MAX) * value.clamp(0.0, 1.0) + 0.5) as u16;
            }
        }
    });
    levels
}

/// Rounds z to steps, and these to levels.
struct Round<'a> {
    values: &'a [f32],
    steps: &'a mut [u16],
    levels: &'a mut [u8],
}

impl Work for Round<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        for ((value, step), level) in self.values.iter().zip(self.steps).zip(self.levels) {
            *step = (f32::from(LAST_STEP) * value.clamp(0.0, 1.0)).whole_bits() as u16;
            *level = step_to_level(*step);
        }
    }
}

/// Mean colour and mean depth of the cells between these borders, row by row.
fn cells<T: Sample, R: Raw>(
    image: ImageRef<'_, T>,
    fill: impl Fn(usize, &mut [R]),
    columns: &[usize],
    rows: &[usize],
) -> Vec<([f32; 3], f32)> {
    let width = image.width();
    let mut all = Vec::with_capacity((columns.len() - 1) * (rows.len() - 1));
    let mut raw = vec![R::default(); width];
    let (mut values, mut depths) = (vec![0; 3 * width], vec![0; width]);
    for rows in rows.windows(2) {
        values.fill(0);
        depths.fill(0);
        let read = some_rows(rows[0], rows[1]);
        let count = read.len();
        for y in read {
            fill(y, &mut raw);
            let pixels = image.row(y).as_flattened();
            simd::widest(AddRow { values: &mut values, depths: &mut depths, pixels, raw: &raw });
        }
        for columns in columns.windows(2) {
            all.push(cell::<R>(&values, &depths, columns[0]..columns[1], count));
        }
    }
    all
}

/// Some rows of a cell, about its middle.
fn some_rows(from: usize, to: usize) -> impl ExactSizeIterator<Item = usize> {
    let stride = ((to - from) / ROWS).max(1);
    let rest = (to - from - 1) % stride;
    (from + rest / 2..to).step_by(stride)
}

fn cell<R: Raw>(values: &[u32], depths: &[u32], columns: Range<usize>, rows: usize) -> ([f32; 3], f32) {
    let count = (columns.len() * rows) as f64;
    let depth: u64 = depths[columns.clone()].iter().map(|&sum| u64::from(sum)).sum();
    let mut colour = [0_u64; 3];
    for pixel in values[3 * columns.start..3 * columns.end].as_chunks::<3>().0 {
        (0..3).for_each(|c| colour[c] += u64::from(pixel[c]));
    }
    let mean = |sum: u64, one: f64| (sum as f64 / (one * count)) as f32;
    (colour.map(|sum| mean(sum, 255.0)), mean(depth, f64::from(R::ONE)))
}

struct AddRow<'a, T, R> {
    values: &'a mut [u32],
    depths: &'a mut [u32],
    pixels: &'a [T],
    raw: &'a [R],
}

impl<T: Sample, R: Raw> Work for AddRow<'_, T, R> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        for (sum, value) in self.values.iter_mut().zip(self.pixels) {
            *sum += u32::from(value.to_byte());
        }
        for (sum, &depth) in self.depths.iter_mut().zip(self.raw) {
            *sum += depth.into();
        }
    }
}
