//! How far a rendering is from an image, and in which direction it would come nearer: L1 and structural similarity.

use aquafuse::simd::{Work, widest};
use rayon::prelude::*;

use crate::render::Rendering;
use crate::scalar::Scalar;

/// Deviation of the Gaussian window of SSIM, and its reach to either side: 11 x 11.
const SIGMA: f64 = 1.5;
const REACH: usize = 5;
const TAPS: usize = 2 * REACH + 1;
const C1: f64 = 0.01 * 0.01;
const C2: f64 = 0.03 * 0.03;

/// An image to come near to, with what SSIM needs to know of it: computed once, used every time the view is shown.
#[derive(Clone, Debug)]
pub struct Target<T> {
    width: usize,
    height: usize,
    planes: [Channel<T>; 3],
}

#[derive(Clone, Debug)]
struct Channel<T> {
    values: Vec<T>,
    /// Of the values in the window around each pixel, with zeros beyond the edge.
    mean: Vec<T>,
    /// Of their squares.
    square: Vec<T>,
}

impl<T: Scalar> Target<T> {
    /// Takes `width * height` colours in [0, 1], rows from the top.
    ///
    /// # Panics
    ///
    /// When there are more or fewer.
    pub fn new(width: usize, height: usize, pixels: &[[f32; 3]]) -> Self {
        assert_eq!(pixels.len(), width * height, "one colour a pixel");
        let channel = |c: usize| {
            let values: Vec<T> = pixels.iter().map(|pixel| T::of(f64::from(pixel[c]))).collect();
            let square = values.iter().map(|&v| v * v).collect();
            let mut scratch = vec![T::ZERO; values.len()];
            let mut mean = values.clone();
            let mut square: Vec<T> = square;
            blur(&mut mean, &mut scratch, width);
            blur(&mut square, &mut scratch, width);
            Channel { values, mean, square }
        };
        Self { width, height, planes: [channel(0), channel(1), channel(2)] }
    }

    /// Columns and rows.
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// The colour at a place between the middles of pixels, which are whole numbers; the place lies in the image.
    pub(crate) fn between(&self, x: f64, y: f64) -> [T; 3] {
        let (left, top) = (x as usize, y as usize);
        let (right, below) = ((left + 1).min(self.width - 1), (top + 1).min(self.height - 1));
        let (across, down) = (T::of(x - left as f64), T::of(y - top as f64));
        std::array::from_fn(|c| {
            let at = |x: usize, y: usize| self.planes[c].values[y * self.width + x];
            let row = |y: usize| at(left, y) * (T::ONE - across) + at(right, y) * across;
            row(top) * (T::ONE - down) + row(below) * down
        })
    }

    /// Whether no channel of a pixel differs by more than `within` from a colour.
    pub(crate) fn is_near(&self, pixel: usize, colour: [T; 3], within: T) -> bool {
        self.planes
            .iter()
            .zip(colour)
            .all(|(channel, value)| (channel.values[pixel] - value).magnitude() <= within)
    }

    /// All values, channel by channel.
    pub(crate) fn values(&self) -> impl Iterator<Item = T> {
        self.planes.iter().flat_map(|channel| channel.values.iter().copied())
    }
}

/// A loss and what it is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loss {
    /// (1 - λ) L1 + λ (1 - SSIM).
    pub total: f64,
    /// Mean difference of values, without sign.
    pub l1: f64,
    /// Structural similarity, mean over pixels and channels, zeros beyond the edge.
    pub ssim: f64,
}

/// `(1 - λ) L1 + λ (1 - SSIM)` of a rendering, as published with λ = .2, and its gradient with respect to the colours.
///
/// # Panics
///
/// When the sizes differ.
pub fn loss<T: Scalar>(rendering: &Rendering<T>, target: &Target<T>, lambda: f64) -> (Loss, Rendering<T>) {
    assert_eq!((rendering.width, rendering.height), target.size(), "one size");
    let width = target.width;
    let count = 3.0 * (width * target.height) as f64;
    let channels: Vec<(f64, f64, Vec<T>)> = rendering
        .colour
        .par_iter()
        .zip(&target.planes)
        .map(|(values, channel)| one_channel(values, channel, width, lambda, count))
        .collect();
    let (l1, ssim) =
        channels.iter().fold((0.0, 0.0), |(l1, ssim), channel| (l1 + channel.0, ssim + channel.1));
    let (l1, ssim) = (l1 / count, ssim / count);
    let nothing = vec![T::ZERO; width * target.height];
    let mut colours = channels.into_iter().map(|(.., gradient)| gradient);
    let gradient = Rendering {
        width,
        height: target.height,
        colour: std::array::from_fn(|_| colours.next().unwrap_or_default()),
        distance: nothing.clone(),
        transmittance: nothing,
    };
    (Loss { total: (1.0 - lambda) * l1 + lambda * (1.0 - ssim), l1, ssim }, gradient)
}

