//! What methods are worth, in figures.
//!
//! | evaluation | asks |
//! |---|---|
//! | [`Fusion`] | how much fused images look like their contents, by the scores of the paper's tables |
//! | [`Truth`] | how much of the true change is made, on scenes of known truth |
//! | [`Enhancement`] | how good images look before and after |
//! | [`Depth`] | how right depth from colour is, or from elsewhere |
//!
//! Each runs on threads of its own within one budget of memory and gives a [`Report`], which [`report`] writes as
//! Markdown, CSV, JSON or a page of HTML. Means have their variance and a bootstrap interval ([`Summary`]). No figure
//! depends on the number of threads. An image that fails is listed in the report, and the others go on.

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
    reason = "it computes with colours of images that are read already, in places of fixed number"
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
pub use rivals::{Palette, Rival};
pub use statistics::Summary;
pub use truth::Truth;

/// Whoever listens to an evaluation. An item is a step's name; each step ends with one `Done`, after a `Failed` for
/// whatever failed in it.
pub type Listener<'a> = crate::run::Listener<'a, str, (), Failed>;
