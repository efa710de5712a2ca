//! The bilateral filter on bytes: rows of one channel each, many pixels at once.
//!
//! The weight between two pixels is the same seen from either, so that half the window is weighed: the weights of a
//! row are kept until the second row after it is done.

use super::weights::{AHEAD, ONE, RADIUS, mirrored, weight};
use crate::bands;
use crate::simd::{self, Level, Work};

/// Pixels whose sums are made together.
const LANES: usize = 16;
/// Rows of the window.
const ROWS: usize = 2 * RADIUS + 1;
/// Rows whose weights reach the row in the middle.
const KEPT: usize = RADIUS + 1;

/// Smooths a picture of `width` columns into `smoothed`.
pub(super) fn smooth(width: usize, values: &[u8], smoothed: &mut [u8]) {
    smooth_by(Level::best(), width, values, smoothed);
}

fn smooth_by(level: Level, width: usize, values: &[u8], smoothed: &mut [u8]) {
    bands::for_each(smoothed, 3 * width, |first, band| {
        simd::widest_by(level, Band { width, values, first, smoothed: band });
    });
}

struct Band<'a> {
    width: usize,
    values: &'a [u8],
    first: usize,
    smoothed: &'a mut [u8],
}

/// A row by channel, mirrored beyond both ends.
type Row = [Vec<u8>; 3];
/// Weights of a row's pixels with those at each place ahead.
type RowWeights = [Vec<u16>; AHEAD.len()];

impl Work for Band<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { width, values, first, smoothed } = self;
        let height = values.len() / (3 * width);
        let padded = width.next_multiple_of(LANES) + 2 * RADIUS;
        let mut rows: [Row; ROWS] = std::array::from_fn(|_| std::array::from_fn(|_| vec![0; padded]));
        let mut kept: [RowWeights; KEPT] = std::array::from_fn(|_| std::array::from_fn(|_| vec![0; padded]));
        let mut differences = vec![0; padded];
        let count = smoothed.len() / (3 * width);
        // Counted from the first row above the band that is read.
        for ahead in 0..count + 2 * RADIUS {
            let y = mirrored((first + ahead) as isize - RADIUS as isize, height);
            split(&values[3 * width * y..][..3 * width], &mut rows[ahead % ROWS]);
            let Some(row) = ahead.checked_sub(RADIUS) else { continue };
            for (place, &(dx, dy)) in AHEAD.iter().enumerate() {
                let pair = [&rows[row % ROWS], &rows[(row + dy) % ROWS]];
                let found = &mut kept[row % KEPT][place];
                weigh(pair, dx, &mut differences, found);
            }
            let Some(done) = row.checked_sub(RADIUS) else { continue };
            average(row, &rows, &kept, &mut smoothed[3 * width * done..][..3 * width]);
        }
    }
}

/// Takes a row apart.
#[inline(always)]
fn split(pixels: &[u8], row: &mut Row) {
    let width = pixels.len() / 3;
    let (pixels, _) = pixels.as_chunks::<3>();
    let [r, g, b] = row.each_mut().map(|channel| &mut channel[RADIUS..RADIUS + width]);
    for (((r, g), b), pixel) in r.iter_mut().zip(g).zip(b).zip(pixels) {
        (*r, *g, *b) = (pixel[0], pixel[1], pixel[2]);
    }
    for channel in row {
        for beyond in 1..=RADIUS as isize {
            for place in [-beyond, width as isize - 1 + beyond] {
                channel[(place + RADIUS as isize) as usize] = channel[RADIUS + mirrored(place, width)];
            }
        }
    }
}

/// The weights of the first row's pixels with those of the second, `dx` columns on.
#[inline(always)]
fn weigh([row, other]: [&Row; 2], dx: isize, differences: &mut [u16], found: &mut [u16]) {
    let (left, right) = (dx.min(0).unsigned_abs(), dx.max(0).unsigned_abs());
    let length = differences.len() - left - right;
    let differences = &mut differences[..length];
    let [r, g, b] = [0, 1, 2].map(|c| (&row[c][left..][..length], &other[c][right..][..length]));
    for (i, difference) in differences.iter_mut().enumerate() {
        let off = |(a, b): (&[u8], &[u8])| u16::from(a[i].abs_diff(b[i]));
        *difference = off(r) + off(g) + off(b);
    }
    for (found, &difference) in found[left..][..length].iter_mut().zip(&*differences) {
        *found = weight(difference);
    }
}

/// A place of the window: the row it is in and its weights, both from where the first pixel's stand.
#[derive(Clone, Copy)]
struct Tap<'a> {
    values: [&'a [[u8; LANES]]; 3],
    weights: &'a [[u16; LANES]],
}