/// The sums of |difference| and SSIM over a channel, and the gradient.
fn one_channel<T: Scalar>(
    values: &[T],
    channel: &Channel<T>,
    width: usize,
    lambda: f64,
    count: f64,
) -> (f64, f64, Vec<T>) {
    let mut scratch = vec![T::ZERO; values.len()];
    let mut mean = values.to_vec();
    let mut square: Vec<T> = values.iter().map(|&v| v * v).collect();
    let mut product: Vec<T> = values.iter().zip(&channel.values).map(|(&a, &b)| a * b).collect();
    for plane in [&mut mean, &mut square, &mut product] {
        blur(plane, &mut scratch, width);
    }
    // From here on the three planes hold the gradient of SSIM with respect to themselves.
    let ssim = widest(Similarity { mean: &mut mean, square: &mut square, product: &mut product, channel });
    for plane in [&mut mean, &mut square, &mut product] {
        blur(plane, &mut scratch, width);
    }
    let (of_l1, of_ssim) = (T::of((1.0 - lambda) / count), T::of(-lambda / count));
    let mut l1 = 0.0;
    let two = T::of(2.0);
    let gradient = (0..values.len()).map(|i| {
        let (x, y) = (values[i], channel.values[i]);
        let difference = x - y;
        l1 += difference.magnitude().get();
        let sign = if difference > T::ZERO {
            T::ONE
        } else if difference < T::ZERO {
            -T::ONE
        } else {
            T::ZERO
        };
        of_l1 * sign + of_ssim * (mean[i] + two * x * square[i] + y * product[i])
    });
    let gradient = gradient.collect();
    (l1, ssim, gradient)
}

/// SSIM at each pixel; turns its inputs into its gradient.
struct Similarity<'a, T> {
    mean: &'a mut [T],
    square: &'a mut [T],
    product: &'a mut [T],
    channel: &'a Channel<T>,
}

impl<T: Scalar> Work for Similarity<'_, T> {
    type Output = f64;

    #[inline(always)]
    fn run(self) -> f64 {
        let (c1, c2, two) = (T::of(C1), T::of(C2), T::of(2.0));
        let (channel_mean, channel_square) = (&self.channel.mean[..self.mean.len()], &self.channel.square);
        let channel_square = &channel_square[..self.mean.len()];
        let (square, product) = (&mut self.square[..self.mean.len()], &mut self.product[..self.mean.len()]);
        // One sum a lane: a single one would be computed number by number.
        let mut sums = [0.0; LANES];
        for i in 0..self.mean.len() {
            let (mx, my) = (self.mean[i], channel_mean[i]);
            let luminance = two * mx * my + c1;
            let structure = two * (product[i] - mx * my) + c2;
            let by_mean = T::ONE / (mx * mx + my * my + c1);
            let by_spread = T::ONE / ((square[i] - mx * mx) + (channel_square[i] - my * my) + c2);
            let index = luminance * structure * by_mean * by_spread;
            sums[i % LANES] += index.get();
            self.mean[i] = two * my * by_mean * by_spread * (structure - luminance)
                + two * mx * index * (by_spread - by_mean);
            square[i] = -index * by_spread;
            product[i] = two * luminance * by_mean * by_spread;
        }
        sums.iter().sum()
    }
}

const LANES: usize = 4;

/// The window's weights.
fn bell() -> [f64; TAPS] {
    let raw: [f64; TAPS] = std::array::from_fn(|i| {
        let off = i as f64 - REACH as f64;
        (-off * off / (2.0 * SIGMA * SIGMA)).exp()
    });
    let sum: f64 = raw.iter().sum();
    raw.map(|weight| weight / sum)
}

/// Blurs a plane by the window, zeros beyond its edge: rows into `scratch`, then columns back.
fn blur<T: Scalar>(plane: &mut [T], scratch: &mut [T], width: usize) {
    let bell = bell().map(T::of);
    widest(Blur { plane, scratch, width, bell });
}

