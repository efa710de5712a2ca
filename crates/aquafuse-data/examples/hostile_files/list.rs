//! The files and what is right for each.

use std::fmt::Write;
use std::io;
use std::path::Path;

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

struct Entry {
    name: String,
    kind: &'static str,
    role: Role,
    right: Right,
    bytes: Vec<u8>,
}

/// Everything that will be written.
#[derive(Default)]
pub(crate) struct Files(Vec<Entry>);

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
        self.0.push(Entry { name: format!("{prefix}{name}"), kind, role, right, bytes: bytes.into() });
    }

    pub(crate) fn len(&self) -> usize {
        self.0.len()
    }

    /// Writes the files and `list.tsv`: name, kind, role, right.
    pub(crate) fn write(&self, folder: &Path) -> io::Result<()> {
        let files = folder.join("files");
        std::fs::create_dir_all(&files)?;
        let mut list = String::new();
        for Entry { name, kind, role, right, bytes } in &self.0 {
            let path = files.join(name);
            if path.exists() {
                // Two files of one name would hide one of them.
                return Err(io::Error::other(format!("{} is there already", path.display())));
            }
            std::fs::write(path, bytes)?;
            let words = format!("{kind}\t{role:?}\t{right:?}").to_lowercase();
            writeln!(list, "{name}\t{words}").map_err(io::Error::other)?;
        }
        std::fs::write(folder.join("list.tsv"), list)
    }
}
