//! The paper's scores of a fused image, and how much of the true change it makes.

use aquafuse::depth::DepthModel;
use aquafuse::image::{Encoding, Image, ImageError};
use aquafuse::metrics::{depth_rmse, psnr, ssim};
use aquafuse::truth::Exchange;

use super::reading::Reading;

/// What is said of one exchange.
pub(crate) struct Scores {
    psnr: f64,
    ssim: f64,
    /// Of Eq. 3 depth estimated again, in percent of the range.
    depth_rmse: f64,
    /// 1 - RMSE(out, truth A) / RMSE(content, truth A), in encoded values before clipping.
    share: f64,
    open: bool,
}

impl Scores {
    /// Scenes formed in `E`, fused in `F`, compared as encoded values.
    pub(crate) fn of<E: Encoding, F: Encoding>(
        exchange: &Exchange<E>,
        reading: &Reading,
    ) -> Result<Self, ImageError> {
        let content = &exchange.content.image;
        let fused = reading.fuse::<E, F>(&exchange.content, &exchange.reference)?;
        let bytes: Image<u8> = fused.convert();
        let truth = exchange.truths[0].as_raw().iter().map(|&value| E::to_encoded(value));
        let truth: Vec<f32> = truth.collect();
        let missing = rms(fused.as_raw(), &truth);
        let before = rms(content.to_unit().as_raw(), &truth);
        Ok(Self {
            psnr: psnr(content, &bytes)?,
            ssim: ssim(content, &bytes)?.expect("scenes are larger than the window"),
            depth_rmse: depth_rmse(content, &bytes, DepthModel::default())?.percent(),
            share: 1.0 - missing / before,
            open: exchange.open(),
        })
    }

    pub(crate) const HEADER: &str = "PSNR, dB | SSIM | depth RMSE, % | consistency, % | truth A | open water in view | none in view |\n\
         |---|---|---|---|---|---|---|---|---|";

    /// The cells of a row: means over all.
    pub(crate) fn cells(all: &[Self]) -> String {
        let mean = |of: fn(&Self) -> f64| mean(all.iter().map(of));
        let share = |open: bool| self::mean(all.iter().filter(|one| one.open == open).map(|one| one.share));
        let made = mean(|one| one.share);
        let variance = self::mean(all.iter().map(|one| (one.share - made).powi(2)));
        let standard_error = (variance / (all.len() as f64 - 1.0)).sqrt();
        let decibels = decibels(all);
        let depth = mean(|one| one.depth_rmse);
        format!(
            "{decibels} | {:.3} | {depth:.2} | {:.1} | {made:.2} ± {standard_error:.2} | {:.2} | {:.2} |",
            mean(|one| one.ssim),
            100.0 - depth,
            share(true),
            share(false),
        )
    }
}

/// Mean PSNR; an image that is its content has no decibels to take the mean of.
fn decibels(all: &[Scores]) -> String {
    let changed: Vec<f64> = all.iter().map(|one| one.psnr).filter(|psnr| psnr.is_finite()).collect();
    match all.len() - changed.len() {
        0 => format!("{:.2}", mean(changed.into_iter())),
        unchanged if unchanged == all.len() => "∞".to_owned(),
        unchanged => format!("{:.2} ({unchanged} unchanged left out)", mean(changed.into_iter())),
    }
}

/// Root of the mean squared difference.
pub(crate) fn rms(a: &[f32], b: &[f32]) -> f64 {
    mean(a.iter().zip(b).map(|(a, b)| f64::from(a - b).powi(2))).sqrt()
}

pub(crate) fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0_u32), |(sum, count), value| (sum + value, count + 1));
    sum / f64::from(count)
}