struct Blur<'a, T> {
    plane: &'a mut [T],
    scratch: &'a mut [T],
    width: usize,
    bell: [T; TAPS],
}

impl<T: Scalar> Work for Blur<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let width = self.width;
        let rows = self.plane.len() / width;
        let mut padded = vec![T::ZERO; width + 2 * REACH];
        for (row, out) in self.plane.chunks_exact(width).zip(self.scratch.chunks_exact_mut(width)) {
            padded[REACH..][..width].copy_from_slice(row);
            weigh(out, |tap| &padded[tap..], &self.bell, 0..TAPS);
        }
        for (y, out) in self.plane.chunks_exact_mut(width).enumerate() {
            let taps = REACH.saturating_sub(y)..(rows + REACH - y).min(TAPS);
            let first = (y + taps.start - REACH) * width;
            let above = &self.scratch[first..first + taps.len() * width];
            let begin = taps.start;
            weigh(out, |tap| &above[(tap - begin) * width..], &self.bell, taps);
        }
    }
}

/// Pixels that are summed at a time, in registers.
const BLOCK: usize = 64;

/// Sums the window's lines, weighed: `line` gives for each tap the numbers that lie on one another.
#[inline(always)]
fn weigh<'a, T: Scalar>(
    out: &mut [T],
    line: impl Fn(usize) -> &'a [T],
    bell: &[T; TAPS],
    taps: std::ops::Range<usize>,
) {
    let width = out.len();
    if width < BLOCK {
        for (k, out) in out.iter_mut().enumerate() {
            *out = taps.clone().fold(T::ZERO, |sum, tap| sum + bell[tap] * line(tap)[k]);
        }
        return;
    }
    // The last block ends at the edge, and sums some pixels of the one before it once more.
    for first in (0..width).step_by(BLOCK).map(|first| first.min(width - BLOCK)) {
        let mut sums = [T::ZERO; BLOCK];
        for tap in taps.clone() {
            let line = &line(tap)[first..][..BLOCK];
            for k in 0..BLOCK {
                sums[k] += bell[tap] * line[k];
            }
        }
        out[first..][..BLOCK].copy_from_slice(&sums);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(width: usize, height: usize, seed: u32) -> Vec<[f32; 3]> {
        let mut state = seed;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 24) as f32
        };
        (0..width * height).map(|_| [next(), next(), next()]).collect()
    }

    fn rendered(width: usize, height: usize, pixels: &[[f32; 3]]) -> Rendering<f64> {
        let mut rendering = Rendering::zeros(width, height);
        for c in 0..3 {
            rendering.colour[c] = pixels.iter().map(|pixel| f64::from(pixel[c])).collect();
        }
        rendering
    }

    #[test]
    fn a_drawing_that_is_the_image_has_no_loss() {
        let pixels = image(23, 17, 1);
        let (found, _) = loss(&rendered(23, 17, &pixels), &Target::new(23, 17, &pixels), 0.2);
        assert!(found.total.abs() < 1e-12 && (found.ssim - 1.0).abs() < 1e-12, "{found:?}");
    }

    #[test]
    fn the_gradient_is_that_of_finite_differences() {
        let (width, height) = (19, 14);
        let target = Target::<f64>::new(width, height, &image(width, height, 2));
        let mut rendering = rendered(width, height, &image(width, height, 3));
        let (_, gradient) = loss(&rendering, &target, 0.2);
        for i in (0..width * height).step_by(7) {
            for c in 0..3 {
                let at = rendering.colour[c][i];
                let mut moved = |by: f64| {
                    rendering.colour[c][i] = at + by;
                    loss(&rendering, &target, 0.2).0.total
                };
                let slope = (moved(1e-6) - moved(-1e-6)) / 2e-6;
                rendering.colour[c][i] = at;
                let found = gradient.colour[c][i];
                assert!((slope - found).abs() < 1e-6 * slope.abs().max(1e-4), "{i} {c}: {slope} {found}");
            }
        }
    }

    #[test]
    fn the_window_keeps_what_is_even_inside_and_loses_some_at_the_edge() {
        let mut plane = vec![1.0; 30 * 20];
        blur(&mut plane, &mut vec![0.0; 30 * 20], 30);
        assert!((plane[10 * 30 + 15] - 1.0_f64).abs() < 1e-12);
        assert!(plane[0] < 0.5);
    }
}
