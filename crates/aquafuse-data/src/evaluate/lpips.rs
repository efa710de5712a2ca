//! LPIPS: how alike two images are to a network that was trained on what people say.
//!
//! R. Zhang et al., "The Unreasonable Effectiveness of Deep Features as a Perceptual Metric" (2018). The network and its
//! weights are not ours to ship: `lpips/export.py` beside this crate writes them as ONNX, from the published packages.

#[cfg(feature = "lpips")]
mod network;

#[cfg(feature = "lpips")]
pub use network::Lpips;

/// The network of LPIPS. There is none: the feature `lpips` is off.
#[cfg(not(feature = "lpips"))]
#[derive(Clone, Debug)]
pub enum Lpips {}

/// Bytes a pixel that the network takes, where it is VGG, the largest of the published ones.
pub(crate) const BYTES_A_PIXEL: u64 = 1536;

#[cfg(not(feature = "lpips"))]
impl Lpips {
    pub(crate) fn described(&self) -> serde_json::Value {
        match *self {}
    }

    /// The distance of two images: of no network there is none.
    ///
    /// # Errors
    ///
    /// None, for there is nothing to ask.
    pub fn distance(
        &self,
        _: &aquafuse::image::Image<u8>,
        _: &aquafuse::image::Image<u8>,
    ) -> Result<f64, super::EvaluateError> {
        match *self {}
    }
}
