//! Every parser of a scene by itself: what is fuzzed, and what the tests replay.

use std::path::Path;

use aquafuse_data::targets::{Target, check_error};

use crate::files::{SceneFileError, try_colmap_binary, try_colmap_text, try_ply, try_spz, try_transforms};
use crate::train::try_state;

/// States of training.
pub const SCENE_CHECKPOINT: Target = Target { name: "scene-checkpoint", run: try_state };
/// COLMAP's binary models.
pub const SCENE_COLMAP_BINARY: Target =
    Target { name: "scene-colmap-binary", run: |bytes| refusals(&try_colmap_binary(file(), bytes)) };
/// COLMAP's text models.
pub const SCENE_COLMAP_TEXT: Target = Target {
    name: "scene-colmap-text",
    run: |bytes| {
        if let Ok(text) = std::str::from_utf8(bytes) {
            refusals(&try_colmap_text(file(), text));
        }
    },
};
/// Splats as PLY.
pub const SCENE_PLY: Target = Target { name: "scene-ply", run: |bytes| refusals(&[try_ply(file(), bytes)]) };
/// Splats as `.spz`, without gzip around them.
pub const SCENE_SPZ: Target = Target { name: "scene-spz", run: |bytes| refusals(&[try_spz(file(), bytes)]) };
/// Cameras as `transforms.json`.
pub const SCENE_TRANSFORMS: Target =
    Target { name: "scene-transforms", run: |bytes| refusals(&[try_transforms(file(), bytes, &|_| None)]) };

/// Every parser there is. A program that fuzzes one names that one alone, so that the others are not linked to it.
pub const ALL: [Target; 6] =
    [SCENE_CHECKPOINT, SCENE_COLMAP_BINARY, SCENE_COLMAP_TEXT, SCENE_PLY, SCENE_SPZ, SCENE_TRANSFORMS];

fn file() -> &'static Path {
    Path::new(aquafuse_data::targets::NAME)
}

fn refusals<T>(tried: &[Result<T, SceneFileError>]) {
    tried.iter().filter_map(|one| one.as_ref().err()).for_each(check_error);
}
