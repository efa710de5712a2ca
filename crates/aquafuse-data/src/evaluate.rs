//! Scores of methods.
//!
//! | evaluation | measures |
//! |---|---|
//! | [`Fusion`] | the similarity of fused images to their contents, by the scores of the paper |
//! | [`Truth`] | the share of the true change that each method achieves, on synthetic scenes |
//! | [`Enhancement`] | the quality of images before and after restoration and enhancement |
//! | [`Depth`] | the accuracy of depth from colour, and of other depth maps |
//!
//! Each runs on its own threads within one memory budget and returns a [`Report`], which [`report`] writes as Markdown,
//! CSV, JSON or HTML. Means have a variance and a bootstrap interval ([`Summary`]). Figures do not depend on the number
//! of threads. An image that fails is listed in the report, and the others go on.

mod chance;
mod depth;
mod enhancement;
mod error;
mod fusion;
mod lpips;
mod members;
mod outputs;
pub mod report;
#[allow(
    clippy::arithmetic_side_effects,
    clippy::cast_possible_truncation,
    clippy::disallowed_methods,
    clippy::indexing_slicing,
    reason = "indices are constant, below the lengths of fixed arrays"
)]
mod rivals;
mod statistics;
#[allow(
    clippy::arithmetic_side_effects,
    clippy::disallowed_methods,
    clippy::indexing_slicing,
    reason = "it computes with images that it has made itself"
)]
mod truth;

pub use depth::{Depth, Maps};
pub use enhancement::Enhancement;
pub use error::{EvaluateError, Failed};
pub use fusion::{Fusion, Method, Settings};
pub use lpips::Lpips;
pub use members::{GroupBy, Member, Pairing};
pub use outputs::Outputs;
pub use report::Report;
pub use rivals::{Alone, Palette, Rival};
pub use statistics::Summary;
pub use truth::Truth;

/// Whoever listens to an evaluation. An item is a step's name. A step ends with one `Done`, even if it failed; each `Failed` of
/// it comes before.
pub type Listener<'a> = crate::run::Listener<'a, str, (), Failed>;
