//! Where a depth map was measured, of which a part is a guess.

use std::ops::Range;

/// How far and where z was measured.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Measured {
    /// Beyond this distance z is a guess.
    to: f32,
    /// Columns and rows of cells over the map.
    cells: [usize; 2],
    /// How much of what is known in each cell was measured there or beside it, in `[0, 1]`.
    shares: Vec<f32>,
}

impl Measured {
    /// By the shares of cells, row by row.
    pub(in crate::depth) fn new(to: f32, cells: [usize; 2], shares: Vec<f32>) -> Self {
        debug_assert!(shares.len() == cells[0] * cells[1]);
        Self { to, cells, shares }
    }

    /// The distance beyond which z is a guess.
    pub(crate) fn to(&self) -> f32 {
        self.to
    }

    /// The share at a pixel of a map of this size, between the middles of cells.
    pub(crate) fn at(&self, pixel: [usize; 2], size: [usize; 2]) -> f32 {
        let place = |axis: usize| (pixel[axis] as f32 + 0.5) * self.cells[axis] as f32 / size[axis] as f32;
        let ([left, right], across) = between(place(0), self.cells[0]);
        let (rows, down) = between(place(1), self.cells[1]);
        let [above, below] = rows.map(|row| {
            let line = &self.shares[row * self.cells[0]..];
            line[left] + across * (line[right] - line[left])
        });
        above + down * (below - above)
    }

    /// The part within these columns and rows of a map of this size, in as many cells.
    pub(super) fn cut(&self, within: [Range<usize>; 2], size: [usize; 2]) -> Self {
        let middle = |axis: usize, cell: usize| {
            let within = &within[axis];
            (within.start + within.len() * (2 * cell + 1) / (2 * self.cells[axis])).min(size[axis] - 1)
        };
        let of_row = |y: usize| (0..self.cells[0]).map(move |x| [x, y]);
        let cells = (0..self.cells[1]).flat_map(of_row);
        let shares = cells.map(|[x, y]| self.at([middle(0, x), middle(1, y)], size)).collect();
        Self { shares, ..*self }
    }
}

/// The two cells whose middles `at` lies between, and what the second counts; cell i reaches from i to i + 1.
fn between(at: f32, cells: usize) -> ([usize; 2], f32) {
    let at = (at - 0.5).clamp(0.0, (cells - 1) as f32);
    let before = at as usize;
    ([before, (before + 1).min(cells - 1)], at - before as f32)
}
