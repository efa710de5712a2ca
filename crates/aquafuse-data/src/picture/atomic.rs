//! A file is there whole or not at all.

use std::io::{BufWriter, Write};
use std::path::Path;

use tempfile::{Builder, NamedTempFile};

use super::FileError;

/// Writes a file through a temporary one in the same folder, which then takes its name.
///
/// The data is on the disk before this returns, and the folder entry where the folder may be opened. When
/// `fill` or the system fails, the temporary file is removed and `path` is as it was.
pub(crate) fn write_atomically<E: std::fmt::Display>(
    path: &Path,
    overwrite: bool,
    fill: impl FnOnce(&mut dyn Write) -> Result<(), E>,
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
    let part = create_part(folder).map_err(|error| failed(format!("its folder: {}", error.kind())))?;
    let mut buffered = BufWriter::new(part);
    fill(&mut buffered).map_err(|error| failed(error.to_string()))?;
    let part = buffered.into_inner().map_err(|error| failed(error.to_string()))?;
    part.as_file().sync_all().map_err(|error| failed(error.to_string()))?;
    if overwrite {
        part.persist(path).map_err(|refused| failed(refused.error.to_string()))?;
    } else {
        part.persist_noclobber(path).map_err(|refused| match refused.error.kind() {
            std::io::ErrorKind::AlreadyExists => exists(),
            _ => failed(refused.error.to_string()),
        })?;
    }
    sync_folder(folder);
    Ok(())
}

fn create_part(folder: &Path) -> std::io::Result<NamedTempFile> {
    let mut builder = Builder::new();
    builder.prefix(".aquafuse-").suffix(".part");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // Temporary files are private by default; this one becomes an ordinary file, so the umask decides.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder)
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
