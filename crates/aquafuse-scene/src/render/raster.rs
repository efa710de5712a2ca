//! One row of tiles rendered front to back, and its gradients.
//!
//! Plain loops over [`LANES`] pixels, which the compiler makes vectors of. A pixel takes splats until less than
//! [`LAST_LIGHT`] comes through; what it does not take counts as nothing, so that no pixel branches.

use aquafuse::simd::Work;

use super::project::{FAINTEST, Footprint, Sums};
use super::tiles::{SIDE, Tiles};
use crate::scalar::Scalar;

/// The transmittance below which nothing farther is rendered. Published.
const LAST_LIGHT: f64 = 1e-4;
/// The most a splat hides at a pixel: what is behind must stay to be seen, if faintly. Published.
const MOST_HIDDEN: f64 = 0.99;
/// After so many splats it is asked whether any pixel of the tile still takes one.
const LOOK: usize = 16;

/// Pixels that are computed together: two rows of a tile, one vector of AVX-512.
const LANES: usize = 2 * SIDE;
/// Pairs of rows in a tile.
const PAIRS: usize = SIDE / 2;

/// Numbers of two rows of pixels within a tile.
type Lane<T> = [T; LANES];
/// Numbers of all pixels of a tile.
type Plane<T> = [Lane<T>; PAIRS];

/// Five numbers a pixel, in a row of tiles: planes of red, green, blue, distance, and what comes through.
pub(crate) struct Strip<'a, T> {
    pub(crate) colour: [&'a mut [T]; 3],
    pub(crate) distance: &'a mut [T],
    pub(crate) transmittance: &'a mut [T],
}

/// What a row of tiles is rendered from.
#[derive(Clone, Copy)]
pub(crate) struct Source<'a, T> {
    pub(crate) footprints: &'a [Footprint<T>],
    pub(crate) tiles: &'a Tiles,
    pub(crate) width: usize,
    /// Which row of tiles.
    pub(crate) row: usize,
    pub(crate) background: [T; 3],
}

/// A footprint over a tile: what its bell is computed from.
struct Bell<T> {
    /// From the projected mean to each column, and to the first two rows.
    dx: Lane<T>,
    dy: Lane<T>,
    /// The parts of its exponent that do not change from row to row: xx dx² / 2 and xy dx.
    square: Lane<T>,
    slope: Lane<T>,
}

impl<T: Scalar> Bell<T> {
    #[inline(always)]
    fn new(footprint: &Footprint<T>, left: usize, top: usize) -> Self {
        let [xx, xy, _] = footprint.conic;
        let half = T::of(0.5);
        let first = T::of(left as f64 + 0.5) - footprint.mean[0];
        let upper = T::of(top as f64 + 0.5) - footprint.mean[1];
        let mut bell = Self {
            dx: [T::ZERO; LANES],
            dy: [T::ZERO; LANES],
            square: [T::ZERO; LANES],
            slope: [T::ZERO; LANES],
        };
        for k in 0..LANES {
            bell.dx[k] = first + T::of((k % SIDE) as f64);
            bell.dy[k] = upper + T::of((k / SIDE) as f64);
            bell.square[k] = half * xx * (bell.dx[k] * bell.dx[k]);
            bell.slope[k] = xy * bell.dx[k];
        }
        bell
    }

    /// From the projected mean to a pair of rows.
    #[inline(always)]
    fn dy(&self, pair: usize) -> Lane<T> {
        let mut dy = self.dy;
        for k in 0..LANES {
            dy[k] += T::of(2.0 * pair as f64);
        }
        dy
    }

    /// How much of the light the footprint hides at each pixel, if not more than all; 0 where it is too faint.
    #[inline(always)]
    fn hidden(&self, footprint: &Footprint<T>, dy: &Lane<T>) -> Lane<T> {
        let half = T::of(0.5) * footprint.conic[2];
        let faintest = T::of(FAINTEST);
        let mut hidden = [T::ZERO; LANES];
        for k in 0..LANES {
            let power = -(self.square[k] + dy[k] * (self.slope[k] + half * dy[k]));
            let full = footprint.opacity * power.at_most(T::ZERO).falloff();
            hidden[k] = if full >= faintest { full } else { T::ZERO };
        }
        hidden
    }
}

/// The pairs of rows of a tile that a footprint reaches.
#[inline(always)]
fn pairs_reached<T: Scalar>(footprint: &Footprint<T>, top: usize) -> std::ops::Range<usize> {
    let [first, end] = footprint.rows;
    let first = (first as usize).saturating_sub(top) / 2;
    let end = (end as usize).saturating_sub(top).div_ceil(2).min(PAIRS);
    first..end
}

/// Draws a row of tiles.
pub(crate) struct Draw<'a, T> {
    pub(crate) source: Source<'a, T>,
    pub(crate) strip: Strip<'a, T>,
}

