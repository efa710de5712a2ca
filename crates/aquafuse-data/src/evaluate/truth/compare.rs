//! A result beside the truths and its content.

use aquafuse::image::{Encoding, Image};
use aquafuse::metrics::ssim;
use aquafuse::truth::Exchange;

/// What is found of one result; the first of two is about truth A, the second about truth B.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    /// Share of the true change.
    pub(super) share: [f64; 2],
    /// To the truth, in steps of 255, in the encoding of the exchange.
    pub(super) rmse: [f64; 2],
    /// SSIM with the content, as a camera would store both.
    pub(super) structure: f64,
}

impl Found {
    /// Compares what `fused` makes of each pixel, by its place and colour, before clipping.
    pub(super) fn of<E: Encoding>(
        exchange: &Exchange<E>,
        fused: impl Fn(usize, [f32; 3]) -> [f32; 3],
    ) -> Self {
        let content = &exchange.content.image;
        let (mut after, mut before) = ([0.0_f64; 2], [0.0_f64; 2]);
        let mut shown = Vec::with_capacity(content.as_raw().len());
        for (i, bytes) in content.pixels().iter().enumerate() {
            let pixel = bytes.map(|value| E::from_encoded(f32::from(value) / 255.0));
            let made = fused(i, pixel);
            shown.extend(made.map(|value| E::to_encoded(value.max(0.0))));
            for (t, truth) in exchange.truths.iter().enumerate() {
                for c in 0..3 {
                    let truth = truth.pixels()[i][c];
                    after[t] += f64::from(made[c] - truth).powi(2);
                    before[t] += f64::from(pixel[c] - truth).powi(2);
                }
            }
        }
        let values = content.as_raw().len() as f64;
        let (width, height) = content.size();
        let shown = Image::<f32>::from_raw(width, height, shown).expect("a colour for each pixel");
        let structure = ssim(content, &shown.convert::<u8>()).expect("of one size");
        Self {
            share: std::array::from_fn(|t| 1.0 - (after[t] / before[t]).sqrt()),
            rmse: after.map(|sum| 255.0 * (sum / values).sqrt()),
            structure: structure.expect("scenes are larger than the window"),
        }
    }
}
