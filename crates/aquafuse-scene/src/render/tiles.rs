//! Which footprints each tile of the image has to draw, front to back.

use super::project::Footprint;
use crate::scalar::Scalar;

/// Columns and rows of a tile: a row of it is one vector of eight floats.
pub(crate) const SIDE: usize = 8;

/// A footprint in the list of a tile.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Entry {
    /// Its number.
    pub(crate) footprint: u32,
    /// Which of the footprints of its row of tiles it is: what the tiles of a row find is added up for each of them.
    pub(crate) of_row: u32,
}

/// For each tile, row by row, the footprints that touch it; and for each footprint, the rows of tiles that it touches.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tiles {
    pub(crate) across: usize,
    pub(crate) down: usize,
    /// Where each tile's list begins in `entries`, and the end of the last.
    pub(crate) starts: Vec<u32>,
    /// Footprints.
    pub(crate) entries: Vec<Entry>,
    /// Where the footprints of each row of tiles begin, if all rows are listed one behind the other; and the end of the last.
    pub(crate) rows: Vec<u32>,
    /// Where each footprint's places begin in `places`, and the end of the last.
    pub(crate) firsts: Vec<u32>,
    /// Places in that list of all rows.
    pub(crate) places: Vec<u32>,
}

/// The tiles of one row of tiles that an ellipse touches.
struct Run {
    row: u32,
    first: u32,
    end: u32,
}

impl Tiles {
    /// The tiles that footprints touch together, each as often as it is touched.
    pub(crate) fn entries<T: Scalar>(width: usize, height: usize, footprints: &[Footprint<T>]) -> u64 {
        let (across, down) = (width.div_ceil(SIDE), height.div_ceil(SIDE));
        let mut runs = Vec::new();
        footprints.iter().fold(0, |sum, footprint| {
            runs.clear();
            touched(footprint, width, height, &mut runs, across, down);
            sum + runs.iter().map(|run| u64::from(run.end - run.first)).sum::<u64>()
        })
    }

    /// Lists footprints that are in order of distance: then so does each tile's list.
    pub(crate) fn new<T: Scalar>(width: usize, height: usize, footprints: &[Footprint<T>]) -> Self {
        let (across, down) = (width.div_ceil(SIDE), height.div_ceil(SIDE));
        let mut runs = Vec::with_capacity(2 * footprints.len());
        let mut ends = Vec::with_capacity(footprints.len());
        let mut counts = vec![0_u32; across * down];
        for footprint in footprints {
            touched(footprint, width, height, &mut runs, across, down);
            let begun = ends.last().copied().unwrap_or(0);
            for run in &runs[begun..] {
                let row = run.row as usize * across;
                for count in &mut counts[row + run.first as usize..row + run.end as usize] {
                    *count += 1;
                }
            }
            ends.push(runs.len());
        }
        let mut starts = Vec::with_capacity(counts.len() + 1);
        let mut total = 0;
        for count in counts {
            starts.push(total);
            total += count;
        }
        let mut next = starts.clone();
        starts.push(total);
        let mut rows = vec![0_u32; down + 1];
        for run in &runs {
            rows[run.row as usize + 1] += 1;
        }
        for row in 0..down {
            rows[row + 1] += rows[row];
        }
        let mut in_row = vec![0_u32; down];
        let mut entries = vec![Entry::default(); total as usize];
        let mut places = Vec::with_capacity(runs.len());
        let mut firsts = Vec::with_capacity(footprints.len() + 1);
        let mut begun = 0;
        for (rank, &end) in ends.iter().enumerate() {
            firsts.push(places.len() as u32);
            for run in &runs[begun..end] {
                let row = run.row as usize;
                let entry = Entry { footprint: rank as u32, of_row: in_row[row] };
                in_row[row] += 1;
                places.push(rows[row] + entry.of_row);
                for next in &mut next[row * across + run.first as usize..row * across + run.end as usize] {
                    entries[*next as usize] = entry;
                    *next += 1;
                }
            }
            begun = end;
        }
        firsts.push(places.len() as u32);
        Self { across, down, starts, entries, rows, firsts, places }
    }

    /// Where the entries of this tile are.
    pub(crate) fn range(&self, tile: usize) -> std::ops::Range<usize> {
        self.starts[tile] as usize..self.starts[tile + 1] as usize
    }

    /// Footprints in this row of tiles.
    pub(crate) fn in_row(&self, row: usize) -> usize {
        (self.rows[row + 1] - self.rows[row]) as usize
    }

    /// The places of a footprint in the list of all rows.
    pub(crate) fn places_of(&self, rank: usize) -> &[u32] {
        &self.places[self.firsts[rank] as usize..self.firsts[rank + 1] as usize]
    }
}

/// Adds the tiles whose pixels' middles the ellipse may reach: for each row of tiles from its leftmost to its rightmost
/// point within that row.
fn touched<T: Scalar>(
    footprint: &Footprint<T>,
    width: usize,
    height: usize,
    runs: &mut Vec<Run>,
    across: usize,
    down: usize,
) {
    let [mx, my] = footprint.mean.map(T::get);
    let [hx, hy] = footprint.reach.map(T::get);
    // Also false where a number is none.
    let inside = mx + hx > 0.0 && my + hy > 0.0 && mx - hx < width as f64 && my - hy < height as f64;
    if !inside {
        return;
    }
    let [a, b, _] = footprint.conic.map(T::get);
    // The box touches the ellipse at (hx, -b/c hx) and, on the slanted axis through (−b/a hy, hy).
    let c = footprint.conic[2].get();
    let widest = -b / c * hx;
    let square = (a - b * b / c) * hx * hx;
    let side = SIDE as f64;
    let first_row = tile_of(my - hy, down);
    let last_row = tile_of(my + hy, down);
    for row in first_row..=last_row {
        // The rows of pixels in it, by their middles.
        let top = (row as f64 * side + 0.5 - my).max(-hy);
        let bottom = (row as f64 * side + side - 0.5 - my).min(hy);
        if top > bottom {
            continue;
        }
        let edge = |dy: f64, sign: f64| {
            let under = (b * dy) * (b * dy) - a * (c * dy * dy - square);
            (-b * dy + sign * under.max(0.0).sqrt()) / a
        };
        let right = mx + edge(widest.clamp(top, bottom), 1.0) + 0.01;
        let left = mx + edge((-widest).clamp(top, bottom), -1.0) - 0.01;
        // The middles between: a tile's first is at .5, its last at .5 before the end.
        let (first, last) = ((left - 0.5).ceil(), (right - 0.5).floor());
        if first > last || last < 0.0 || first >= width as f64 {
            continue;
        }
        let first = tile_of(first, across) as u32;
        let end = tile_of(last, across) as u32 + 1;
        runs.push(Run { row: row as u32, first, end });
    }
}

/// The tile a place falls in, cut off at the first and the last.
fn tile_of(place: f64, tiles: usize) -> usize {
    ((place.max(0.0) as usize) / SIDE).min(tiles.saturating_sub(1))
}
