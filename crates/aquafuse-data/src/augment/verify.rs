//! Compares files with their manifest, bit for bit.

use std::collections::HashSet;
use std::hash::{BuildHasher as _, RandomState};
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::AugmentError;
use super::journal::manifests;
use super::line::Listed;
use super::manifest::{Entry, Manifest, Part};
use crate::dataset::{Tree, inside};
use crate::files::{FileError, sha256_of, stays_within};
use crate::image_file::ReadOptions;

/// Something that a check found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Finding {
    /// A file that is missing or changed, with the cause in words.
    Wrong(PathBuf, String),
    /// A file in the folder that no manifest lists.
    Unlisted(PathBuf),
}

/// The result of a check.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Checked {
    /// Files that were checked.
    pub files: usize,
    /// Files that are missing or changed.
    pub wrong: usize,
    /// Files in the folder that no manifest lists.
    pub unlisted: usize,
}

/// Checks every file that the manifests in a folder list, and the manifests themselves; with `dataset`, the source
/// images in this dataset too. Gives what it finds to `each` as soon as it is found, each file once, so that memory does
/// not grow with it. No line of a manifest may be longer than a quarter of the memory that `reading` allows.
///
/// # Errors
///
/// [`AugmentError`] when there is no manifest, or one cannot be read.
pub fn verify(
    folder: &Path,
    dataset: Option<&Path>,
    reading: &ReadOptions,
    mut each: impl FnMut(Finding),
) -> Result<Checked, AugmentError> {
    let paths = manifests(folder)?;
    if paths.is_empty() {
        return Err(AugmentError::NoManifest { folder: folder.to_owned() });
    }
    let mut checker = Checker {
        folder,
        dataset,
        keys: RandomState::new(),
        listed: HashSet::new(),
        found_wrong: HashSet::new(),
        batch: Vec::new(),
        checked: Checked::default(),
        each: &mut each,
    };
    for path in paths {
        let mut manifest = Manifest::open(&path, reading)?;
        let shown = manifest.show(|part| match part {
            Part::Entry(key, entry) => checker.entry(&path, key, entry),
            Part::Index(written) => checker.add(&path, folder, written.listed()),
        });
        shown.map_err(|error| error.of(&path))?;
        checker.check();
        checker.manifest(path, manifest.sealed);
    }
    let there = Tree::of(folder, reading)?.files.into_iter().map(|path| folder.join(path));
    Ok(checker.end(there))
}

/// Files that are compared at once.
const AT_ONCE: usize = 4096;

/// Compares files in batches: a manifest may list millions.
struct Checker<'a> {
    folder: &'a Path,
    dataset: Option<&'a Path>,
    keys: RandomState,
    /// What is listed, and what was found wrong, as digests.
    listed: HashSet<u64>,
    found_wrong: HashSet<u64>,
    batch: Vec<Expected<'a>>,
    checked: Checked,
    each: &'a mut dyn FnMut(Finding),
}

/// A file, its folder, and what is recorded of it: bytes and digest.
struct Expected<'a> {
    path: PathBuf,
    root: &'a Path,
    bytes: u64,
    sha256: String,
}

impl<'a> Checker<'a> {
    /// Takes what a manifest says of one image.
    fn entry(&mut self, manifest: &Path, key: &str, entry: &Entry) {
        for written in entry.listed() {
            self.add(manifest, self.folder, written);
        }
        if let Some(root) = self.dataset
            && let Some((bytes, sha256)) = source(entry)
        {
            self.add(manifest, root, Listed { output: key, bytes, sha256 });
        }
    }

    /// Takes a file below `root`.
    fn add(&mut self, manifest: &Path, root: &'a Path, written: Listed<'_>) {
        self.checked.files = self.checked.files.saturating_add(1);
        match inside(written.output) {
            Ok(within) => {
                let path = root.join(within);
                self.know(&path);
                let (bytes, sha256) = (written.bytes, written.sha256.to_owned());
                self.batch.push(Expected { path, root, bytes, sha256 });
                if self.batch.len() >= AT_ONCE {
                    self.check();
                }
            }
            Err(cause) => {
                let cause = format!("{:?} is {cause}", written.output);
                self.wrong(manifest.to_owned(), cause);
            }
        }
    }

    /// Compares what was taken.
    fn check(&mut self) {
        let wrong = self.batch.par_drain(..).filter_map(|expected| {
            let cause = hold(&expected).err()?;
            Some((expected.path, cause))
        });
        for (path, cause) in wrong.collect::<Vec<_>>() {
            self.wrong(path, cause);
        }
    }

    /// Says of a file that it is wrong: once, though several manifests may list it.
    fn wrong(&mut self, path: PathBuf, cause: String) {
        if self.found_wrong.insert(self.keys.hash_one((&path, &cause))) {
            self.checked.wrong = self.checked.wrong.saturating_add(1);
            (self.each)(Finding::Wrong(path, cause));
        }
    }

    /// Takes a manifest itself.
    fn manifest(&mut self, path: PathBuf, sealed: Option<bool>) {
        self.checked.files = self.checked.files.saturating_add(1);
        self.know(&path);
        let cause = match sealed {
            Some(true) => return,
            Some(false) => "its digest does not match: it was changed",
            None => "its run has not ended; repeat the command to continue",
        };
        self.wrong(path, cause.into());
    }

    fn know(&mut self, path: &Path) {
        self.listed.insert(self.keys.hash_one(path));
    }

    /// The result; `there` are the files of the folder.
    fn end(self, there: impl Iterator<Item = PathBuf>) -> Checked {
        let Self { keys, listed, mut checked, each, .. } = self;
        for path in there.filter(|path| !listed.contains(&keys.hash_one(path))) {
            checked.unlisted = checked.unlisted.saturating_add(1);
            each(Finding::Unlisted(path));
        }
        checked
    }
}

/// What is recorded of the image that variants were made from.
fn source(entry: &Entry) -> Option<(u64, &str)> {
    let variant = entry.variants.first_key_value().map(|(_, variant)| &variant.source);
    let source = entry.container.as_ref().map(|held| &held.source).or(variant);
    // What was copied unchanged has the digest of its source.
    let own = || entry.original.as_ref().map(|own| (own.bytes, own.sha256.as_str()));
    source.map(|source| (source.bytes, source.sha256.as_str())).or_else(own)
}

/// Compares a file of a folder with its record.
fn hold(expected: &Expected<'_>) -> Result<(), String> {
    let Expected { path, root, bytes, sha256 } = expected;
    let about = path.metadata().map_err(|error| match error.kind() {
        std::io::ErrorKind::NotFound => "it is missing".to_owned(),
        _ => format!("it cannot be read: {error}"),
    })?;
    if !about.is_file() {
        return Err("it is no regular file any more".to_owned());
    }
    if !stays_within(root, path) {
        return Err("it is reached through a link that leads out of its folder".to_owned());
    }
    if about.len() != *bytes {
        return Err(format!("it has {} bytes instead of {bytes}", about.len()));
    }
    let found = sha256_of(path).map_err(|error| match error {
        FileError::Read { error, .. } => format!("it cannot be read: {error}"),
        other => other.to_string(),
    })?;
    if found == *sha256 { Ok(()) } else { Err("its content changed".to_owned()) }
}
