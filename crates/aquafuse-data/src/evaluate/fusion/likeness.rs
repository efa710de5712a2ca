//! How much an image looks like its content, by the paper's scores.

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
    /// LPIPS, where there is a network for it.
    pub(super) lpips: Option<f64>,
}

impl Likeness {
    /// Compares an image with its content, of the same size; none where they are too small for SSIM.
    pub(super) fn of(content: &Image<u8>, made: &Image<u8>) -> Option<Self> {
        const SAME: &str = "results have the size of their content";
        Some(Self {
            psnr: psnr(content, made).expect(SAME),
            ssim: ssim(content, made).expect(SAME)?,
            depth: depth_rmse(content, made, DepthModel::default()).expect(SAME),
            lpips: None,
        })
    }

    /// PSNR, SSIM, depth RMSE in percent and in levels, depth consistency and LPIPS: the columns of the tables.
    pub(super) fn values(&self) -> [Option<f64>; 6] {
        let Self { psnr, ssim, depth, lpips } = self;
        let depth = [depth.percent(), depth.levels(), depth.consistency()];
        [Some(*psnr), Some(*ssim), Some(depth[0]), Some(depth[1]), Some(depth[2]), *lpips]
    }
}
