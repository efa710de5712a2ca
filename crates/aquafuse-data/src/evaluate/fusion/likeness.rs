//! How much a picture looks like its content, by the paper's scores.

use aquafuse::depth::DepthModel;
use aquafuse::image::Image;
use aquafuse::metrics::{DepthRmse, depth_rmse, psnr, ssim};

/// The scores of one pair.
#[derive(Clone, Copy, Debug)]
pub(super) struct Likeness {
    /// Of all channels, in dB; infinite where nothing changed.
    pub(super) psnr: f64,
    /// Of luma.
    pub(super) ssim: f64,
    /// Of Eq. 3 depth estimated again.
    pub(super) depth: DepthRmse,
}

impl Likeness {
    /// Compares a picture with its content, of the same size; none where they are too small for SSIM.
    pub(super) fn of(content: &Image<u8>, made: &Image<u8>) -> Option<Self> {
        const SAME: &str = "results have the size of their content";
        Some(Self {
            psnr: psnr(content, made).expect(SAME),
            ssim: ssim(content, made).expect(SAME)?,
            depth: depth_rmse(content, made, DepthModel::default()).expect(SAME),
        })
    }

    /// PSNR, SSIM, depth RMSE in percent and in levels, and depth consistency: the columns of the tables.
    pub(super) fn values(&self) -> [f64; 5] {
        let Self { psnr, ssim, depth } = self;
        [*psnr, *ssim, depth.percent(), depth.levels(), depth.consistency()]
    }
}