impl<T: Scalar> Work for Draw<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let rows = self.strip.transmittance.len() / self.source.width;
        for column in 0..self.source.tiles.across {
            let tile = Canvas::rendered(&self.source, column, rows);
            let left = column * SIDE;
            let across = (self.source.width - left).min(SIDE);
            for y in 0..rows {
                let at = y * self.source.width + left;
                let (pair, first) = (y / 2, y % 2 * SIDE);
                for k in 0..across {
                    let lane = first + k;
                    let transmittance = tile.transmittance[pair][lane];
                    for c in 0..3 {
                        self.strip.colour[c][at + k] =
                            tile.colour[c][pair][lane] + transmittance * self.source.background[c];
                    }
                    self.strip.distance[at + k] = tile.distance[pair][lane];
                    self.strip.transmittance[at + k] = transmittance;
                }
            }
        }
    }
}

/// A tile while it is rendered.
struct Canvas<T> {
    colour: [Plane<T>; 3],
    distance: Plane<T>,
    transmittance: Plane<T>,
}

impl<T: Scalar> Canvas<T> {
    #[inline(always)]
    fn rendered(source: &Source<'_, T>, column: usize, rows: usize) -> Self {
        let nothing = [[T::ZERO; LANES]; PAIRS];
        let mut canvas = Self {
            colour: [nothing; 3],
            distance: nothing,
            transmittance: clear(rows, source.width - column * SIDE),
        };
        let (left, top) = (column * SIDE, source.row * SIDE);
        let entries = &source.tiles.entries[source.tiles.range(source.row * source.tiles.across + column)];
        for some in entries.chunks(LOOK) {
            for &entry in some {
                canvas.take(&source.footprints[entry.footprint as usize], left, top);
            }
            if !any_light(&canvas.transmittance) {
                break;
            }
        }
        canvas
    }

    #[inline(always)]
    fn take(&mut self, footprint: &Footprint<T>, left: usize, top: usize) {
        let (last, most) = (T::of(LAST_LIGHT), T::of(MOST_HIDDEN));
        let bell = Bell::new(footprint, left, top);
        for pair in pairs_reached(footprint, top) {
            let hidden = bell.hidden(footprint, &bell.dy(pair));
            let transmittance = &mut self.transmittance[pair];
            let mut weight = [T::ZERO; LANES];
            for k in 0..LANES {
                let alpha = hidden[k].at_most(most);
                let taken = if transmittance[k] >= last { alpha } else { T::ZERO };
                weight[k] = transmittance[k] * taken;
                transmittance[k] -= weight[k];
            }
            for c in 0..3 {
                let row = &mut self.colour[c][pair];
                for k in 0..LANES {
                    row[k] += weight[k] * footprint.colour[c];
                }
            }
            let row = &mut self.distance[pair];
            for k in 0..LANES {
                row[k] += weight[k] * footprint.distance;
            }
        }
    }
}

/// All light at the pixels that the image has; none beyond its edge, where nothing is to be rendered.
#[inline(always)]
fn clear<T: Scalar>(rows: usize, columns: usize) -> Plane<T> {
    let mut plane = [[T::ZERO; LANES]; PAIRS];
    for y in 0..rows.min(SIDE) {
        for x in 0..columns.min(SIDE) {
            plane[y / 2][y % 2 * SIDE + x] = T::ONE;
        }
    }
    plane
}

#[inline(always)]
fn any_light<T: Scalar>(transmittance: &Plane<T>) -> bool {
    let mut most = [T::ZERO; LANES];
    for row in transmittance {
        for k in 0..LANES {
            most[k] = most[k].at_least(row[k]);
        }
    }
    let last = T::of(LAST_LIGHT);
    let mut any = false;
    for k in 0..LANES {
        any |= most[k] >= last;
    }
    any
}

/// A row of tiles' planes for reading: a gradient, or a rendering.
#[derive(Clone, Copy)]
pub(crate) struct Planes<'a, T> {
    pub(crate) colour: [&'a [T]; 3],
    pub(crate) distance: &'a [T],
    pub(crate) transmittance: &'a [T],
}

/// From the gradient of a row of tiles to the gradients of its footprints: one [`Sums`] for each of them, added to `sums`; gives the
/// gradient of the background.
///
/// With `s = g · (colour, distance)` of each splat, the loss changes with α_i by `T_i s_i - R_i / (1 - α_i)`, where R_i is
/// what splats behind, and the background, add to `g · pixel`. R is taken down from the front, so that nothing of the
/// rendering needs to be kept.
pub(crate) struct Undraw<'a, T> {
    pub(crate) source: Source<'a, T>,
    pub(crate) rendered: Planes<'a, T>,
    pub(crate) gradient: Planes<'a, T>,
    pub(crate) sums: &'a mut [Sums<T>],
}

