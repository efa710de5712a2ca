//! One row of tiles rendered front to back, and its gradients.
//!
//! Plain loops over rows of eight pixels, which the compiler makes vectors of. A pixel takes splats until less than
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

/// Numbers of one row of pixels within a tile.
type Lane<T> = [T; SIDE];

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

/// The rows of pixels of a tile that a footprint reaches, counted from the tile's first.
#[inline(always)]
fn rows_reached<T: Scalar>(footprint: &Footprint<T>, top: usize, rows: usize) -> std::ops::Range<usize> {
    let (middle, reach) = (footprint.mean[1].get() - top as f64, footprint.reach[1].get());
    let first = (middle - reach - 0.5).ceil().max(0.0) as usize;
    let end = (middle + reach + 0.5).floor().max(0.0) as usize;
    first.min(rows)..end.min(rows)
}

/// How much of the light a footprint hides at eight pixels in a row, and whether by its own bell: 0 where it is too
/// faint, and cut off at [`MOST_HIDDEN`].
#[inline(always)]
fn hidden<T: Scalar>(footprint: &Footprint<T>, dx: &Lane<T>, dy: T) -> (Lane<T>, Lane<T>) {
    let half = T::of(0.5);
    let [xx, xy, yy] = footprint.conic;
    let (square, slope, level) = (half * xx, xy * dy, half * yy * dy * dy);
    let (faintest, most) = (T::of(FAINTEST), T::of(MOST_HIDDEN));
    let mut alpha = [T::ZERO; SIDE];
    let mut bell = [T::ZERO; SIDE];
    for k in 0..SIDE {
        let power = -(dx[k] * (square * dx[k] + slope) + level);
        let full = footprint.opacity * power.at_most(T::ZERO).falloff();
        let seen = if full >= faintest { full } else { T::ZERO };
        alpha[k] = seen.at_most(most);
        bell[k] = if seen <= most { T::ONE } else { T::ZERO };
    }
    (alpha, bell)
}

#[inline(always)]
fn offsets<T: Scalar>(left: usize, mean: T) -> Lane<T> {
    let mut dx = [T::ZERO; SIDE];
    for k in 0..SIDE {
        dx[k] = T::of((left + k) as f64 + 0.5) - mean;
    }
    dx
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
                for k in 0..across {
                    for c in 0..3 {
                        self.strip.colour[c][at + k] =
                            tile.colour[c][y][k] + tile.transmittance[y][k] * self.source.background[c];
                    }
                    self.strip.distance[at + k] = tile.distance[y][k];
                    self.strip.transmittance[at + k] = tile.transmittance[y][k];
                }
            }
        }
    }
}

/// A tile while it is rendered.
struct Canvas<T> {
    colour: [[Lane<T>; SIDE]; 3],
    distance: [Lane<T>; SIDE],
    transmittance: [Lane<T>; SIDE],
}

impl<T: Scalar> Canvas<T> {
    #[inline(always)]
    fn rendered(source: &Source<'_, T>, column: usize, rows: usize) -> Self {
        let mut canvas = Self {
            colour: [[[T::ZERO; SIDE]; SIDE]; 3],
            distance: [[T::ZERO; SIDE]; SIDE],
            transmittance: [[T::ONE; SIDE]; SIDE],
        };
        let (left, top) = (column * SIDE, source.row * SIDE);
        let entries = &source.tiles.entries[source.tiles.range(source.row * source.tiles.across + column)];
        for some in entries.chunks(LOOK) {
            for &entry in some {
                canvas.take(&source.footprints[entry as usize], left, top, rows);
            }
            if !any_light(&canvas.transmittance[..rows]) {
                break;
            }
        }
        canvas
    }

    #[inline(always)]
    fn take(&mut self, footprint: &Footprint<T>, left: usize, top: usize, rows: usize) {
        let last = T::of(LAST_LIGHT);
        let dx = offsets(left, footprint.mean[0]);
        for y in rows_reached(footprint, top, rows) {
            let dy = T::of((top + y) as f64 + 0.5) - footprint.mean[1];
            let (alpha, _) = hidden(footprint, &dx, dy);
            let transmittance = &mut self.transmittance[y];
            let mut weight = [T::ZERO; SIDE];
            for k in 0..SIDE {
                let taken = if transmittance[k] >= last { alpha[k] } else { T::ZERO };
                weight[k] = transmittance[k] * taken;
                transmittance[k] -= weight[k];
            }
            for c in 0..3 {
                let row = &mut self.colour[c][y];
                for k in 0..SIDE {
                    row[k] += weight[k] * footprint.colour[c];
                }
            }
            let row = &mut self.distance[y];
            for k in 0..SIDE {
                row[k] += weight[k] * footprint.distance;
            }
        }
    }
}

#[inline(always)]
fn any_light<T: Scalar>(transmittance: &[Lane<T>]) -> bool {
    let mut most = T::ZERO;
    for row in transmittance {
        for k in 0..SIDE {
            most = most.at_least(row[k]);
        }
    }
    most >= T::of(LAST_LIGHT)
}

