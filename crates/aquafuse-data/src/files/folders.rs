//! Folders for outputs.

use std::collections::HashMap;
use std::ffi::OsStr;
use std::fs::DirEntry;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use super::FileError;
use super::atomic::{folder_of, sync_folder, write_text};

/// Makes a folder, and those above it. New ones are on the disk when this returns.
///
/// # Errors
///
/// [`FileError::Folder`] when it cannot be made.
pub fn make_folder(folder: &Path) -> Result<(), FileError> {
    let new: Vec<&Path> = folder.ancestors().take_while(|above| !above.exists()).collect();
    std::fs::create_dir_all(folder).map_err(|error| {
        let cause = match error.kind() {
            ErrorKind::AlreadyExists | ErrorKind::NotADirectory => "there is a file of that name".into(),
            _ => error.to_string(),
        };
        FileError::Folder { path: folder.to_owned(), cause }
    })?;
    new.into_iter().filter(|new| !new.as_os_str().is_empty()).map(folder_of).for_each(sync_folder);
    Ok(())
}

/// Makes a folder of an output folder, and those between: through no link that leads out.
pub(crate) fn make_folder_within(root: &Path, folder: impl AsRef<Path>) -> Result<PathBuf, FileError> {
    make_folder(root)?;
    let mut path = root.to_owned();
    for part in folder.as_ref().components() {
        path.push(part);
        if path.is_symlink() && !stays_within(root, &path) {
            let cause = "it is a link that is broken or leads out of the output; remove it".into();
            return Err(FileError::Folder { path, cause });
        }
    }
    make_folder(&path)?;
    Ok(path)
}

/// The file that says that a folder was made to work in.
const MARK: &str = ".aquafuse-work";

/// Makes an empty folder to work in, in the place of one that a run before this one has left.
///
/// # Errors
///
/// [`FileError`] when something of this name was not made by this function, or it cannot be made.
pub fn make_work_folder(folder: &Path) -> Result<(), FileError> {
    if folder.symlink_metadata().is_ok() {
        if folder.is_symlink() || !folder.join(MARK).is_file() {
            let cause = "there is something of that name that no run has made; move it away".into();
            return Err(FileError::Folder { path: folder.to_owned(), cause });
        }
        let failed =
            |error: std::io::Error| FileError::Folder { path: folder.to_owned(), cause: error.to_string() };
        std::fs::remove_dir_all(folder).map_err(failed)?;
    }
    make_folder(folder)?;
    write_text(&folder.join(MARK), "", false)
}

/// Whether a file or folder that exists is in a folder, when links are followed.
pub(crate) fn stays_within(root: &Path, path: &Path) -> bool {
    matches!((root.canonicalize(), path.canonicalize()), (Ok(root), Ok(path)) if path.starts_with(&root))
}

/// Where a file of this path stands or would stand, when links of its folders are followed: what is written to two paths of
/// one place is written to one file.
pub fn place_of(path: &Path) -> Option<PathBuf> {
    Some(folder_of(path).canonicalize().ok()?.join(path.file_name()?))
}

/// Refuses outputs that stand where an input does, by whatever path.
///
/// # Errors
///
/// [`FileError::IsInput`] for the first output that does.
pub fn refuse_inputs<'o, 'i>(
    outputs: impl IntoIterator<Item = &'o Path>,
    inputs: impl IntoIterator<Item = &'i Path>,
) -> Result<(), FileError> {
    // Few inputs are called as an output is; only those are looked up.
    let mut by_name: HashMap<&OsStr, Vec<&Path>> = HashMap::new();
    for input in inputs {
        by_name.entry(input.file_name().unwrap_or_default()).or_default().push(input);
    }
    for output in outputs {
        let alike = by_name.get(output.file_name().unwrap_or_default());
        let mut alike = alike.into_iter().flatten();
        if alike.any(|input| place_of(output).is_some_and(|place| place_of(input) == Some(place))) {
            return Err(FileError::IsInput { path: output.to_owned() });
        }
    }
    Ok(())
}

/// Makes the folder of `file` and its parents, and returns it.
///
/// # Errors
///
/// As [`make_folder`].
pub fn make_folder_of(file: &Path) -> Result<&Path, FileError> {
    match file.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => make_folder(folder).map(|()| folder),
        _ => Ok(Path::new(".")),
    }
}

/// Whether a folder holds a file, in folders inside it too; entries of the names in `except` are not looked at.
///
/// Folders without a file do not count: a run that was killed before its first file leaves them.
pub fn holds_files(folder: &Path, except: &[&str]) -> bool {
    entries(folder).any(|entry| !except.iter().any(|name| entry.file_name() == *name) && holds_a_file(&entry))
}

fn holds_a_file(entry: &DirEntry) -> bool {
    let is_folder = entry.file_type().is_ok_and(|kind| kind.is_dir());
    !is_folder || entries(&entry.path()).any(|entry| holds_a_file(&entry))
}

fn entries(folder: &Path) -> impl Iterator<Item = DirEntry> {
    folder.read_dir().into_iter().flatten().flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_that_is_not_ours_to_work_in_stays() {
        let folder = tempfile::tempdir().unwrap();
        let (mine, work) = (folder.path().join("mine"), folder.path().join("work"));
        std::fs::create_dir(&mine).unwrap();
        std::fs::write(mine.join("notes.txt"), "").unwrap();
        assert!(make_work_folder(&mine).is_err() && mine.join("notes.txt").exists());
        make_work_folder(&work).unwrap();
        std::fs::write(work.join("left"), "").unwrap();
        make_work_folder(&work).unwrap();
        assert!(!work.join("left").exists());
    }

    #[cfg(unix)]
    #[test]
    fn no_folder_is_made_through_a_link_that_leads_out() {
        let (folder, elsewhere) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let link = |to: &Path, name: &str| std::os::unix::fs::symlink(to, folder.path().join(name)).unwrap();
        link(elsewhere.path(), "out");
        link(&elsewhere.path().join("missing"), "broken");
        std::fs::create_dir(folder.path().join("real")).unwrap();
        link(&folder.path().join("real"), "in");
        for (within, is_made) in
            [("out", false), ("out/a", false), ("broken/a", false), ("in/a", true), ("b/c", true)]
        {
            assert_eq!(make_folder_within(folder.path(), within).is_ok(), is_made, "{within}");
        }
        assert_eq!(entries(elsewhere.path()).count(), 0);
    }
}
