//! Open water in an image: smooth, bluish-green, and of one colour.
//!
//! The farthest pixels need not be water: depth from colour takes bright sand for far where red is dead,
//! and turbid water for near. But open water is smooth, and much of it has one colour, wherever it is.

use std::ops::{AddAssign, Range};

use crate::bands;
use crate::depth::LEVELS;
use crate::image::ImageRef;
use crate::simd;

use super::hue::is_bluish_green;
use super::places::Places;
use super::reading::{ROUNDING, Reading, VeilingLightSource};

/// Cells along the shorter side. A cell must be wide enough to hold texture where there is any, and small
/// enough to fit between things.
const CELLS: usize = 48;
/// Cells whose values spread (standard deviation, bytes) no more than this are smooth in any image;
/// noisy cameras are forgiven as much as their smoothest tenth needs.
const SMOOTH: f32 = 1.5;
const SMOOTHEST: f64 = 0.10;
/// Cells that agree, as a share of all: fewer are a thing, not the water around things.
const LEAST_SHARE: f64 = 0.02;
/// Neighbouring cells of water differ by no more than this many bytes; smooth patches of sand by more.
const STEADY: f32 = 1.5;
/// Of the cells as far as the water, this share has its colour or is as smooth: where water is, nothing else
/// is (though it may shade from bright to dark). Sand lies among other things.
const LEAST_PURE: f64 = 0.8;
/// Share of the agreeing cells that is left out at either end of depth when "as far" is found.
const TAIL: f64 = 0.1;
/// Bytes by which a cell may differ from the water and still count as it there.
const PURE: f32 = 16.0;
/// Colours are counted in steps of this many bytes, each with its neighbours in the cube.
const STEP: f32 = 8.0;
/// What water spreads beyond this many bytes is no longer the camera's noise.
const MOST_NOISE: f32 = 4.0;
/// Cells within this many bytes of the commonest colour, in every channel, are read.
const NEAR: f32 = 12.0;

/// The commonest colour of smooth cells; none if few of all cells have it.
///
/// Cells count by the square of their rank in depth: of two smooth colours the farther is the water.
pub(super) fn read(image: ImageRef<'_, u8>, levels: &[u8]) -> Option<Reading> {
    let grid = Grid::new(image, levels);
    let cells = &grid.cells;
    let enough = smoothness(cells);
    let smooth = smooth(cells, enough);
    let rank = ranks(cells);
    let middle = commonest(smooth.iter().map(|&place| {
        let cell = &cells[place];
        (cell.mean.map(|value| (value / STEP) as usize), rank[usize::from(cell.level)].pow(2))
    }))?;
    let alike: Vec<usize> =
        smooth.into_iter().filter(|&place| differ(&cells[place].mean, &middle) < NEAR).collect();
    let share = alike.len() as f64 / cells.len() as f64;
    if share < LEAST_SHARE {
        return None;
    }
    let of_alike = |value: &dyn Fn(usize) -> f32| median(alike.iter().map(|&place| value(place)).collect());
    let water = std::array::from_fn(|c| of_alike(&|place| cells[place].mean[c]));
    let is_water =
        of_alike(&|place| grid.step(place)) <= STEADY && purity(cells, &alike, &water, enough) >= LEAST_PURE;
    is_water.then(|| Reading {
        rgb: water.map(|value| value / 255.0),
        source: VeilingLightSource::OpenWater,
        share,
        places: Places::Cells(alike.iter().map(|&place| grid.cell(place)).collect()),
        standard_error: std::array::from_fn(|c| {
            let values = alike.iter().map(|&place| f64::from(cells[place].mean[c]));
            standard_error_of_median(values) / 255.0
        }),
        level: Some(of_alike(&|place| f32::from(cells[place].level)) as u8),
        noise: of_alike(&|place| cells[place].spread).clamp(ROUNDING, MOST_NOISE),
    })
}

/// A small rectangle of the image.
struct Cell {
    mean: [f32; 3],
    /// The largest standard deviation of the three channels, bytes.
    spread: f32,
    /// Mean level of depth.
    level: u8,
}

/// The largest difference of two colours in any channel.
fn differ(a: &[f32; 3], b: &[f32; 3]) -> f32 {
    (0..3).map(|c| (a[c] - b[c]).abs()).fold(0.0, f32::max)
}

