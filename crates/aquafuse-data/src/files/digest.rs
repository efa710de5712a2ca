//! SHA-256 digests of files.

use std::fmt::Write as _;
use std::fs::File;
use std::io::{self, Write};
use std::path::Path;

use sha2::{Digest, Sha256};

use crate::files::FileError;

/// The digest of bytes, in 64 hexadecimal digits, as `sha256sum` prints it.
pub fn sha256(bytes: &[u8]) -> String {
    hexadecimal(&Sha256::digest(bytes))
}

/// The digest of a file, read piece by piece.
pub(crate) fn sha256_of(path: &Path) -> Result<String, FileError> {
    let mut digest = Hashed::new(io::sink());
    let read = File::open(path).and_then(|mut file| io::copy(&mut file, &mut digest));
    read.map_err(|error| FileError::Read { path: path.to_owned(), error })?;
    Ok(digest.result().1)
}

/// The digits of a digest.
pub(crate) fn hexadecimal(digest: &[u8]) -> String {
    let mut digits = String::new();
    for byte in digest {
        let _ = write!(digits, "{byte:02x}");
    }
    digits
}

/// Passes on what is written, and computes its digest.
pub(crate) struct Hashed<W> {
    out: W,
    digest: Sha256,
    bytes: u64,
}

impl<W> Hashed<W> {
    pub(crate) fn new(out: W) -> Self {
        Self { out, digest: Sha256::new(), bytes: 0 }
    }

    /// The bytes that were written, and their digest.
    pub(crate) fn result(&self) -> (u64, String) {
        (self.bytes, hexadecimal(&self.digest.clone().finalize()))
    }

    /// Where it was written to.
    pub(crate) fn into_inner(self) -> W {
        self.out
    }
}

impl<W: Write> Write for Hashed<W> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let written = self.out.write(bytes)?;
        self.digest.update(bytes.get(..written).unwrap_or_default());
        self.bytes = self.bytes.saturating_add(written as u64);
        Ok(written)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.out.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digests_are_the_published_ones() {
        let abc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(sha256(b"abc"), abc);
    }
}
