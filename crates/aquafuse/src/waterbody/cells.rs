//! An image in small cells: what a region of water is looked for in.

use std::ops::{AddAssign, Range};

use crate::bands;
use crate::grid::Grid;
use crate::image::ImageRef;
use crate::simd;

/// Cells along the shorter side. A cell must be wide enough to hold texture where there is any, and small
/// enough to fit between things.
const CELLS: usize = 48;
/// Pixels along a cell's side at least: texture is what differs within a cell.
const LEAST_SIDE: f32 = 3.0;

/// A small rectangle of the image.
pub(super) struct Cell {
    /// Red, green and blue, bytes.
    pub(super) mean: [f32; 3],
    /// The largest standard deviation of the three channels, bytes.
    pub(super) spread: f32,
    /// Mean variance of the three channels, in units of `[0, 1]`.
    pub(super) variance: f32,
    /// Mean level of depth.
    pub(super) level: u8,
}

/// The cells of an image, row by row from the top.
pub(super) struct Cells {
    grid: Grid,
    all: Vec<Cell>,
}

impl Cells {
    pub(super) fn new(image: ImageRef<'_, u8>, levels: &[u8]) -> Self {
        let grid = Grid::new(image.size(), CELLS, LEAST_SIDE);
        let rows = grid.rows();
        let of = |rows: &[usize]| cells_of(image, levels, grid.columns(), rows);
        let middle = rows.len() / 2;
        let (mut all, below) = bands::both(levels.len(), || of(&rows[..=middle]), || of(&rows[middle..]));
        all.extend(below);
        Self { grid, all }
    }

    /// The cells.
    pub(super) fn all(&self) -> &[Cell] {
        &self.all
    }

    /// Where they are.
    pub(super) fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The columns and rows of a cell.
    pub(super) fn place(&self, cell: usize) -> [Range<usize>; 2] {
        let across = self.grid.size().0;
        let between = |borders: &[usize], i: usize| borders[i]..borders[i + 1];
        [between(self.grid.columns(), cell % across), between(self.grid.rows(), cell / across)]
    }
}

/// The cells between these borders of columns and rows, row by row.
fn cells_of(image: ImageRef<'_, u8>, levels: &[u8], columns: &[usize], rows: &[usize]) -> Vec<Cell> {
    let mut cells = Vec::with_capacity((columns.len() - 1) * (rows.len() - 1));
    let mut sums = ColumnSums::new(image.width());
    for rows in rows.windows(2) {
        sums.clear();
        simd::widest(AddRows { sums: &mut sums, image, levels, rows: rows[0]..rows[1] });
        cells.extend(columns.windows(2).map(|columns| sums.cell(columns[0]..columns[1], rows[1] - rows[0])));
    }
    cells
}

/// Rows added at once.
const ROWS: usize = 4;

/// Sums over the rows of a row of cells, column by column: what is added is wide and without a branch.
struct ColumnSums {
    /// Of values and their squares, channels in turn; of levels.
    values: Vec<u32>,
    squares: Vec<u32>,
    levels: Vec<u32>,
}

impl ColumnSums {
    fn new(width: usize) -> Self {
        Self { values: vec![0; 3 * width], squares: vec![0; 3 * width], levels: vec![0; width] }
    }

    fn clear(&mut self) {
        for sums in [&mut self.values, &mut self.squares, &mut self.levels] {
            sums.fill(0);
        }
    }

    /// Adds some rows: the fewer times a sum is read and written, the better.
    #[inline(always)]
    fn add<const ROWS: usize>(&mut self, values: [&[u8]; ROWS], levels: [&[u8]; ROWS]) {
        let width = self.levels.len();
        let (sums, squares) = (&mut self.values[..3 * width], &mut self.squares[..3 * width]);
        let values = values.each_ref().map(|row| &row[..3 * width]);
        for i in 0..3 * width {
            let (mut sum, mut square) = (0_u16, 0_u32);
            for row in values {
                let value = u16::from(row[i]);
                sum += value;
                square += u32::from(value * value);
            }
            sums[i] += u32::from(sum);
            squares[i] += square;
        }
        let sums = &mut self.levels[..width];
        let levels = levels.each_ref().map(|row| &row[..width]);
        for i in 0..width {
            let mut sum = 0_u16;
            for row in levels {
                sum += u16::from(row[i]);
            }
            sums[i] += u32::from(sum);
        }
    }

    /// The cell of these columns and so many rows.
    fn cell(&self, columns: Range<usize>, rows: usize) -> Cell {
        let pixels = (columns.len() * rows) as u64;
        let channels = 3 * columns.start..3 * columns.end;
        let (values, squares) = (&self.values[channels.clone()], &self.squares[channels]);
        let [values, squares] = match pixels <= MOST_IN_32_BITS {
            true => sums::<u32>(values, squares).map(|sums| sums.map(f64::from)),
            false => sums::<u64>(values, squares).map(|sums| sums.map(|sum| sum as f64)),
        };
        let levels: u64 = self.levels[columns].iter().map(|&level| u64::from(level)).sum();
        let count = pixels as f64;
        let mean = values.map(|sum| sum / count);
        let variance = (0..3).map(|c| squares[c] / count - mean[c] * mean[c]);
        Cell {
            mean: mean.map(|value| value as f32),
            spread: variance.clone().fold(0.0, f64::max).sqrt() as f32,
            variance: (variance.map(|variance| variance.max(0.0)).sum::<f64>() / (3.0 * 255.0 * 255.0))
                as f32,
            level: (levels / pixels) as u8,
        }
    }
}

/// Of so many pixels the squares of a channel sum up to no more than 32 bits hold.
const MOST_IN_32_BITS: u64 = (u32::MAX / (255 * 255)) as u64;

/// The sums of each channel.
#[inline]
fn sums<T: Copy + Default + From<u32> + AddAssign>(values: &[u32], squares: &[u32]) -> [[T; 3]; 2] {
    let [mut of_values, mut of_squares] = [[T::default(); 3]; 2];
    for (value, square) in values.as_chunks::<3>().0.iter().zip(squares.as_chunks::<3>().0) {
        for c in 0..3 {
            of_values[c] += T::from(value[c]);
            of_squares[c] += T::from(square[c]);
        }
    }
    [of_values, of_squares]
}

struct AddRows<'a> {
    sums: &'a mut ColumnSums,
    image: ImageRef<'a, u8>,
    levels: &'a [u8],
    rows: Range<usize>,
}

impl simd::Work for AddRows<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { sums, image, levels, rows } = self;
        let width = image.width();
        let values = |y: usize| image.row(y).as_flattened();
        let levels = |y: usize| &levels[y * width..][..width];
        let mut y = rows.start;
        while y + ROWS <= rows.end {
            let ys = std::array::from_fn(|i| y + i);
            sums.add::<ROWS>(ys.map(values), ys.map(levels));
            y += ROWS;
        }
        for y in y..rows.end {
            sums.add([values(y)], [levels(y)]);
        }
    }
}