impl<T: Scalar> Work for Undraw<'_, T> {
    type Output = [T; 3];

    #[inline(always)]
    fn run(self) -> [T; 3] {
        let rows = self.rendered.transmittance.len() / self.source.width;
        let mut background = [T::ZERO; 3];
        for column in 0..self.source.tiles.across {
            let range = self.source.tiles.range(self.source.row * self.source.tiles.across + column);
            let mut light = Light::new(&self, column, rows, &mut background);
            let (left, top) = (column * SIDE, self.source.row * SIDE);
            for some in self.source.tiles.entries[range].chunks(LOOK) {
                for entry in some {
                    let found = light.take(&self.source.footprints[entry.footprint as usize], left, top);
                    self.sums[entry.of_row as usize].add(&found);
                }
                if !any_light(&light.transmittance) {
                    break;
                }
            }
        }
        background
    }
}

/// A tile on the way back.
struct Light<T> {
    colour: [Plane<T>; 3],
    distance: Plane<T>,
    transmittance: Plane<T>,
    /// R: what is still to come.
    rest: Plane<T>,
}

impl<T: Scalar> Light<T> {
    #[inline(always)]
    fn new(undraw: &Undraw<'_, T>, column: usize, rows: usize, background: &mut [T; 3]) -> Self {
        let nothing = [[T::ZERO; LANES]; PAIRS];
        let width = undraw.source.width;
        let left = column * SIDE;
        let mut light = Self {
            colour: [nothing; 3],
            distance: nothing,
            transmittance: clear(rows, width - left),
            rest: nothing,
        };
        for y in 0..rows {
            for k in 0..(width - left).min(SIDE) {
                let at = y * width + left + k;
                let (pair, lane) = (y / 2, y % 2 * SIDE + k);
                let transmittance = undraw.rendered.transmittance[at];
                let mut rest = undraw.gradient.distance[at] * undraw.rendered.distance[at]
                    + undraw.gradient.transmittance[at] * transmittance;
                for c in 0..3 {
                    let of_colour = undraw.gradient.colour[c][at];
                    light.colour[c][pair][lane] = of_colour;
                    rest += of_colour * undraw.rendered.colour[c][at];
                    background[c] += of_colour * transmittance;
                }
                light.distance[pair][lane] = undraw.gradient.distance[at];
                light.rest[pair][lane] = rest;
            }
        }
        light
    }

    #[inline(always)]
    fn take(&mut self, footprint: &Footprint<T>, left: usize, top: usize) -> Sums<T> {
        let (last, most) = (T::of(LAST_LIGHT), T::of(MOST_HIDDEN));
        let bell = Bell::new(footprint, left, top);
        // Colours, distance, and v times 1, dy and dy²: dx is the same in all rows, and comes in at the end.
        let mut sums = [[T::ZERO; LANES]; 7];
        for pair in pairs_reached(footprint, top) {
            let dy = bell.dy(pair);
            let hidden = bell.hidden(footprint, &dy);
            let (transmittance, rest) = (&mut self.transmittance[pair], &mut self.rest[pair]);
            for k in 0..LANES {
                let alpha = hidden[k].at_most(most);
                let taken = if transmittance[k] >= last { alpha } else { T::ZERO };
                let weight = transmittance[k] * taken;
                let own = footprint.colour[0] * self.colour[0][pair][k]
                    + footprint.colour[1] * self.colour[1][pair][k]
                    + footprint.colour[2] * self.colour[2][pair][k]
                    + footprint.distance * self.distance[pair][k];
                rest[k] -= weight * own;
                let v = taken * (transmittance[k] * own - rest[k] / (T::ONE - taken));
                // Where it is cut off, its bell changes nothing.
                let v = if hidden[k] <= most { v } else { T::ZERO };
                transmittance[k] -= weight;
                for c in 0..3 {
                    sums[c][k] += weight * self.colour[c][pair][k];
                }
                sums[3][k] += weight * self.distance[pair][k];
                let down = v * dy[k];
                sums[4][k] += v;
                sums[5][k] += down;
                sums[6][k] += down * dy[k];
            }
        }
        let [red, green, blue, distance, v, down, downs] = sums;
        let (mut across, mut squares, mut both) = ([T::ZERO; LANES], [T::ZERO; LANES], [T::ZERO; LANES]);
        for k in 0..LANES {
            across[k] = v[k] * bell.dx[k];
            squares[k] = across[k] * bell.dx[k];
            both[k] = down[k] * bell.dx[k];
        }
        Sums {
            colour: [total(&red), total(&green), total(&blue)],
            distance: total(&distance),
            moments: [total(&v), total(&across), total(&down), total(&squares), total(&both), total(&downs)],
        }
    }
}

/// The sum of a lane, in one order: halves are added to each other, as vectors do it best. Without closures: in what the
/// compiler does not inline, it would not use the vectors.
#[inline(always)]
fn total<T: Scalar>(lane: &Lane<T>) -> T {
    let mut eight = [T::ZERO; LANES / 2];
    for k in 0..LANES / 2 {
        eight[k] = lane[k] + lane[k + LANES / 2];
    }
    let mut four = [T::ZERO; LANES / 4];
    for k in 0..LANES / 4 {
        four[k] = eight[k] + eight[k + LANES / 4];
    }
    (four[0] + four[2]) + (four[1] + four[3])
}
