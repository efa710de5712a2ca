//! Files read whole, and little-endian numbers taken from them.

use std::io::Read;
use std::path::Path;

use aquafuse_data::files::FileError;
use aquafuse_data::image_file::ReadOptions;

use super::SceneFileError;

/// The most bytes a file of a scene may have: ten million splats of degree 3.
const MOST_BYTES: u64 = 4 << 30;
/// What reading a file takes, in its sizes: its bytes, and what is made of them.
const TIMES: u64 = 2;

/// All of a file whose content fits into the memory that `reading` allows.
pub(super) fn read(path: &Path, reading: &ReadOptions) -> Result<Vec<u8>, SceneFileError> {
    let failed = |error| FileError::Read { path: path.to_owned(), error };
    // Before opening: that would wait for ever for somebody to write into a pipe.
    let about = path.metadata().map_err(failed)?;
    if !about.is_file() {
        return Err(FileError::NoFile { path: path.to_owned() }.into());
    }
    let (needed, most) = (about.len().saturating_mul(TIMES), reading.max_memory);
    if needed > most {
        let cause = format!("reading it takes {needed} bytes, more than the {most} of --max-memory");
        return Err(FileError::TooLarge { path: path.to_owned(), cause }.into());
    }
    let file = std::fs::File::open(path).map_err(failed)?;
    let mut bytes = Vec::new();
    file.take(MOST_BYTES).read_to_end(&mut bytes).map_err(failed)?;
    if about.len() > MOST_BYTES {
        let cause =
            format!("it has {} bytes, more than the {MOST_BYTES} we take on. Thin it out first", about.len());
        return Err(SceneFileError::content(path, cause));
    }
    Ok(bytes)
}

/// What is left of a binary file.
pub(super) struct Bytes<'a> {
    path: &'a Path,
    length: usize,
    rest: &'a [u8],
}

impl<'a> Bytes<'a> {
    pub(super) fn new(path: &'a Path, bytes: &'a [u8]) -> Self {
        Self { path, length: bytes.len(), rest: bytes }
    }

    /// An error at the place that was come to.
    pub(super) fn wrong(&self, cause: impl Into<String>) -> SceneFileError {
        let offset = self.length.saturating_sub(self.rest.len());
        SceneFileError::Offset { path: self.path.to_owned(), offset, cause: cause.into() }
    }

    pub(super) fn take<const N: usize>(&mut self) -> Result<[u8; N], SceneFileError> {
        let (taken, rest) =
            self.rest.split_first_chunk().ok_or_else(|| self.wrong("it ends in the middle"))?;
        self.rest = rest;
        Ok(*taken)
    }

    pub(super) fn word(&mut self) -> Result<u32, SceneFileError> {
        self.take().map(u32::from_le_bytes)
    }

    pub(super) fn long(&mut self) -> Result<u64, SceneFileError> {
        self.take().map(u64::from_le_bytes)
    }

    pub(super) fn double(&mut self) -> Result<f64, SceneFileError> {
        self.take().map(f64::from_le_bytes)
    }

    /// A count of things of at least `each` bytes: no more than there is room for in what is left.
    pub(super) fn count(&mut self, each: usize) -> Result<usize, SceneFileError> {
        let count = self.long()?;
        let room = self.rest.len().checked_div(each).unwrap_or(0);
        usize::try_from(count).ok().filter(|&count| count <= room).ok_or_else(|| {
            self.wrong(format!("it promises {count} entries, but has room for {room} at most"))
        })
    }

    pub(super) fn skip(&mut self, bytes: usize) -> Result<(), SceneFileError> {
        self.rest = self.rest.get(bytes..).ok_or_else(|| self.wrong("it ends in the middle"))?;
        Ok(())
    }

    /// A text up to a byte of nothing.
    pub(super) fn text(&mut self) -> Result<String, SceneFileError> {
        let end = self.rest.iter().position(|&byte| byte == 0);
        let (text, rest) = end
            .and_then(|end| self.rest.split_at_checked(end))
            .ok_or_else(|| self.wrong("a name without an end"))?;
        let text = std::str::from_utf8(text).map_err(|_| self.wrong("a name that is no UTF-8"))?.to_owned();
        self.rest = rest.get(1..).unwrap_or_default();
        Ok(text)
    }

    /// Bytes that are left.
    pub(super) fn left(&self) -> usize {
        self.rest.len()
    }

    pub(super) fn is_at_end(&self) -> bool {
        self.rest.is_empty()
    }
}
