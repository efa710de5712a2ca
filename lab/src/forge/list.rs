//! The files and what is right for each.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};

/// What a reader must do with a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Right {
    /// No whole image is in it.
    Refuse,
    /// The rules leave it to the reader.
    Any,
    /// It is valid, if unusual.
    Accept,
}

/// What a file is given as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Role {
    Image,
    Depth,
}

/// A file that was forged.
pub(crate) struct Forged {
    pub(crate) name: String,
    pub(crate) kind: &'static str,
    pub(crate) role: Role,
    pub(crate) right: Right,
    pub(crate) bytes: Vec<u8>,
}

/// Everything that is forged.
#[derive(Default)]
pub(crate) struct Files(Vec<Forged>);

impl Files {
    /// Adds a file to be given as an image.
    pub(crate) fn image(&mut self, kind: &'static str, right: Right, name: &str, bytes: impl Into<Vec<u8>>) {
        self.add(kind, Role::Image, right, name, bytes);
    }

    /// Adds a file to be given as a depth map.
    pub(crate) fn depth(&mut self, kind: &'static str, right: Right, name: &str, bytes: impl Into<Vec<u8>>) {
        self.add(kind, Role::Depth, right, name, bytes);
    }

    /// Adds a file.
    pub(crate) fn add(
        &mut self,
        kind: &'static str,
        role: Role,
        right: Right,
        name: &str,
        bytes: impl Into<Vec<u8>>,
    ) {
        let prefix = if role == Role::Depth { "depth-" } else { "" };
        self.0.push(Forged { name: format!("{prefix}{name}"), kind, role, right, bytes: bytes.into() });
    }

    /// All of them, in the order in which they were added.
    pub(crate) fn iter(&self) -> impl Iterator<Item = &Forged> {
        self.0.iter()
    }

    /// Writes each file into a folder, and gives the paths in order.
    pub(crate) fn write(&self, folder: &Path) -> Result<Vec<PathBuf>> {
        fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
        let write = |file: &Forged| {
            let path = folder.join(&file.name);
            // Two files of one name would hide one of them.
            ensure!(!path.exists(), "{} is there already", path.display());
            fs::write(&path, &file.bytes).with_context(|| format!("cannot write {}", path.display()))?;
            Ok(path)
        };
        self.iter().map(write).collect()
    }
}
