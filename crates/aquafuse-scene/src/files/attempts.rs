//! Parsers as fuzzing calls them: on bytes, of a file that is only a name.

use std::path::Path;

use super::{SceneFileError, colmap_binary, colmap_text, ply, transforms};

type Tried = Result<(), SceneFileError>;

pub(crate) fn text(path: &Path, bytes: &[u8]) -> Vec<Tried> {
    std::str::from_utf8(bytes).map_or(Vec::new(), |text| colmap_text::try_parse(path, text).into())
}

pub(crate) fn binary(path: &Path, bytes: &[u8]) -> Vec<Tried> {
    colmap_binary::try_parse(path, bytes).into()
}

pub(crate) fn frames(path: &Path, bytes: &[u8]) -> Vec<Tried> {
    vec![transforms::read(path, bytes).map(drop)]
}

pub(crate) fn splats(path: &Path, bytes: &[u8]) -> Vec<Tried> {
    vec![ply::try_parse(path, bytes)]
}
