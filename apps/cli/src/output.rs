//! What is said, and where.

use std::io::{ErrorKind, Write};

use crate::failure::Failure;

/// Says on standard error what went wrong. If nobody listens there, there is nobody to tell.
pub(crate) fn complain(what: &impl std::fmt::Display) {
    let _ = writeln!(std::io::stderr(), "aquafuse: {what}");
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
