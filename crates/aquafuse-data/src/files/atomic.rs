//! A file is there whole or not at all.

mod parts;

use std::io::{BufWriter, Seek, Write};
use std::path::{Path, PathBuf};

use super::FileError;
use parts::Part;

pub use parts::{Claim, abandon_parts, remove_stale_parts};

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
    Staged::fill(path, overwrite, fill)?.persist()
}

/// A temporary file that is filled and has not taken its name yet; it is removed if it never does.
pub(crate) struct Staged {
    path: PathBuf,
    overwrite: bool,
    part: Part,
}

impl Staged {
    /// Fills the file that will stand at `path`.
    pub(crate) fn fill<E: std::fmt::Display>(
        path: &Path,
        overwrite: bool,
        fill: impl FnOnce(&mut dyn Output) -> Result<(), E>,
    ) -> Result<Self, FileError> {
        let path = path.to_owned();
        if !overwrite && path.symlink_metadata().is_ok() {
            return Err(FileError::Exists { path });
        }
        let failed = |cause: String| FileError::Write { path: path.clone(), cause };
        // The kind alone: the whole message would name the temporary file.
        let part = Part::create_in(folder_of(&path))
            .map_err(|error| failed(format!("its folder: {}", error.kind())))?;
        let mut buffered = BufWriter::new(part.file());
        fill(&mut buffered).map_err(|error| failed(error.to_string()))?;
        buffered.into_inner().map_err(|error| failed(error.to_string()))?;
        Ok(Self { path, overwrite, part })
    }

    /// An empty file, for another program to fill by the name of its [`part`](Self::part).
    pub(crate) fn empty(path: &Path, overwrite: bool) -> Result<Self, FileError> {
        Self::fill(path, overwrite, |_| Ok::<(), std::convert::Infallible>(()))
    }

    /// The temporary file.
    pub(crate) fn part(&self) -> &Path {
        self.part.path()
    }

    /// Waits until it is on the disk, and gives it its name.
    pub(crate) fn persist(self) -> Result<(), FileError> {
        let Self { path, overwrite, part } = self;
        let failed = |cause: String| FileError::Write { path: path.clone(), cause };
        part.file().sync_all().map_err(|error| failed(error.to_string()))?;
        part.persist(&path, overwrite).map_err(|error| match error.kind() {
            std::io::ErrorKind::AlreadyExists if !overwrite => FileError::Exists { path: path.clone() },
            _ => failed(error.to_string()),
        })?;
        sync_folder(folder_of(&path));
        Ok(())
    }
}

pub(super) fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// Asks for the folder entry to be on the disk too. The file has its name by now: a folder that cannot be
/// opened for reading, or not be synced, makes it no less written.
pub(super) fn sync_folder(folder: &Path) {
    #[cfg(unix)]
    if let Ok(folder) = std::fs::File::open(folder) {
        let _ = folder.sync_all();
    }
    #[cfg(not(unix))]
    let _ = folder;
}
