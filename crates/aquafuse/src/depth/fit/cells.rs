//! An image with known depth as statistics of its colours: sufficient for every step of the fit.

use std::cmp::Ordering;

use super::LabelError;
use crate::depth::Eq3;
use crate::depth::median;
use crate::image::{ImageError, ImageRef, Sample};

/// Cells along each side of the (R, M) plane.
const SIDE: usize = 64;
/// Labels below this number say nothing about a curve.
const LEAST: usize = 30;
/// Distance of the quartiles of a normal distribution of deviation 1.
const QUARTILES_OF_NORMAL: f64 = 1.349;

/// What is kept of one image.
#[derive(Clone, Debug)]
pub(super) struct LabelledImage {
    /// Colours that occur, in order of their cell.
    pub(super) cells: Vec<Cell>,
    /// Labelled pixels.
    pub(super) count: f64,
    /// How many images it counts as.
    pub(super) weight: f64,
    /// Distance of the quartiles of the labels, scaled so that it is the deviation if they are normally
    /// distributed: up to a quarter of them may be wrong.
    pub(super) spread: f64,
    /// Sum over pixels of (rank - mean rank)^2, equal labels sharing their rank.
    rank_variation: f64,
}

/// Pixels of nearly one colour.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    /// Mean R, encoded, in `[0, 1]`.
    pub(super) red: f32,
    /// Mean max(G, B).
    pub(super) max: f32,
    /// Median label.
    pub(super) z: f32,
    /// Mean rank of the labels, from 0, less the mean rank of all.
    pub(super) rank: f32,
    /// Pixels.
    pub(super) count: u32,
}

/// The place of a byte along a side: even in the square root, because the curves bend where it is dark.
fn place(byte: u8) -> usize {
    ((f64::from(byte) / 256.0).sqrt() * SIDE as f64) as usize
}

impl LabelledImage {
    pub(super) fn gather<T: Sample>(
        image: ImageRef<'_, T>,
        distances: &[f32],
        weight: f64,
    ) -> Result<Self, LabelError> {
        let (width, height) = image.size();
        let expected = width * height;
        if distances.len() != expected {
            return Err(ImageError::Buffer { width, height, expected, found: distances.len() }.into());
        }
        // Depth is the median of the model over 7x7 pixels, and each term rises or falls throughout: noise
        // that the median takes away must not bend the curves either.
        let plane = |of: fn([u8; 3]) -> u8| {
            let bytes: Vec<u8> = image.pixels().map(|pixel| of(pixel.map(T::to_byte))).collect();
            median::filtered(width, &bytes)
        };
        let (red, max) = (plane(|[r, _, _]| r), plane(|[_, g, b]| g.max(b)));
        let mut labelled: Vec<Labelled> = distances
            .iter()
            .zip(red.into_iter().zip(max))
            .filter(|(z, _)| z.is_finite())
            .map(|(&z, (red, max))| Labelled { z, red, max })
            .collect();
        if labelled.len() < LEAST {
            return Err(LabelError::Few { found: labelled.len(), least: LEAST });
        }
        // By label and then by colour, so that equal images give equal sums.
        labelled.sort_unstable_by(|a, b| a.z.total_cmp(&b.z).then((a.red, a.max).cmp(&(b.red, b.max))));
        let quantile = |share: f64| labelled[(share * (labelled.len() - 1) as f64) as usize].z;
        let ends = (quantile(0.0), quantile(1.0));
        if ends.0 == ends.1 {
            return Err(LabelError::Flat { value: ends.0 });
        }
        let half = f64::from(quantile(0.75)) - f64::from(quantile(0.25));
        let spread =
            if half > 0.0 { half / QUARTILES_OF_NORMAL } else { f64::from(ends.1) - f64::from(ends.0) };
        let (cells, rank_variation) = cells_of(&labelled);
        Ok(Self { cells, count: labelled.len() as f64, weight, spread, rank_variation })
    }

    /// Spearman's correlation of a model with the labels, colours of one cell counting as equal; 0 where the
    /// model distinguishes nothing.
    pub(super) fn rank_score(&self, eq3: &Eq3) -> f64 {
        let depth = |cell: &Cell| eq3.depth(f64::from(cell.red), f64::from(cell.max));
        let mut ordered: Vec<(f64, &Cell)> = self.cells.iter().map(|cell| (depth(cell), cell)).collect();
        ordered.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mean = (self.count - 1.0) / 2.0;
        let (mut below, mut covariation, mut variation) = (0.0, 0.0, 0.0);
        for equal in ordered.chunk_by(|a, b| a.0 == b.0) {
            let count: f64 = equal.iter().map(|(_, cell)| f64::from(cell.count)).sum();
            let rank = below + (count - 1.0) / 2.0 - mean;
            let labels: f64 =
                equal.iter().map(|(_, cell)| f64::from(cell.count) * f64::from(cell.rank)).sum();
            covariation += rank * labels;
            variation += count * rank * rank;
            below += count;
        }
        let norm = (variation * self.rank_variation).sqrt();
        if norm > 0.0 { covariation / norm } else { 0.0 }
    }

    /// An order of images that depends on nothing but what they hold.
    pub(super) fn canonical_order(&self, other: &Self) -> Ordering {
        let key = |cell: &Cell| (cell.count, cell.red.to_bits(), cell.max.to_bits(), cell.z.to_bits());
        self.cells.iter().map(key).cmp(other.cells.iter().map(key)).then(self.weight.total_cmp(&other.weight))
    }
}

/// A pixel whose depth is known.
struct Labelled {
    z: f32,
    red: u8,
    max: u8,
}

/// The cells of pixels sorted by label, and the variation of the ranks.
fn cells_of(labelled: &[Labelled]) -> (Vec<Cell>, f64) {
    let cell_of: [usize; 256] = std::array::from_fn(|byte| place(byte as u8));
    let index = |pixel: &Labelled| cell_of[usize::from(pixel.red)] * SIDE + cell_of[usize::from(pixel.max)];
    let mut sums = vec![Sums::default(); SIDE * SIDE];
    for pixel in labelled {
        sums[index(pixel)].count += 1;
    }
    let mean = (labelled.len() as f64 - 1.0) / 2.0;
    let (mut below, mut variation) = (0.0, 0.0);
    for equal in labelled.chunk_by(|a, b| a.z == b.z) {
        let count = equal.len() as f64;
        let rank = below + (count - 1.0) / 2.0 - mean;
        variation += count * rank * rank;
        below += count;
        equal.iter().for_each(|pixel| sums[index(pixel)].take(pixel, rank));
    }
    (sums.iter().filter(|sums| sums.count > 0).map(Sums::cell).collect(), variation)
}

/// A cell in the making; its pixels come in the order of their labels.
#[derive(Clone, Default)]
struct Sums {
    count: u32,
    taken: u32,
    red: u64,
    max: u64,
    rank: f64,
    median: f32,
}

impl Sums {
    fn take(&mut self, pixel: &Labelled, rank: f64) {
        if self.taken == self.count / 2 {
            self.median = pixel.z;
        }
        self.taken += 1;
        self.red += u64::from(pixel.red);
        self.max += u64::from(pixel.max);
        self.rank += rank;
    }

    fn cell(&self) -> Cell {
        let count = f64::from(self.count);
        let mean = |sum: u64| (sum as f64 / (255.0 * count)) as f32;
        Cell {
            red: mean(self.red),
            max: mean(self.max),
            z: self.median,
            rank: (self.rank / count) as f32,
            count: self.count,
        }
    }
}
