//! Temporary files: whose they are, and who removes them.
//!
//! A part is locked by the process that fills it, so that whoever finds one without a lock knows that its process
//! is gone.

use std::fs::{File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::{Builder, NamedTempFile};

use super::folder_of;
use crate::files::{FileError, sha256};

const PREFIX: &str = ".aquafuse-";
const SUFFIX: &str = ".part";

/// The parts that this process is filling.
static IN_WORK: Mutex<InWork> = Mutex::new(InWork { paths: Vec::new(), abandoned: false });

struct InWork {
    paths: Vec<PathBuf>,
    abandoned: bool,
}

/// The parts in work; never again once they are abandoned.
fn in_work() -> MutexGuard<'static, InWork> {
    let in_work = IN_WORK.lock().unwrap_or_else(PoisonError::into_inner);
    if in_work.abandoned {
        drop(in_work);
        // The process is about to end, and this thread with it.
        loop {
            std::thread::park();
        }
    }
    in_work
}

/// A temporary file that is removed unless it takes its name in the end.
pub(super) struct Part(Option<NamedTempFile>);

impl Part {
    pub(super) fn create_in(folder: &Path) -> io::Result<Self> {
        Self::create_by(|| builder().tempfile_in(folder))
    }

    fn create_by(create: impl Fn() -> io::Result<NamedTempFile>) -> io::Result<Self> {
        loop {
            let mut in_work = in_work();
            let part = create()?;
            // Between making and locking it, another process may have taken it for one left behind. A file system
            // without locks cannot show whose a part is; then only its own process removes it.
            let taken = matches!(part.as_file().try_lock(), Err(TryLockError::WouldBlock));
            if !taken && part.path().exists() {
                in_work.paths.push(part.path().to_owned());
                return Ok(Self(Some(part)));
            }
        }
    }

    pub(super) fn file(&self) -> &File {
        self.0.as_ref().expect("a part holds its file until it takes its name").as_file()
    }

    pub(super) fn path(&self) -> &Path {
        self.0.as_ref().expect("a part holds its file until it takes its name").path()
    }

    /// Gives the file its name.
    pub(super) fn persist(mut self, path: &Path, overwrite: bool) -> io::Result<()> {
        let Some(part) = self.0.take() else { return Ok(()) };
        let before = part.path().to_owned();
        // What was private stays so. Where the mode cannot be set, the file is none the less written.
        if let Some(about) = path.symlink_metadata().ok().filter(|about| overwrite && about.is_file()) {
            let _ = part.as_file().set_permissions(about.permissions());
        }
        // Held over the renaming: a part that is abandoned between must not look like a failure.
        let mut in_work = in_work();
        let named = if overwrite { part.persist(path) } else { part.persist_noclobber(path) };
        in_work.paths.retain(|part| *part != before);
        drop(in_work);
        // Where it failed, the part is dropped with the error, and so removed.
        named.map(|_| ()).map_err(|refused| refused.error)
    }
}

impl Drop for Part {
    fn drop(&mut self) {
        if let Some(part) = self.0.take() {
            let path = part.path().to_owned();
            drop(part);
            forget(&path);
        }
    }
}

/// An output that a long run will write at its end, claimed from the beginning: another run to the same output is refused
/// meanwhile. It is given back when dropped.
#[must_use = "an output is claimed until this is dropped"]
pub struct Claim {
    _part: Part,
}

impl Claim {
    /// Claims an output whose folder exists.
    ///
    /// # Errors
    ///
    /// [`FileError::Busy`] when another process has claimed it.
    pub fn of(output: &Path) -> Result<Self, FileError> {
        let folder = folder_of(output);
        let name = output.file_name().unwrap_or_default().as_encoded_bytes();
        let prefix = format!("{PREFIX}{}", sha256(name));
        let mut named = builder();
        named.prefix(&prefix).rand_bytes(0);
        let made = Part::create_by(|| named.tempfile_in(folder)).or_else(|_| {
            // Of a process that was killed.
            remove_stale_parts(folder);
            Part::create_by(|| named.tempfile_in(folder))
        });
        match made {
            Ok(part) => Ok(Self { _part: part }),
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
                Err(FileError::Busy { folder: output.to_owned() })
            }
            Err(error) => Err(FileError::Write { path: output.to_owned(), cause: error.kind().to_string() }),
        }
    }
}

impl std::fmt::Debug for Claim {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Claim").finish_non_exhaustive()
    }
}

fn forget(path: &Path) {
    in_work().paths.retain(|part| part != path);
}

fn builder() -> Builder<'static, 'static> {
    let mut builder = Builder::new();
    builder.prefix(PREFIX).suffix(SUFFIX);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // Temporary files are private by default; this one becomes an ordinary file, so the umask decides.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder
}

/// Removes the temporary files that this process is filling; whoever would begin another waits for ever.
///
/// For a program that received a signal, right before it ends: what has its name by then is whole, and nothing
/// else is left.
pub fn abandon_parts() {
    let mut in_work = IN_WORK.lock().unwrap_or_else(PoisonError::into_inner);
    in_work.abandoned = true;
    for path in in_work.paths.drain(..) {
        let _ = std::fs::remove_file(path);
    }
}

/// Removes the temporary files that processes which were killed left in a folder, and says how many.
///
/// Those of processes that are still at work are locked, and stay.
pub fn remove_stale_parts(folder: &Path) -> usize {
    let Ok(entries) = std::fs::read_dir(folder) else { return 0 };
    let is_part = |path: &Path| {
        path.file_name()
            .and_then(|name| name.to_str())
            .is_some_and(|name| name.starts_with(PREFIX) && name.ends_with(SUFFIX))
    };
    let remove = |path: &PathBuf| {
        // The lock is held until the file is gone: who made it a moment ago sees that it was taken.
        path.symlink_metadata().is_ok_and(|about| about.is_file())
            && File::open(path)
                .is_ok_and(|file| file.try_lock().is_ok() && std::fs::remove_file(path).is_ok())
    };
    let parts = entries.filter_map(|entry| Some(entry.ok()?.path())).filter(|path| is_part(path));
    parts.filter(remove).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_output_is_claimed_once_at_a_time_and_what_a_killed_process_left_is_no_claim() {
        let folder = tempfile::tempdir().unwrap();
        let output = folder.path().join("reef.ply");
        let claim = Claim::of(&output).unwrap();
        let left = std::fs::read_dir(folder.path()).unwrap().next().unwrap().unwrap().path();
        assert!(matches!(Claim::of(&output), Err(FileError::Busy { .. })));
        assert!(Claim::of(&folder.path().join("other.ply")).is_ok());
        drop(claim);
        std::fs::write(left, "").unwrap();
        assert!(Claim::of(&output).is_ok());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
