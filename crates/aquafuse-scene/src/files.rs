//! Scenes on disk: cameras in, splats in and out.
//!
//! | file | read by | written by |
//! |---|---|---|
//! | COLMAP's `cameras`, `images`, `points3D` in `.txt` or `.bin` | [`read_cameras`] | [`write_cameras`] (`.txt`) |
//! | `transforms.json` as of NeRF | [`read_cameras`] | [`write_transforms`] |
//! | splats in the layout of Kerbl et al., `.ply` | [`read_splats`] | [`write_ply`] |
//! | the same compressed, of SuperSplat, `.ply` | [`read_splats`] | |
//! | splats of Niantic, `.spz` | [`read_splats`] | [`write_spz`] |
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
mod quaternion;
mod splat;
mod spz;
mod transforms;

pub use cameras::{Cameras, ChosenModel, PosedImage, read_cameras};
pub use cloud::write_cloud;
pub use colmap_text::write_cameras;
pub use error::SceneFileError;
pub use ply::{ply_bytes, write_ply};
pub use splat::{splat_bytes, write_splat};
pub use spz::{spz_bytes, write_spz};
pub use transforms::write_transforms;

use std::path::Path;

use aquafuse_data::image_file::ReadOptions;

use crate::splats::Splats;

/// Reads splats from a `.spz` file, by its name, or from a PLY file.
///
/// # Errors
///
/// [`SceneFileError`] when it is no such file, lacks a property, is cut short, holds a value that is no number, or takes more
/// memory than `reading` allows.
pub fn read_splats(path: &Path, reading: &ReadOptions) -> Result<Splats<f32>, SceneFileError> {
    let is_spz = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("spz"));
    if is_spz { spz::read(path, reading) } else { ply::read(path, reading) }
}

#[cfg(feature = "fuzz-targets")]
pub(crate) use {
    colmap_binary::try_parse as try_colmap_binary, colmap_text::try_parse as try_colmap_text,
    ply::try_parse as try_ply, spz::try_parse as try_spz, transforms::read as try_transforms,
};
