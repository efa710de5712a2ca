//! Reading that a signal may interrupt, as it happens on network file systems.

use std::io::{self, ErrorKind, Read, Seek, SeekFrom};

/// A reader that reads again when it was interrupted, as decoders do not.
#[derive(Debug)]
pub(crate) struct Patient<R>(pub(crate) R);

impl<R: Read> Read for Patient<R> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        loop {
            match self.0.read(into) {
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                read => return read,
            }
        }
    }
}

impl<R: Seek> Seek for Patient<R> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.0.seek(to)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::{BufRead, BufReader};

    /// Is interrupted before each read that gives something.
    struct Interrupted {
        bytes: io::Cursor<Vec<u8>>,
        is_next: bool,
    }

    impl Read for Interrupted {
        fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
            self.is_next = !self.is_next;
            if self.is_next { Err(ErrorKind::Interrupted.into()) } else { self.bytes.read(into) }
        }
    }

    #[test]
    fn a_read_that_is_interrupted_is_tried_again() {
        let from = || Interrupted { bytes: io::Cursor::new(b"abc".to_vec()), is_next: false };
        assert!(BufReader::new(from()).fill_buf().is_err(), "decoders do not try again");
        assert_eq!(BufReader::new(Patient(from())).fill_buf().unwrap(), b"abc");
    }
}
