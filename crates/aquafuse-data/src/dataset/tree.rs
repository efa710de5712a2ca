//! The files in the folder of a dataset, and names in foreign files, which must stay within the folder.

use std::borrow::Cow;
use std::collections::{BTreeSet, HashMap};
use std::io::Read;
use std::path::{Path, PathBuf};

use super::{Fault, Faults};
use crate::files::{FileError, display, text_of};
use crate::image_file::{Format, ReadOptions, read_beside};

/// The sheet of a few images and their variants that `augment` draws.
pub(crate) const PREVIEW: &str = "preview.jpg";
/// The fault of a text file that is not UTF-8.
pub(super) const NO_TEXT: &str = "it is not UTF-8 text; save it as UTF-8";

/// Folders within folders; deeper ones are no dataset, but a mistake.
const DEEPEST: usize = 32;

/// The files in a folder and in those inside it, by their paths within it.
#[derive(Clone, Debug)]
pub(crate) struct Tree {
    pub(super) root: PathBuf,
    pub(crate) files: BTreeSet<String>,
    /// The paths with capitals, by what they are in small letters.
    capitals: HashMap<String, String>,
    /// Hidden files: their names, or those of a folder that they are in, begin with a dot. Those of programs are not among
    /// them.
    pub(super) hidden: BTreeSet<String>,
    /// Files that are skipped, and why.
    pub(super) faults: Faults,
    pub(super) reading: ReadOptions,
}

impl Tree {
    /// Lists the files, to be read with these options; hidden ones apart. Links are followed to files that stand
    /// in the folder too.
    pub(crate) fn of(root: &Path, reading: &ReadOptions) -> Result<Self, FileError> {
        let home = root.canonicalize().map_err(|error| FileError::Read { path: root.to_owned(), error })?;
        let mut tree = Self::holding(root.to_owned(), BTreeSet::new(), reading);
        tree.enter(&home, "", 0)?;
        // The sheet that `augment` draws is no image of the dataset that it made.
        if tree.files.contains(PREVIEW) && tree.files.iter().any(|path| is_manifest(&tree.root.join(path))) {
            tree.files.remove(PREVIEW);
        }
        let Self { root, files, hidden, faults, .. } = tree;
        Ok(Self { hidden, faults, ..Self::holding(root, files, reading) })
    }

    /// A tree of these files.
    pub(super) fn holding(root: PathBuf, files: BTreeSet<String>, reading: &ReadOptions) -> Self {
        let small = files.iter().map(|path| (path.to_lowercase(), path));
        let capitals = small.filter(|(small, path)| small != *path);
        let capitals = capitals.map(|(small, path)| (small, path.clone())).collect();
        Self { root, files, capitals, hidden: BTreeSet::new(), faults: Faults::default(), reading: *reading }
    }

