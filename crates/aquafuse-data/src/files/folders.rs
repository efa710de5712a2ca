//! Folders for outputs.

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
