//! What a table asks of whoever reads it, found before the library `parquet` reads it: that limits neither the length of a
//! list in the footer, nor the size that a page says it unpacks to, nor the memory that a group of rows takes. A file of
//! a few bytes can ask for gigabytes, or for minutes. All of this module can go once the library limits these itself.
//!
//! The footer is checked here; `pages` reads the headers of pages, both by `thrift` and the `shapes` of the format, and
//! `memory` adds up what a group takes. Before the last eight bytes of a file, which are the footer's length and four letters,
//! stands the footer, a struct of [`thrift`]. <https://parquet.apache.org/docs/file-format/>

mod memory;
mod pages;
mod shapes;
mod thrift;

pub(super) use memory::needed;

use std::io::{self, BufReader, ErrorKind, Read};

use parquet::file::reader::ChunkReader;

use shapes::FOOTER;
use thrift::{odd, pass_over_struct};

/// After the footer: its length and what tables begin and end with.
const TAIL: u64 = 8;
/// Structs and lists within one another, of which statistics of a column in a group have nine.
const DEEPEST: u32 = 16;

/// Whether every field of the footer holds what the format has it hold, and every list the values that it says.
///
/// # Errors
///
/// What is wrong with the footer; of the tail the library makes better errors.
pub(super) fn check_footer<R: ChunkReader>(from: &R) -> io::Result<()> {
    let Some(end) = from.len().checked_sub(TAIL) else { return Ok(()) };
    let mut length = [0; 4];
    from.get_read(end).map_err(io::Error::other)?.read_exact(&mut length)?;
    let length = u64::from(u32::from_le_bytes(length));
    let Some(start) = end.checked_sub(length) else { return Ok(()) };
    let footer = from.get_read(start).map_err(io::Error::other)?;
    let passed = pass_over_struct(&mut BufReader::new(footer).take(length), Some(FOOTER), DEEPEST);
    passed.map_err(|error| match error.kind() {
        ErrorKind::UnexpectedEof => odd("its footer ends too soon"),
        _ => error,
    })
}
