//! The files in the folder of a dataset, and names in foreign files, which must stay within the folder.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use super::{Fault, Faults, split};
use crate::files::{FileError, display};
use crate::image_file::{Format, ReadOptions, read_beside};

/// The fault of a text file that is not UTF-8.
pub(super) const NO_TEXT: &str = "it is not UTF-8 text; save it as UTF-8";

/// Folders within folders; deeper ones are no dataset, but a mistake.
const DEEPEST: usize = 32;

/// The files in a folder and in those inside it, by their paths within it.
#[derive(Clone, Debug)]
pub(crate) struct Tree {
    pub(super) root: PathBuf,
    pub(crate) files: BTreeSet<String>,
    /// Files that are skipped, and why.
    pub(super) faults: Faults,
    pub(super) reading: ReadOptions,
}

impl Tree {
    /// Lists the files, to be read with these options; hidden ones are passed over. Links are followed to files that stand
    /// in the folder too.
    pub(crate) fn of(root: &Path, reading: &ReadOptions) -> Result<Self, FileError> {
        let home = root.canonicalize().map_err(|error| FileError::Read { path: root.to_owned(), error })?;
        let (files, faults) = (BTreeSet::new(), Faults::default());
        let mut tree = Self { root: root.to_owned(), files, faults, reading: *reading };
        tree.enter(&home, "", 0)?;
        Ok(tree)
    }

    fn enter(&mut self, home: &Path, within: &str, depth: usize) -> Result<(), FileError> {
        let folder = self.root.join(within);
        let failed = |error| FileError::Read { path: folder.clone(), error };
        for entry in std::fs::read_dir(&folder).map_err(failed)? {
            let entry = entry.map_err(failed)?;
            let Some(name) = entry.file_name().to_str().map(str::to_owned) else {
                self.faults.add(Fault::new(display(&entry.path()).to_string(), "the name is not UTF-8"));
                continue;
            };
            if name.starts_with('.') {
                continue;
            }
            let path = super::join(within, &name);
            let kind = entry.file_type().map_err(failed)?;
            if kind.is_dir() && depth < DEEPEST {
                self.enter(home, &path, depth.saturating_add(1))?;
            } else if kind.is_file() {
                self.files.insert(path);
            } else if kind.is_symlink() {
                match entry.path().canonicalize() {
                    Ok(target) if target.starts_with(home) && target.is_file() => {
                        self.files.insert(path);
                    }
                    _ => {
                        self.faults
                            .add(Fault::new(path, "a link that is broken or leads out of the dataset"));
                    }
                }
            } else {
                self.faults.add(Fault::new(path, "not a regular file, or a folder nested too deeply"));
            }
        }
        Ok(())
    }

    /// The images among the files.
    pub(super) fn images(&self) -> impl Iterator<Item = &String> {
        self.files.iter().filter(|path| Format::listed(Path::new(path)))
    }

    /// The files whose names end so, whatever the case.
    pub(super) fn ending<'a>(&'a self, end: &'a str) -> impl Iterator<Item = &'a String> {
        self.files.iter().filter(move |path| path.to_ascii_lowercase().ends_with(end))
    }

    /// The files in a folder and in those inside it.
    pub(super) fn within(&self, folder: &str) -> impl Iterator<Item = &String> {
        // Names with the folder before them stand together.
        let from = super::join(folder, "");
        self.files.range(from.clone()..).take_while(move |path| path.starts_with(&from))
    }

    /// The images in a folder.
    pub(super) fn images_in<'a>(&'a self, folder: &'a str) -> impl Iterator<Item = &'a String> {
        self.within(folder).filter(move |path| split(path).0 == folder && Format::listed(Path::new(path)))
    }

    pub(super) fn holds(&self, path: &str) -> bool {
        self.files.contains(path)
    }

    /// Reads a text file of the dataset; `None` if it is not text.
    pub(super) fn read(&self, path: &str) -> Result<Option<String>, FileError> {
        let bytes = read_beside(&self.root.join(path), &self.reading)?;
        Ok(String::from_utf8(bytes).ok())
    }
}

/// A name as a path within the dataset; why it is none otherwise.
///
/// A leading `./` is left out. `..`, absolute names and names with a drive lead out of the dataset, even where they
/// lead back again: a file that says so was not made for this folder.
pub(crate) fn inside(name: &str) -> Result<String, &'static str> {
    if name.starts_with(['/', '\\']) || name.as_bytes().get(1) == Some(&b':') {
        return Err("an absolute name; names are within the dataset");
    }
    if name.contains('\0') || name.is_empty() {
        return Err("not a file name");
    }
    let parts: Vec<&str> = name.split('/').filter(|part| !part.is_empty() && *part != ".").collect();
    if parts.contains(&"..") || name.split('\\').any(|part| part == "..") {
        return Err("a name with `..`, which leads out of the dataset");
    }
    match parts.as_slice() {
        [] => Err("not a file name"),
        parts => Ok(parts.join("/")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stay_within_the_data_set() {
        assert_eq!(inside("./train//a.jpg").unwrap(), "train/a.jpg");
        for out in
            ["/etc/passwd", "../a.jpg", "a/../../b.jpg", "C:\\a.jpg", "\\\\host\\a", "..\\a", "", ".", "a\0b"]
        {
            assert!(inside(out).is_err(), "{out:?}");
        }
    }
}
