//! Printing to standard output and standard error.

use std::io::{ErrorKind, Write};
use std::path::Path;

use anyhow::anyhow;
use aquafuse_data::files::{display, holds_files, plain_json};

use crate::failure::Failure;

/// Prints a message to standard error. That it cannot be printed is ignored: there is no other place for it.
pub(crate) fn complain(what: &impl std::fmt::Display) {
    let _ = writeln!(std::io::stderr(), "aquafuse: {what}");
}

/// Says something on standard error that is no complaint.
pub(crate) fn remark(what: &impl std::fmt::Display) {
    let _ = writeln!(std::io::stderr(), "{what}");
}

/// Refuses a folder that holds files, but for entries of these names.
pub(crate) fn refuse_filled(folder: &Path, except: &[&str]) -> Result<(), Failure> {
    match holds_files(folder, except) {
        false => Ok(()),
        true => Err(Failure::usage(anyhow!(
            "{} is not empty; name another folder with -o, or add --overwrite",
            display(folder)
        ))),
    }
}

/// Says that a file or folder is written, unless `quiet`.
pub(crate) fn written(path: &Path, quiet: bool) -> Result<(), Failure> {
    if quiet { Ok(()) } else { print(&format!("{}: written\n", display(path))) }
}

/// Prints JSON, which may hold names of strangers.
pub(crate) fn print_json(json: &str) -> Result<(), Failure> {
    print(&plain_json(json))
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
