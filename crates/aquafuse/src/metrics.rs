//! Scores: how alike two pictures are, and whether depth survived.
//!
//! | score | compares | best | use it for |
//! |---|---|---|---|
//! | [`psnr`] | values, pixel by pixel | ∞ dB | how far a picture is from its truth |
//! | [`ssim`] | local structure of luma | 1 | whether objects keep their look |
//! | [`depth_rmse`] | depth estimated again from each | 0 | whether geometry survived fusion |
//! | [`spearman`] | the order of two series | 1 | whether relative depth is right |
//!
//! As in the paper, a fused picture is compared with its content: a high score says that little was lost,
//! not that the water is right.

mod depth_rmse;
mod psnr;
mod spearman;
mod ssim;

pub use depth_rmse::{DepthRmse, depth_rmse};
pub use psnr::psnr;
pub(crate) use spearman::ranks;
pub use spearman::spearman;
pub use ssim::ssim;
