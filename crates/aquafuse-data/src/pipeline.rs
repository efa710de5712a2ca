//! The pipeline of one image: depth and water are estimated, an operation changes it, maps and scores describe the
//! change.

mod estimate;
pub(crate) mod maps;
mod operation;
mod scores;
mod supply;

pub use estimate::{Analysis, DepthSource, analyse, evidence};
pub use operation::{Limited, Operation, Outcome, Space};
pub use scores::Scores;
pub use supply::DepthSupply;
pub(crate) use supply::SUPPLIED;
