//! What a picture tells about its depth and its water.

use aquafuse::depth::{self, DepthMap};
use aquafuse::image::Encoded;
use aquafuse::waterbody::{self, Estimate, EstimateOptions};

use crate::picture::Picture;

/// A picture's depth and water, estimated.
#[derive(Clone, Debug)]
pub struct Analysis {
    /// Depth by Eq. 3 and its median.
    pub depth: DepthMap,
    /// Its water, and how that was found.
    pub estimate: Estimate<Encoded>,
}

/// Estimates depth and water of a picture. Every command that needs either calls this.
pub fn analyse(picture: &Picture) -> Analysis {
    let depth = depth::estimate(&picture.image);
    let options = EstimateOptions { top: picture.top_edge(), ..EstimateOptions::default() };
    let estimate = waterbody::estimate(&picture.image, &depth, &options)
        .expect("the depth map was made from this picture");
    Analysis { depth, estimate }
}
