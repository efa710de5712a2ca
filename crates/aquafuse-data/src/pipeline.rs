//! The pipeline of one image: depth and water are estimated, an operation changes it, maps and scores describe the
//! change.

mod encoding;
mod estimate;
mod estimator;
pub(crate) mod maps;
mod operation;
#[allow(clippy::disallowed_methods, reason = "sums of floats do not overflow")]
mod sampled;
mod scores;
mod simulate;
mod supply;

pub use encoding::{PixelEncoding, UnknownEncoding, WaterEstimate};
pub(crate) use encoding::{Space, with_estimate};
pub use estimate::{
    Analysis, DepthSource, MapSize, analyse, analyse_coarse, analyse_in, analyse_supplied,
    analyse_with_evidence,
};
pub(crate) use estimate::{analyse_in_with_evidence, depth_of};
pub use estimator::DepthEstimator;
pub use operation::{Limited, Operation, OperationError, Outcome};
pub use scores::Scores;
pub use simulate::{SIMULATED, simulate};
pub use supply::DepthSupply;
pub(crate) use supply::SUPPLIED;
