//! Every parser of a scene by itself: what is fuzzed, and what the tests replay.

use std::path::Path;

use aquafuse_data::targets::{Target, check_error};

use crate::files::{SceneFileError, attempts};
use crate::train::try_state;

/// Every parser there is.
pub const ALL: [Target; 5] = [
    Target { name: "scene-checkpoint", run: try_state },
    Target { name: "scene-colmap-binary", run: |bytes| refusals(&attempts::binary(file(), bytes)) },
    Target { name: "scene-colmap-text", run: |bytes| refusals(&attempts::text(file(), bytes)) },
    Target { name: "scene-ply", run: |bytes| refusals(&attempts::splats(file(), bytes)) },
    Target { name: "scene-transforms", run: |bytes| refusals(&attempts::frames(file(), bytes)) },
];

/// The target of a name.
pub fn named(name: &str) -> Option<Target> {
    ALL.into_iter().find(|target| target.name == name)
}

fn file() -> &'static Path {
    Path::new(aquafuse_data::targets::NAME)
}

fn refusals(tried: &[Result<(), SceneFileError>]) {
    tried.iter().filter_map(|one| one.as_ref().err()).for_each(check_error);
}
