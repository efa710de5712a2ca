//! The levels of an image, read off some of its values.

use super::power::power;
use super::{
    Before, CALM, CLIPPED, EXPONENTS, HEADROOM, LUMA, Levels, LevelsOptions, MEAN, MOST_GAIN, RED_FROM_GREEN,
    Setting, TOWARDS_MEAN, unit,
};
use crate::image::{ImageRef, Kernels, Sample};

/// Pixels looked at.
const SAMPLES: usize = 1 << 15;
/// Levels of channels without contrast, or without light, are measured to no less than this.
const LEAST: f32 = 1e-3;
/// Halvings of the range of exponents: to a thousandth.
const HALVINGS: usize = 11;

/// Values of red, green and blue.
pub(super) type Channels = [Vec<f32>; 3];

/// What becomes of some rows `before` their levels are set, within `[0, 1]`.
pub(super) fn channels<T: Sample>(image: ImageRef<'_, T>, before: &impl Before) -> Channels {
    let mut channels = [const { Vec::new() }; 3];
    for (y, row) in image.sampled_rows(SAMPLES) {
        for (x, pixel) in row.iter().enumerate() {
            let value = before.at(x, y, pixel.map(Sample::to_unit));
            (0..3).for_each(|c| channels[c].push(unit(value[c])));
        }
    }
    channels
}

/// The levels of these values, which are changed on the way.
pub(super) fn levels(channels: &mut Channels, options: &LevelsOptions, hold_red: bool) -> Levels {
    let LevelsOptions { white, exposure, strength } = *options;
    let apart = white == Setting::Auto;
    let exposed = exposure == Setting::Auto;
    let [mut black, mut bright] = ends(channels);
    if !apart {
        black = [black.into_iter().fold(1.0, f32::min); 3];
        bright = [bright.into_iter().fold(0.0, f32::max); 3];
    }
    // Without exposure the brightest channel stays, and the others come up to it.
    let top = if exposed { 1.0 } else { bright.into_iter().fold(LEAST, f32::max) };
    if exposed {
        bright = bright.map(|bright| bright + HEADROOM * (1.0 - bright));
    } else {
        black = [0.0; 3];
    }
    let gain = [0, 1, 2].map(|c| (top / (bright[c] - black[c]).max(LEAST)).min(MOST_GAIN));
    for (c, values) in channels.iter_mut().enumerate() {
        values.iter_mut().for_each(|value| *value = unit((*value - black[c]) * gain[c]));
    }
    let [red, green, _] = channels.each_ref().map(|values| mean(values));
    let red_from_green = if apart { RED_FROM_GREEN * (green - red).max(0.0) } else { 0.0 };
    let [reds, greens, _] = channels;
    for (red, green) in reds.iter_mut().zip(greens) {
        *red += red_from_green * (1.0 - *red) * *green;
    }
    let mut means = channels.each_ref().map(|values| mean(values));
    if !apart {
        means = [(0..3).map(|c| LUMA[c] * means[c]).sum(); 3];
    }
    let exponent = if exposed { means.map(towards_mean) } else { [1.0; 3] };
    Levels {
        black,
        gain,
        red_from_green,
        exponent,
        colour: if apart { CALM } else { 1.0 },
        holds_red: apart && hold_red,
        strength: unit(strength),
    }
}

fn towards_mean(mean: f32) -> f32 {
    let ratio = MEAN.ln() / mean.clamp(LEAST, 1.0 - LEAST).ln();
    ratio.powf(TOWARDS_MEAN).clamp(EXPONENTS[0], EXPONENTS[1])
}

fn mean(values: &[f32]) -> f32 {
    mean_of(values.iter().copied())
}

/// A mean that does not depend on the order of the values.
fn mean_of(values: impl ExactSizeIterator<Item = f32>) -> f32 {
    let count = values.len().max(1) as f64;
    let steps: u64 = values.map(Kernels::to_steps).sum();
    (f64::from(f32::from_steps(1)) * steps as f64 / count) as f32
}

/// The mean lightness of values raised to `exponent`.
pub(super) fn lightness(channels: &Channels, exponent: f32) -> f32 {
    let raised = |c: usize| mean_of(channels[c].iter().map(|&value| power(value, exponent)));
    (0..3).map(|c| LUMA[c] * raised(c)).sum()
}

/// The exponent at which values have this mean lightness, as far as bounds allow.
pub(super) fn exponent_for(channels: &Channels, wanted: f32) -> f32 {
    // The larger the exponent, the darker.
    let [mut least, mut most] = EXPONENTS;
    for _ in 0..HALVINGS {
        let middle = 0.5 * (least + most);
        if lightness(channels, middle) > wanted { least = middle } else { most = middle }
    }
    0.5 * (least + most)
}

/// The value that this share does not exceed.
fn percentile(values: &mut [f32], share: f64) -> f32 {
    let rank = ((values.len() - 1) as f64 * share).round() as usize;
    *values.select_nth_unstable_by(rank, f32::total_cmp).1
}

/// Black and bright of each channel.
fn ends(channels: &Channels) -> [[f32; 3]; 2] {
    // Copies, because a search changes the order, and a pixel's values belong together.
    let mut sorted = channels.clone();
    [CLIPPED, 1.0 - CLIPPED].map(|share| sorted.each_mut().map(|values| percentile(values, share)))
}
