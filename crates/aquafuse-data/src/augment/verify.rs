//! Compares files with their manifest, bit for bit.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::AugmentError;
use super::journal::manifests;
use super::line::Listed;
use super::manifest::Manifest;
use crate::dataset::{Tree, inside};
use crate::files::{FileError, sha256_of, stays_within};
use crate::image_file::ReadOptions;

/// The result of a check.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Check {
    /// Files that were checked.
    pub files: usize,
    /// Files that are missing or changed, with the cause in words.
    pub wrong: Vec<(PathBuf, String)>,
    /// Files in the folder that no manifest lists.
    pub unlisted: Vec<PathBuf>,
}

/// Checks every file that the manifests in a folder list, and the manifests themselves; with `dataset`, the source
/// images in this dataset too. No line of a manifest may be longer than a quarter of the memory that `reading` allows.
///
/// # Errors
///
/// [`AugmentError`] when there is no manifest, or one cannot be read.
pub fn verify(folder: &Path, dataset: Option<&Path>, reading: &ReadOptions) -> Result<Check, AugmentError> {
    let mut check = Check::default();
    let paths = manifests(folder)?;
    let mut listed: BTreeSet<PathBuf> = paths.iter().cloned().collect();
    if paths.is_empty() {
        return Err(AugmentError::NoManifest { folder: folder.to_owned() });
    }
    for path in paths {
        let found = Manifest::read(&path, reading)?;
        check.files = check.files.saturating_add(1);
        match found.sealed {
            Some(true) => {}
            Some(false) => {
                check.wrong.push((path.clone(), "its digest does not match: it was changed".into()));
            }
            None => {
                check
                    .wrong
                    .push((path.clone(), "its run has not ended; repeat the command to continue".into()));
            }
        }
        let mut files: Vec<(PathBuf, Result<Expected<'_>, String>)> = found
            .listed()
            .map(|written| match inside(written.output) {
                Ok(within) => (folder.join(within), Ok((folder, written))),
                Err(cause) => (path.clone(), Err(format!("{:?} is {cause}", written.output))),
            })
            .collect();
        if let Some(root) = dataset {
            let sources = sources(&found).into_iter().map(|(key, bytes, sha256)| match inside(key) {
                Ok(within) => {
                    let written = Listed { output: key, bytes, sha256 };
                    (root.join(within), Ok((root, written)))
                }
                Err(cause) => (path.clone(), Err(format!("{key:?} is {cause}"))),
            });
            files.extend(sources);
        }
        check.files = check.files.saturating_add(files.len());
        listed.extend(files.iter().map(|(path, _)| path.clone()));
        let wrong = files.into_par_iter().filter_map(|(path, written)| {
            let cause = written.and_then(|(root, written)| hold(root, &path, written)).err()?;
            Some((path, cause))
        });
        check.wrong.par_extend(wrong);
    }
    check.wrong.sort();
    check.wrong.dedup();
    let there = Tree::of(folder, reading)?.files.into_iter().map(|path| folder.join(path));
    check.unlisted = there.filter(|path| !listed.contains(path)).collect();
    Ok(check)
}

/// The folder of a file, and what is recorded of it.
type Expected<'a> = (&'a Path, Listed<'a>);

/// The keys of the images that variants were made from, and what is recorded of those.
fn sources(found: &Manifest) -> Vec<(&String, u64, &str)> {
    let mut sources = Vec::new();
    for (key, entry) in &found.entries {
        let variant = entry.variants.first_key_value().map(|(_, variant)| &variant.source);
        let source = entry.container.as_ref().map(|held| &held.source).or(variant);
        // What was copied unchanged has the digest of its source.
        let own = || entry.original.as_ref().map(|own| (own.bytes, own.sha256.as_str()));
        let source = source.map(|source| (source.bytes, source.sha256.as_str())).or_else(own);
        sources.extend(source.map(|(bytes, sha256)| (key, bytes, sha256)));
    }
    sources
}

/// Compares a file of a folder with its record.
fn hold(root: &Path, path: &Path, written: Listed<'_>) -> Result<(), String> {
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
    if about.len() != written.bytes {
        return Err(format!("it has {} bytes instead of {}", about.len(), written.bytes));
    }
    let sha256 = sha256_of(path).map_err(|error| match error {
        FileError::Read { error, .. } => format!("it cannot be read: {error}"),
        other => other.to_string(),
    })?;
    if sha256 == written.sha256 { Ok(()) } else { Err("its content changed".to_owned()) }
}
