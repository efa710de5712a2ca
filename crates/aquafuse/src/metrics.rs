//! Scores: how alike two images are, and whether depth survived.
//!
//! | score | compares | best | use it for |
//! |---|---|---|---|
//! | [`psnr`] | values, pixel by pixel | ∞ dB | how far an image is from its truth |
//! | [`ssim`] | local structure of luma | 1 | whether objects keep their look |
//! | [`depth_rmse`] | depth estimated again from each | 0 | whether geometry survived fusion |
//! | [`uciqe`] | nothing: colour and contrast of one image | higher | how far an enhanced image has come |
//! | [`uiqm`] | nothing: colour, sharpness and contrast | higher | the same, by another recipe |
//! | [`Flicker`] | mean colours, frame by frame | 1 | how much more a sequence changes than its source |
//! | [`warping_error`] | a frame with the one before, by optical flow | that of the source | the same, where things move |
//! | [`spearman`] | the order of two series | 1 | whether relative depth is right |
//!
//! As in the paper, a fused image is compared with its content: a high score says that little was lost,
//! not that the water is right. [`lab`] converts a colour to CIELab, [`colour_difference`] says
//! how far pixels are apart there. The two scores without a reference are fooled by oversaturation and noise.

mod depth_rmse;
mod flicker;
mod lab;
mod psnr;
mod ssim;
mod uciqe;
mod uiqm;

pub use crate::rank::spearman;
pub use depth_rmse::{DepthRmse, depth_rmse};
pub use flicker::{Flicker, warping_error};
pub use lab::{colour_difference, lab};
pub use psnr::psnr;
pub use ssim::ssim;
pub use uciqe::{Uciqe, uciqe};
pub use uiqm::{Uiqm, uiqm};
