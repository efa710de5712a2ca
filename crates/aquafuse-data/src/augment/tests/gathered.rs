//! What a check or a replay gives one by one, gathered.

use std::fs;
use std::path::{Path, PathBuf};

use super::{dataset, job, making, run};
use crate::augment::{Again, AugmentError, Finding, Replayed, replay, verify};
use crate::files::FileError;
use crate::image_file::ReadOptions;

#[derive(Debug, Default)]
pub(super) struct Check {
    pub(super) files: usize,
    pub(super) wrong: Vec<(PathBuf, String)>,
    pub(super) unlisted: Vec<PathBuf>,
}

pub(super) fn check(
    folder: &Path,
    dataset: Option<&Path>,
    reading: &ReadOptions,
) -> Result<Check, AugmentError> {
    let mut check = Check::default();
    let checked = verify(folder, dataset, reading, |finding| match finding {
        Finding::Wrong(path, cause) => check.wrong.push((path, cause)),
        Finding::Unlisted(path) => check.unlisted.push(path),
    })?;
    assert_eq!((checked.wrong, checked.unlisted), (check.wrong.len(), check.unlisted.len()));
    check.files = checked.files;
    Ok(check)
}

#[derive(Debug, Default)]
pub(super) struct Remade {
    pub(super) equal: Vec<PathBuf>,
    pub(super) kept: Vec<PathBuf>,
    pub(super) different: Vec<PathBuf>,
    pub(super) failed: Vec<FileError>,
}

pub(super) fn remake(manifest: &Path, again: &Again<'_>) -> Result<Remade, AugmentError> {
    let mut remade = Remade::default();
    replay(manifest, again, |made| match made {
        Replayed::Equal(path) => remade.equal.push(path),
        Replayed::Kept(path) => remade.kept.push(path),
        Replayed::Different(path) => remade.different.push(path),
        Replayed::Failed(error) => remade.failed.push(error),
    })?;
    Ok(remade)
}

#[test]
fn lines_of_a_run_that_has_not_ended_are_gathered_by_image() {
    let place = tempfile::tempdir().unwrap();
    let (root, out) = (place.path().join("fish"), place.path().join("out"));
    dataset(&root);
    run(&job(&root, &out));
    let whole = check(&out, Some(&root), &ReadOptions::default()).unwrap();
    let manifest = out.join("manifest.jsonl");
    let text = fs::read_to_string(&manifest).unwrap();
    let mut lines: Vec<&str> = text.lines().collect();
    assert!(lines.pop().unwrap().contains("\"end\""));
    // The first stays the first; the others as if images had been made by turns.
    lines[1..].sort_by_key(|line| line.chars().rev().collect::<String>());
    fs::write(&manifest, lines.join("\n") + "\n").unwrap();

    let parted = check(&out, Some(&root), &ReadOptions::default()).unwrap();
    assert_eq!(parted.files, whole.files);
    assert!(matches!(&parted.wrong[..], [(path, cause)] if *path == manifest && cause.contains("not ended")));
    let again = place.path().join("again");
    let remade = remake(&manifest, &making(None, None, &again)).unwrap();
    assert_eq!((remade.equal.len(), remade.different.len(), remade.failed.len()), (12, 0, 0));
    // A replay that is repeated goes on.
    let lost = &remade.equal[5];
    fs::remove_file(lost).unwrap();
    let rest = remake(&manifest, &making(None, None, &again)).unwrap();
    assert_eq!((&rest.equal[..], rest.kept.len()), (std::slice::from_ref(lost), 11));
}
