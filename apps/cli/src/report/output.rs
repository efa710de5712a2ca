//! Printing to standard output and standard error.

use std::fs::DirEntry;
use std::io::{ErrorKind, Write};
use std::path::Path;

use anyhow::anyhow;
use aquafuse_data::files::display;

use crate::failure::Failure;

/// Prints a message to standard error. That it cannot be printed is ignored: there is no other place for it.
pub(crate) fn complain(what: &impl std::fmt::Display) {
    let _ = writeln!(std::io::stderr(), "aquafuse: {what}");
}

/// Refuses a folder in which something stands, but for entries of these names. Folders without a file count as nothing: they
/// are what a run leaves that was killed before its first file.
pub(crate) fn refuse_filled(folder: &Path, but: &[&str]) -> Result<(), Failure> {
    match entries(folder)
        .any(|entry| !but.iter().any(|name| entry.file_name() == *name) && holds_a_file(&entry))
    {
        false => Ok(()),
        true => Err(Failure::usage(anyhow!(
            "{} is not empty; name another folder with -o, or add --overwrite",
            display(folder)
        ))),
    }
}

fn holds_a_file(entry: &DirEntry) -> bool {
    let is_folder = entry.file_type().is_ok_and(|kind| kind.is_dir());
    !is_folder || entries(&entry.path()).any(|entry| holds_a_file(&entry))
}

fn entries(folder: &Path) -> impl Iterator<Item = DirEntry> {
    folder.read_dir().into_iter().flatten().flatten()
}

/// Says that a file or folder is written, unless `quiet`.
pub(crate) fn written(path: &Path, quiet: bool) -> Result<(), Failure> {
    if quiet { Ok(()) } else { print(&format!("{}: written\n", display(path))) }
}

/// Prints `text`; a reader that has gone away (`| head`) is no error.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let mut stdout = std::io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::work(anyhow::Error::new(error).context("cannot write to standard output")))
        }
        _ => Ok(()),
    }
}
