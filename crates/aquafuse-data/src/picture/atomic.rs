//! A file is there whole or not at all.

mod parts;

use std::io::{BufWriter, Seek, Write};
use std::path::Path;

use super::FileError;
use parts::Part;

pub use parts::{abandon_parts, remove_stale_parts};

/// What a file is written through.
pub(crate) trait Output: Write + Seek + Send {}

impl<W: Write + Seek + Send> Output for W {}

/// Writes a text as a file, whole or not at all.
///
/// # Errors
///
/// [`FileError`] when the file exists and may not be replaced, or the system refuses.
pub fn write_text(path: &Path, text: &str, overwrite: bool) -> Result<(), FileError> {
    write_bytes(path, text.as_bytes(), overwrite)
}

/// Writes bytes as a file, whole or not at all.
///
/// # Errors
///
/// As [`write_text`].
pub fn write_bytes(path: &Path, bytes: &[u8], overwrite: bool) -> Result<(), FileError> {
    write_atomically(path, overwrite, |out| out.write_all(bytes))
}

/// Writes a file through a temporary one in the same folder, which then takes its name.
///
/// The data is on the disk before this returns, and the folder entry where the folder may be opened. When
/// `fill` or the system fails, the temporary file is removed and `path` is as it was.
pub(crate) fn write_atomically<E: std::fmt::Display>(
    path: &Path,
    overwrite: bool,
    fill: impl FnOnce(&mut dyn Output) -> Result<(), E>,
) -> Result<(), FileError> {
    let failed = |cause: String| FileError::Write { path: path.to_owned(), cause };
    let exists = || FileError::Exists { path: path.to_owned() };
    if !overwrite && path.symlink_metadata().is_ok() {
        return Err(exists());
    }
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    // The kind alone: the whole message would name the temporary file.
    let part = Part::create_in(folder).map_err(|error| failed(format!("its folder: {}", error.kind())))?;
    let mut buffered = BufWriter::new(part.file());
    fill(&mut buffered).map_err(|error| failed(error.to_string()))?;
    let file = buffered.into_inner().map_err(|error| failed(error.to_string()))?;
    file.sync_all().map_err(|error| failed(error.to_string()))?;
    part.persist(path, overwrite).map_err(|error| match error.kind() {
        std::io::ErrorKind::AlreadyExists if !overwrite => exists(),
        _ => failed(error.to_string()),
    })?;
    sync_folder(folder);
    Ok(())
}

/// Asks for the folder entry to be on the disk too. The file has its name by now: a folder that cannot be
/// opened for reading, or not be synced, makes it no less written.
fn sync_folder(folder: &Path) {
    #[cfg(unix)]
    if let Ok(folder) = std::fs::File::open(folder) {
        let _ = folder.sync_all();
    }
    #[cfg(not(unix))]
    let _ = folder;
}