/// A row of tiles' planes for reading: a gradient, or a rendering.
#[derive(Clone, Copy)]
pub(crate) struct Planes<'a, T> {
    pub(crate) colour: [&'a [T]; 3],
    pub(crate) distance: &'a [T],
    pub(crate) transmittance: &'a [T],
}

/// From the gradient of a row of tiles to that of its footprints: one [`Sums`] for each entry of its lists, written to
/// `sums`; gives the gradient of the background.
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
        let begin = self.source.tiles.row_range(self.source.row).start;
        for column in 0..self.source.tiles.across {
            let range = self.source.tiles.range(self.source.row * self.source.tiles.across + column);
            let mut light = Light::new(&self, column, rows, &mut background);
            let (left, top) = (column * SIDE, self.source.row * SIDE);
            let entries = &self.source.tiles.entries[range.clone()];
            let sums = &mut self.sums[range.start - begin..range.end - begin];
            for (entries, sums) in entries.chunks(LOOK).zip(sums.chunks_mut(LOOK)) {
                for (&entry, sums) in entries.iter().zip(sums) {
                    *sums = light.take(&self.source.footprints[entry as usize], left, top, rows);
                }
                if !any_light(&light.transmittance[..rows]) {
                    break;
                }
            }
        }
        background
    }
}

/// A tile on the way back.
struct Light<T> {
    colour: [[Lane<T>; SIDE]; 3],
    distance: [Lane<T>; SIDE],
    transmittance: [Lane<T>; SIDE],
    /// R: what is still to come.
    rest: [Lane<T>; SIDE],
}

impl<T: Scalar> Light<T> {
    #[inline(always)]
    fn new(undraw: &Undraw<'_, T>, column: usize, rows: usize, background: &mut [T; 3]) -> Self {
        let nothing = [[T::ZERO; SIDE]; SIDE];
        let mut light = Self {
            colour: [nothing; 3],
            distance: nothing,
            transmittance: [[T::ONE; SIDE]; SIDE],
            rest: nothing,
        };
        let width = undraw.source.width;
        let left = column * SIDE;
        for y in 0..rows {
            for k in 0..(width - left).min(SIDE) {
                let at = y * width + left + k;
                let transmittance = undraw.rendered.transmittance[at];
                let mut rest = undraw.gradient.distance[at] * undraw.rendered.distance[at]
                    + undraw.gradient.transmittance[at] * transmittance;
                for c in 0..3 {
                    let of_colour = undraw.gradient.colour[c][at];
                    light.colour[c][y][k] = of_colour;
                    rest += of_colour * undraw.rendered.colour[c][at];
                    background[c] += of_colour * transmittance;
                }
                light.distance[y][k] = undraw.gradient.distance[at];
                light.rest[y][k] = rest;
            }
        }
        light
    }

    #[inline(always)]
    fn take(&mut self, footprint: &Footprint<T>, left: usize, top: usize, rows: usize) -> Sums<T> {
        let last = T::of(LAST_LIGHT);
        let dx = offsets(left, footprint.mean[0]);
        let mut colour = [[T::ZERO; SIDE]; 3];
        let mut distance = [T::ZERO; SIDE];
        let mut moments = [[T::ZERO; SIDE]; 6];
        for y in rows_reached(footprint, top, rows) {
            let dy = T::of((top + y) as f64 + 0.5) - footprint.mean[1];
            let (alpha, bell) = hidden(footprint, &dx, dy);
            let mut v = [T::ZERO; SIDE];
            for k in 0..SIDE {
                let transmittance = self.transmittance[y][k];
                let taken = if transmittance >= last { alpha[k] } else { T::ZERO };
                let weight = transmittance * taken;
                let own = footprint.colour[0] * self.colour[0][y][k]
                    + footprint.colour[1] * self.colour[1][y][k]
                    + footprint.colour[2] * self.colour[2][y][k]
                    + footprint.distance * self.distance[y][k];
                let rest = self.rest[y][k] - weight * own;
                v[k] = bell[k] * taken * (transmittance * own - rest / (T::ONE - taken));
                self.rest[y][k] = rest;
                self.transmittance[y][k] = transmittance - weight;
                for c in 0..3 {
                    colour[c][k] += weight * self.colour[c][y][k];
                }
                distance[k] += weight * self.distance[y][k];
            }
            for k in 0..SIDE {
                let across = v[k] * dx[k];
                let down = v[k] * dy;
                moments[0][k] += v[k];
                moments[1][k] += across;
                moments[2][k] += down;
                moments[3][k] += across * dx[k];
                moments[4][k] += across * dy;
                moments[5][k] += down * dy;
            }
        }
        Sums { colour: colour.map(total), distance: total(distance), moments: moments.map(total) }
    }
}

/// The sum of a lane, in one order.
#[inline(always)]
fn total<T: Scalar>(lane: Lane<T>) -> T {
    ((lane[0] + lane[1]) + (lane[2] + lane[3])) + ((lane[4] + lane[5]) + (lane[6] + lane[7]))
}
