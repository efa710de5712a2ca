//! Images of other crates, a file for each, behind the feature of its name.

#[cfg(feature = "image")]
mod image;
#[cfg(feature = "ndarray")]
mod ndarray;