/// Share of the cells as far as those `alike` that have the water's colour.
fn purity(cells: &[Cell], alike: &[usize], water: &[f32; 3], as_smooth: f32) -> f64 {
    let mut levels: Vec<u8> = alike.iter().map(|&place| cells[place].level).collect();
    levels.sort_unstable();
    let tail = (levels.len() as f64 * TAIL) as usize;
    let as_far = levels[tail]..=levels[levels.len() - 1 - tail];
    let (mut all, mut pure) = (0, 0);
    for cell in cells.iter().filter(|cell| as_far.contains(&cell.level)) {
        all += 1;
        pure += usize::from(differ(&cell.mean, water) < PURE || cell.spread <= as_smooth);
    }
    pure as f64 / f64::from(all.max(1))
}

/// The largest spread of a smooth cell of this image.
fn smoothness(cells: &[Cell]) -> f32 {
    let mut spreads: Vec<f32> = cells.iter().map(|cell| cell.spread).collect();
    let tenth = (cells.len() as f64 * SMOOTHEST) as usize;
    let (_, &mut needed, _) = spreads.select_nth_unstable_by(tenth, f32::total_cmp);
    needed.max(SMOOTH)
}

/// Places of the cells that hold nothing but one bluish-green colour.
fn smooth(cells: &[Cell], enough: f32) -> Vec<usize> {
    let bluish_green = |cell: &Cell| is_bluish_green(&cell.mean.map(|value| (value + 0.5) as u8));
    let is_smooth = |cell: &Cell| cell.spread <= enough && bluish_green(cell);
    (0..cells.len()).filter(|&place| is_smooth(&cells[place])).collect()
}

/// For each level of depth, how many cells are no farther.
fn ranks(cells: &[Cell]) -> [u64; LEVELS] {
    let mut counts = [0; LEVELS];
    for cell in cells {
        counts[usize::from(cell.level)] += 1;
    }
    let mut sum = 0;
    counts.map(|count| {
        sum += count;
        sum
    })
}

/// The middle of the step of the cube of colours that weighs most, each step with its neighbours.
///
/// Weights are whole numbers: their sum does not depend on the order of the cells, nor on which way a mirror turns
/// them. Of several that weigh most, it is the last; none where there are no colours.
fn commonest(weighed: impl Iterator<Item = ([usize; 3], u64)> + Clone) -> Option<[f32; 3]> {
    // Only the part of the cube that is used, with a margin of one on either side for neighbours.
    let bound = |most: fn(usize, usize) -> usize| {
        weighed.clone().map(|(place, _)| place).reduce(|a, b| std::array::from_fn(|c| most(a[c], b[c])))
    };
    let (low, high) = (bound(usize::min)?, bound(usize::max)?);
    let sides: [usize; 3] = std::array::from_fn(|c| high[c] - low[c] + 3);
    let mut sums = vec![0_u64; sides.iter().product()];
    for (place, weight) in weighed {
        for_neighbours(std::array::from_fn(|c| place[c] - low[c]), sides, |index, share| {
            sums[index] += share * weight;
        });
    }
    let index = (0..sums.len()).max_by_key(|&index| sums[index])?;
    let place = [index / (sides[1] * sides[2]), index / sides[2] % sides[1], index % sides[2]];
    Some(std::array::from_fn(|c| ((low[c] + place[c]) as f32 - 0.5) * STEP))
}

/// Visits a step of a cube and its neighbours, which count half for each axis they are off.
fn for_neighbours(
    [red, green, blue]: [usize; 3],
    [_, greens, blues]: [usize; 3],
    mut visit: impl FnMut(usize, u64),
) {
    const SHARE: [u64; 3] = [1, 2, 1];
    for (r, of_red) in SHARE.into_iter().enumerate() {
        for (g, of_green) in SHARE.into_iter().enumerate() {
            for (b, of_blue) in SHARE.into_iter().enumerate() {
                let index = ((red + r) * greens + green + g) * blues + blue + b;
                visit(index, of_red * of_green * of_blue);
            }
        }
    }
}

/// The image in cells whose borders are mirrored with it.
struct Grid {
    columns: Vec<usize>,
    rows: Vec<usize>,
    cells: Vec<Cell>,
}

impl Grid {
    fn new(image: ImageRef<'_, u8>, levels: &[u8]) -> Self {
        let (width, height) = image.size();
        let side = (width.min(height) as f32 / CELLS as f32).max(1.0);
        let (columns, rows) = (borders(width, side), borders(height, side));
        let of = |rows: &[usize]| cells_of(image, levels, &columns, rows);
        let middle = rows.len() / 2;
        let (mut cells, below) = bands::both(levels.len(), || of(&rows[..=middle]), || of(&rows[middle..]));
        cells.extend(below);
        Self { columns, rows, cells }
    }

    /// The columns and rows of a cell.
    fn cell(&self, place: usize) -> [Range<usize>; 2] {
        let across = self.columns.len() - 1;
        let between = |borders: &[usize], i: usize| borders[i]..borders[i + 1];
        [between(&self.columns, place % across), between(&self.rows, place / across)]
    }

