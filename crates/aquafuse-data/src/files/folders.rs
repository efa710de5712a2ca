//! Folders for outputs.

use std::fs::DirEntry;
use std::io::ErrorKind;
use std::path::Path;

use super::FileError;

/// Makes a folder, and those above it.
///
/// # Errors
///
/// [`FileError::Folder`] when it cannot be made.
pub fn make_folder(folder: &Path) -> Result<(), FileError> {
    std::fs::create_dir_all(folder).map_err(|error| {
        let cause = match error.kind() {
            ErrorKind::AlreadyExists | ErrorKind::NotADirectory => "there is a file of that name".into(),
            _ => error.to_string(),
        };
        FileError::Folder { path: folder.to_owned(), cause }
    })
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
