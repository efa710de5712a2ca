//! What a picture tells about its depth and its water.

use aquafuse::depth::{DepthMap, DepthModel};
use aquafuse::image::Encoded;
use aquafuse::waterbody::{self, Estimate, EstimateOptions};

use crate::picture::Picture;

/// A picture's depth and water, estimated.
#[derive(Clone, Debug)]
pub struct Analysis {
    /// Depth from colour.
    pub depth: DepthMap,
    /// The way it was come by.
    pub depth_model: DepthModel,
    /// Its water, and how that was found.
    pub estimate: Estimate<Encoded>,
}

/// Estimates depth and water of a picture. Every command that needs either calls this.
pub fn analyse(picture: &Picture, depth_model: DepthModel) -> Analysis {
    let depth = depth_model.estimate_seen(&picture.image, picture.top_edge());
    let options = EstimateOptions { top: picture.top_edge(), ..EstimateOptions::default() };
    let estimate = waterbody::estimate(&picture.image, &depth, &options)
        .expect("the depth map was made from this picture");
    Analysis { depth, depth_model, estimate }
}