    /// How much a cell differs from its neighbours, the two that differ more left out: those may be things.
    fn step(&self, place: usize) -> f32 {
        let across = self.columns.len() - 1;
        let (row, column) = (place / across, place % across);
        let neighbours = [
            (column > 0).then(|| place - 1),
            (column + 1 < across).then_some(place + 1),
            (row > 0).then(|| place - across),
            Some(place + across).filter(|&below| below < self.cells.len()),
        ];
        let mean = &self.cells[place].mean;
        let mut steps =
            neighbours.map(|other| other.map_or(0.0, |other| differ(mean, &self.cells[other].mean)));
        steps.sort_by(f32::total_cmp);
        steps[1]
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

/// Where cells of about `side` begin and end along `length`: the same from both ends.
fn borders(length: usize, side: f32) -> Vec<usize> {
    let wanted = ((length as f32 / side) as usize).clamp(1, length);
    // An odd length has a middle pixel: only an odd number of cells can be even about it.
    let count = if wanted % 2 == length % 2 || wanted == 1 { wanted } else { wanted - 1 };
    let from_start = |i: usize| (2 * i * length + count) / (2 * count);
    (0..=count).map(|i| if 2 * i <= count { from_start(i) } else { length - from_start(count - i) }).collect()
}

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

    #[inline(always)]
    fn add(&mut self, values: &[u8], levels: &[u8]) {
        for ((sum, square), &value) in self.values.iter_mut().zip(&mut self.squares).zip(values) {
            *sum += u32::from(value);
            *square += u32::from(u16::from(value) * u16::from(value));
        }
        for (sum, &level) in self.levels.iter_mut().zip(levels) {
            *sum += u32::from(level);
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
            spread: variance.fold(0.0, f64::max).sqrt() as f32,
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
        for y in self.rows {
            let levels = &self.levels[y * self.image.width()..][..self.image.width()];
            self.sums.add(self.image.row(y).as_flattened(), levels);
        }
    }
}

/// Standard error of the median of values that scatter evenly: 1.253 deviations over the root of their number.
fn standard_error_of_median(values: impl ExactSizeIterator<Item = f64>) -> f32 {
    let count = values.len() as f64;
    let (sum, squares) = values.fold((0.0, 0.0), |(sum, squares), v| (sum + v, squares + v * v));
    let variance = (squares / count - (sum / count).powi(2)).max(0.0);
    (1.253 * (variance / count).sqrt()) as f32
}

/// The middle value; of an even number, the upper of the middle two.
fn median(mut values: Vec<f32>) -> f32 {
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f32::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Image;
    use proptest::prelude::*;

    #[test]
    fn smooth_water_is_read_though_textured_sand_is_taken_for_far() {
        // Three tenths water of one colour, the rest sand that flickers, and depth the wrong way round.
        let at = |x: usize, y: usize| match (y < 30, (x * 7 + y * 13) % 5 * 12) {
            (true, _) => [20, 120, 160],
            (false, flicker) => [90 + flicker as u8, 180, 170 + flicker as u8],
        };
        let samples = (0..100).flat_map(|y| (0..150).flat_map(move |x| at(x, y))).collect();
        let levels: Vec<u8> = (0..100).flat_map(|y| [if y < 30 { 80 } else { 200 }; 150]).collect();
        let image = Image::from_raw(150, 100, samples).unwrap();
        let Reading { rgb, share, .. } = read(image.view(), &levels).unwrap();
        let bytes = rgb.map(|value| (value * 255.0).round() as u8);
        assert_eq!(bytes, [20, 120, 160]);
        assert!(share > 0.25 && share < 0.35, "{share}");
    }

    #[test]
    fn without_a_smooth_place_there_is_no_open_water() {
        let samples = (0..96 * 96).flat_map(|i| [40, (i * 37 % 120) as u8 + 60, (i * 91 % 100) as u8 + 90]);
        let image = Image::from_raw(96, 96, samples.collect()).unwrap();
        assert!(read(image.view(), &[128; 96 * 96]).is_none_or(|found| found.share < 0.2));
    }

    proptest! {
        #[test]
        fn borders_are_the_same_from_both_ends(length in 1..3000_usize, side in 1.0..40.0_f32) {
            let found = borders(length, side);
            prop_assert_eq!((found[0], found[found.len() - 1]), (0, length));
            prop_assert!(found.windows(2).all(|pair| pair[0] < pair[1]));
            let mirrored: Vec<usize> = found.iter().rev().map(|border| length - border).collect();
            prop_assert_eq!(found, mirrored);
        }
    }
}
