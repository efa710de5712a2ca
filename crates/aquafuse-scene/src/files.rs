//! Scenes on disk: cameras in, splats in and out.
//!
//! | file | read by | written by |
//! |---|---|---|
//! | COLMAP's `cameras`, `images`, `points3D` in `.txt` or `.bin` | [`read_cameras`] | [`write_cameras`] (`.txt`) |
//! | `transforms.json` as of NeRF | [`read_cameras`] | |
//! | splats in the layout of Kerbl et al., `.ply` | [`read_ply`] | [`write_ply`] |
//! | splats without harmonics, `.splat` | | [`write_splat`] |
//! | points with colours, `.ply` | | [`write_cloud`] |
//!
//! Every byte is somebody else's: errors name the file and the position in it, counts are compared with the rest of the
//! file before memory is taken, and no name leads out of its folder.

// Sizes and places in here come from files. Tests may panic: that is how they fail.
#![cfg_attr(
    not(test),
    deny(
        clippy::arithmetic_side_effects,
        clippy::cast_possible_truncation,
        clippy::cast_possible_wrap,
        clippy::cast_sign_loss,
        clippy::disallowed_methods,
        clippy::indexing_slicing,
        clippy::string_slice
    )
)]

mod bytes;
mod cameras;
mod cloud;
mod colmap_binary;
mod colmap_text;
mod error;
mod ply;
mod splat;
mod transforms;

pub use cameras::{Cameras, ChosenModel, PosedImage, read_cameras};
pub use cloud::write_cloud;
pub use colmap_text::write_cameras;
pub use error::SceneFileError;
pub use ply::{ply_bytes, read_ply, write_ply};
pub use splat::{splat_bytes, write_splat};
#[cfg(feature = "fuzz-targets")]
pub(crate) use {
    colmap_binary::try_parse as try_colmap_binary, colmap_text::try_parse as try_colmap_text,
    ply::try_parse as try_ply, transforms::read as try_transforms,
};
