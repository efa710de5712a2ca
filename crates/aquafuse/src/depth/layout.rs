//! Depth from the layout of an upright image: what is higher up is farther, corrected by colour.

mod box_mean;

use super::DARK;
use crate::image::{ImageRef, Sample, TopEdge};
use box_mean::box_mean;

/// Weights of the three cues: log ratio, likeness to the top, height in the image. Chosen on the measured
/// pairs of `cargo lab depth`; height leads, because it is the cue that open sea floor obeys best.
const WEIGHTS: [f64; 3] = [1.3, 1.0, 2.0];
/// Added to R + G + B, so that the hue of black is that of grey and not of its noise.
const DARK_SUM: f64 = 0.05;
/// The box that smooths the colour cues is about this share of the width.
const BOX_SHARE: usize = 16;
/// The score at this share of the pixels from either end is 0 or 1: a few odd ones must not set the scale.
const CUT: f64 = 0.01;
/// One in cues held as whole numbers. Sums of whole numbers do not depend on their order, so the
/// mirror image has bit for bit the mirrored depth; 2^16 keeps the sums of squares of any image in 64 bits.
const ONE: f64 = 65536.0;

/// The level of each pixel of an image whose edge `top` is up.
pub(super) fn levels<T: Sample>(image: ImageRef<'_, T>, top: TopEdge) -> Vec<u8> {
    let (width, height) = image.size();
    let seen = Seen { width, height, top };
    let pixels: Vec<[u8; 3]> = image.pixels().map(|pixel| pixel.map(T::to_byte)).collect();
    let reach = seen.width_as_seen() / (2 * BOX_SHARE);
    let smooth = |cue: Vec<i32>| Standard::of(box_mean(width, height, reach, &cue));
    let ratio = smooth(log_ratio(&pixels));
    let likeness = smooth(likeness_to(top_colour(&pixels, &seen), &pixels));
    let [by_ratio, by_likeness, by_height] = WEIGHTS;
    let scores: Vec<f64> = (0..pixels.len())
        .map(|i| by_ratio * ratio.at(i) + by_likeness * likeness.at(i) + by_height * seen.height_at(i))
        .collect();
    stretch(&scores)
}

/// `l = ln((M + e) / (R + e)) / ln((1 + e) / e)`, not clipped at 0, in steps of 1 / [`ONE`].
fn log_ratio(pixels: &[[u8; 3]]) -> Vec<i32> {
    let whole_range = ((1.0 + DARK) / DARK).ln();
    let table: [i32; 256] =
        std::array::from_fn(|v| (ONE * (v as f64 / 255.0 + DARK).ln() / whole_range).round() as i32);
    pixels.iter().map(|&[r, g, b]| table[usize::from(g.max(b))] - table[usize::from(r)]).collect()
}

/// `c = -|U / (ΣU + .05) - T / (ΣT + .05)|`: how like the hue of the top a pixel is, 0 for the same.
fn likeness_to(top: [u8; 3], pixels: &[[u8; 3]]) -> Vec<i32> {
    let hue = |pixel: [u8; 3]| {
        let colour = pixel.map(|value| f64::from(value) / 255.0);
        let sum = colour[0] + colour[1] + colour[2] + DARK_SUM;
        colour.map(|value| value / sum)
    };
    let top = hue(top);
    let distance = |pixel: [u8; 3]| {
        let hue = hue(pixel);
        (0..3).map(|c| (hue[c] - top[c]).powi(2)).sum::<f64>().sqrt()
    };
    pixels.iter().map(|&pixel| -(ONE * distance(pixel)).round() as i32).collect()
}

/// T: the median of each channel over the top tenth of the image as seen, one row of it at least.
fn top_colour(pixels: &[[u8; 3]], seen: &Seen) -> [u8; 3] {
    let rows = seen.rows_as_seen().div_ceil(10);
    let mut counts = [[0_usize; 256]; 3];
    let mut total = 0;
    for (_, pixel) in pixels.iter().enumerate().filter(|&(i, _)| seen.row_as_seen(i) < rows) {
        total += 1;
        for c in 0..3 {
            counts[c][usize::from(pixel[c])] += 1;
        }
    }
    counts.map(|counts| {
        let mut below = 0;
        let median = counts.iter().position(|&count| {
            below += count;
            2 * below >= total
        });
        median.unwrap_or_default() as u8
    })
}

/// An image's size, and which way up it is.
struct Seen {
    width: usize,
    height: usize,
    top: TopEdge,
}

impl Seen {
    fn on_its_side(&self) -> bool {
        matches!(self.top, TopEdge::Left | TopEdge::Right)
    }

    fn width_as_seen(&self) -> usize {
        if self.on_its_side() { self.height } else { self.width }
    }

    fn rows_as_seen(&self) -> usize {
        if self.on_its_side() { self.width } else { self.height }
    }

    /// Rows between the top as seen and stored pixel `i`.
    fn row_as_seen(&self, i: usize) -> usize {
        let (x, y) = (i % self.width, i / self.width);
        match self.top {
            TopEdge::First => y,
            TopEdge::Last => self.height - 1 - y,
            TopEdge::Left => x,
            TopEdge::Right => self.width - 1 - x,
        }
    }

    /// Height in the image, n(y): mean 0 and deviation 1 over the image, largest at the top.
    fn height_at(&self, i: usize) -> f64 {
        let rows = self.rows_as_seen() as f64;
        if rows < 2.0 {
            return 0.0;
        }
        ((rows - 1.0) / 2.0 - self.row_as_seen(i) as f64) / ((rows * rows - 1.0) / 12.0).sqrt()
    }
}

/// A cue less its mean, over its deviation; 0 everywhere where it distinguishes nothing.
struct Standard {
    values: Vec<i32>,
    mean: f64,
    scale: f64,
}

impl Standard {
    fn of(values: Vec<i32>) -> Self {
        let count = values.len() as f64;
        let sum: i64 = values.iter().map(|&value| i64::from(value)).sum();
        let squares: i64 = values.iter().map(|&value| i64::from(value).pow(2)).sum();
        let mean = sum as f64 / count;
        let variance = squares as f64 / count - mean * mean;
        // A tenth of a step: less is the rounding of a difference of two large sums.
        let scale = if variance > 0.01 { variance.sqrt().recip() } else { 0.0 };
        Self { values, mean, scale }
    }

    fn at(&self, i: usize) -> f64 {
        (f64::from(self.values[i]) - self.mean) * self.scale
    }
}

/// Levels of scores: from the first to the last hundredth, clipped. A flat image is near.
fn stretch(scores: &[f64]) -> Vec<u8> {
    let mut sorted = scores.to_vec();
    let mut rank = |share: f64| {
        let rank = (share * (scores.len() - 1) as f64).round() as usize;
        *sorted.select_nth_unstable_by(rank, f64::total_cmp).1
    };
    let (low, high) = (rank(CUT), rank(1.0 - CUT));
    let scale = if high > low { 255.0 / (high - low) } else { 0.0 };
    scores.iter().map(|score| ((score - low) * scale).clamp(0.0, 255.0).round() as u8).collect()
}

#[cfg(test)]
mod tests;