    fn enter(&mut self, home: &Path, within: &str, depth: usize) -> Result<(), FileError> {
        let folder = self.root.join(within);
        let failed = |error| FileError::Read { path: folder.clone(), error };
        let is_hidden_folder = is_hidden(within);
        let entries = match std::fs::read_dir(&folder) {
            // Nobody asked for what is hidden: what cannot be listed is passed over.
            Err(_) if is_hidden_folder => return Ok(()),
            entries => entries.map_err(failed)?,
        };
        for entry in entries {
            let entry = entry.map_err(failed)?;
            let name = entry.file_name();
            let is_hidden = is_hidden_folder || name.as_encoded_bytes().starts_with(b".");
            let Some(name) = name.to_str().map(str::to_owned) else {
                if is_hidden {
                    continue;
                }
                self.faults.add(Fault::new(display(&entry.path()).to_string(), "the name is not UTF-8"));
                continue;
            };
            let path = super::join(within, &name);
            let kind = entry.file_type().map_err(failed)?;
            if is_hidden {
                let is_of_macos = kind.is_file() && is_apple_double(&entry.path());
                let is_of_user = !is_of_program(&name) && !is_of_macos;
                if is_of_user && kind.is_file() {
                    self.hidden.insert(path);
                } else if is_of_user && kind.is_dir() && depth < DEEPEST {
                    self.enter(home, &path, depth.saturating_add(1))?;
                }
                continue;
            }
            if kind.is_dir() && depth < DEEPEST {
                self.enter(home, &path, depth.saturating_add(1))?;
            } else if kind.is_file() {
                self.files.insert(path);
            } else if kind.is_symlink() {
                match entry.path().canonicalize() {
                    Ok(target) if target.starts_with(home) && target.is_file() => {
                        self.files.insert(path);
                    }
                    Ok(target) if target.starts_with(home) => {
                        self.faults.add(Fault::new(path, "a link to a folder, which is not followed"));
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
        self.files.iter().filter(|path| self.is_image(path))
    }

    /// The files that may be masks: images, and GIF, which images of datasets are not.
    pub(super) fn pictures(&self) -> impl Iterator<Item = &String> {
        self.files.iter().filter(|path| Format::of(Path::new(path)).is_some())
    }

    /// The files whose names end so, whatever the case.
    pub(super) fn ending<'a>(&'a self, end: &'a str) -> impl Iterator<Item = &'a String> {
        self.files.iter().filter(move |path| path.to_ascii_lowercase().ends_with(end))
    }

    /// Whether a file of the dataset is an image, by its name.
    pub(super) fn is_image(&self, path: &str) -> bool {
        Format::listed(Path::new(path))
    }

    pub(super) fn holds(&self, path: &str) -> bool {
        self.files.contains(path)
    }

    /// The file of a path; if there is none, the file of a path which differs only in capitals.
    pub(super) fn any_case(&self, path: &str) -> Option<&String> {
        let other = || {
            let small = path.to_lowercase();
            self.capitals.get(&small).or_else(|| self.files.get(&small))
        };
        self.files.get(path).or_else(other)
    }

    /// Reads a file of the dataset.
    pub(super) fn bytes(&self, path: &str) -> Result<Vec<u8>, FileError> {
        read_beside(&self.root.join(path), &self.reading)
    }

    /// Reads a text file of the dataset, without its byte order mark; `None` if it is not text.
    pub(super) fn read(&self, path: &str) -> Result<Option<String>, FileError> {
        Ok(text_of(&self.bytes(path)?).map(Cow::into_owned))
    }
}

/// Whether a file is a manifest of `augment`, by its name and its first bytes.
pub(super) fn is_manifest(path: &Path) -> bool {
    const BEGINS: &[u8] = b"{\"line\":\"job\",";
    let name = path.file_name().unwrap_or_default().as_encoded_bytes();
    name.starts_with(b"manifest") && name.ends_with(b".jsonl") && begins_with(path, BEGINS)
}

/// Whether a folder in a path is hidden.
fn is_hidden(path: &str) -> bool {
    path.split('/').any(|part| part.starts_with('.'))
}

/// Whether a hidden file or folder is a program's, and no user's.
fn is_of_program(name: &str) -> bool {
    const NAMES: [&str; 13] = [
        ".git",
        ".svn",
        ".hg",
        ".dvc",
        ".cache",
        ".idea",
        ".vscode",
        ".venv",
        ".ds_store",
        ".thumbnails",
        ".ipynb_checkpoints",
        ".directory",
        ".picasa.ini",
    ];
    let small = name.to_lowercase();
    small.starts_with(".aquafuse-") || small.starts_with(".trash") || NAMES.contains(&small.as_str())
}

/// Whether a file is one of those that macOS writes beside each file on other disks, as `._NAME`.
fn is_apple_double(path: &Path) -> bool {
    begins_with(path, &[0, 5, 0x16, 7])
        && path.file_name().is_some_and(|name| name.as_encoded_bytes().starts_with(b"._"))
}

/// Whether a regular file begins with these bytes.
pub(super) fn begins_with(path: &Path, bytes: &[u8]) -> bool {
    let mut begin = Vec::new();
    let file = std::fs::File::open(path);
    file.is_ok_and(|file| file.take(bytes.len() as u64).read_to_end(&mut begin).is_ok()) && begin == bytes
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