/// The weighted means of a row, rounded; halves go up.
#[inline(always)]
fn average(row: usize, rows: &[Row; ROWS], kept: &[RowWeights; KEPT], smoothed: &mut [u8]) {
    let blocks_of = |row: usize, dx: isize| {
        let x = RADIUS.wrapping_add_signed(dx);
        let [r, g, b] = &rows[row % ROWS];
        [blocks(r, x), blocks(g, x), blocks(b, x)]
    };
    let weights_of = |row: usize, place: usize, x: usize| blocks(&kept[row % KEPT][place], x);
    let middle = blocks_of(row, 0);
    let mut taps = [Tap { values: middle, weights: &[] }; 2 * AHEAD.len()];
    for (place, &(dx, dy)) in AHEAD.iter().enumerate() {
        let before = RADIUS.wrapping_add_signed(-dx);
        taps[2 * place] = Tap { values: blocks_of(row + dy, dx), weights: weights_of(row, place, RADIUS) };
        taps[2 * place + 1] =
            Tap { values: blocks_of(row - dy, -dx), weights: weights_of(row - dy, place, before) };
    }
    let (pixels, _) = smoothed.as_chunks_mut::<3>();
    for (block, pixels) in pixels.chunks_mut(LANES).enumerate() {
        let mut sums = Sums::default();
        sums.add(&[ONE; LANES], &middle, block);
        for tap in &taps {
            sums.add(&tap.weights[block], &tap.values, block);
        }
        let means = sums.means();
        for (i, pixel) in pixels.iter_mut().enumerate() {
            *pixel = [means[0][i], means[1][i], means[2][i]];
        }
    }
}

#[inline(always)]
fn blocks<T>(values: &[T], x: usize) -> &[[T; LANES]] {
    values[x..].as_chunks().0
}

/// 2^23: floats from here to its double are whole numbers, whose last bits are those of the float.
const NO_PART: f32 = 8_388_608.0;

/// Weighted sums of the channels and the sum of the weights.
#[derive(Default)]
struct Sums {
    of_channel: [[i32; LANES]; 3],
    total: [i32; LANES],
}

impl Sums {
    #[inline(always)]
    fn add(&mut self, weights: &[u16; LANES], values: &[&[[u8; LANES]]; 3], block: usize) {
        for i in 0..LANES {
            self.total[i] += i32::from(weights[i] as i16);
        }
        for c in 0..3 {
            let values = &values[c][block];
            for i in 0..LANES {
                self.of_channel[c][i] += i32::from(weights[i] as i16) * i32::from(values[i]);
            }
        }
    }

    /// The whole part of (sum + total / 2) / total, by floats. Half a step more keeps the quotient off whole numbers by
    /// more than it is rounded: 2^-16 at most, where 1 / 2 total is more. To add 2^23 then leaves no room for a part.
    #[inline(always)]
    fn means(&self) -> [[u8; LANES]; 3] {
        let mut means = [[0; LANES]; 3];
        for c in 0..3 {
            for i in 0..LANES {
                let above = (self.of_channel[c][i] + self.total[i] / 2) as f32 + 0.5;
                means[c][i] = (above / self.total[i] as f32 - 0.5 + NO_PART).to_bits() as u8;
            }
        }
        means
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Image;

    #[test]
    fn many_pixels_are_smoothed_as_one_is() {
        for (width, height) in [(1, 1), (1, 9), (2, 2), (3, 70), (15, 4), (16, 5), (17, 66), (67, 130)] {
            // Near each other and far apart, so that all weights come up.
            let value = |i: usize| (i.wrapping_mul(2_654_435_761) >> 13) as u8 >> (i / 97 % 5);
            let samples: Vec<u8> = (0..3 * width * height).map(value).collect();
            let image = Image::<u8>::from_raw(width, height, samples).unwrap();
            let mean = |i: usize| super::super::mean_around(&image, i % width, i / width);
            let expected: Vec<u8> = (0..width * height).flat_map(mean).collect();
            for level in Level::all() {
                let mut found = vec![0; expected.len()];
                smooth_by(level, width, image.as_raw(), &mut found);
                assert_eq!(found, expected, "{level:?}, {width}x{height}");
            }
        }
    }

    #[test]
    fn a_mean_is_cut_off_at_the_whole_number_below() {
        // The quotients nearest to whole numbers from below, at the largest totals.
        for total in [i32::from(ONE), 13 * i32::from(ONE), 13 * i32::from(ONE) - 1, 19_997] {
            for whole in 1..=255 {
                let half = total / 2;
                for (sum, expected) in [(whole * total - half - 1, whole - 1), (whole * total - half, whole)]
                {
                    let sums = Sums { of_channel: [[sum; LANES]; 3], total: [total; LANES] };
                    assert_eq!(sums.means(), [[expected as u8; LANES]; 3], "{sum} / {total}");
                }
            }
        }
    }
}
