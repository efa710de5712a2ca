//! Images and figures drawn for people: sheets as images, plots as SVG.
//!
//! Everything is drawn with `plotters`, in the one font that is built in: it has the symbols of the paper, and asks the
//! system for nothing.

mod canvas;
mod contact_sheet;
mod estimates;
mod means;

pub(crate) use contact_sheet::outlined;
pub use contact_sheet::{Cell, contact_sheet};
pub use estimates::{Captions, estimates};
pub(crate) use means::{Mean, means};

/// A figure could not be drawn.
#[derive(Debug, thiserror::Error)]
#[error("the figure cannot be drawn: {0}")]
pub struct DrawError(String);

impl<E: std::error::Error + Send + Sync> From<plotters::drawing::DrawingAreaErrorKind<E>> for DrawError {
    fn from(error: plotters::drawing::DrawingAreaErrorKind<E>) -> Self {
        Self(error.to_string())
    }
}

impl From<aquafuse::image::ImageError> for DrawError {
    fn from(error: aquafuse::image::ImageError) -> Self {
        Self(error.to_string())
    }
}
