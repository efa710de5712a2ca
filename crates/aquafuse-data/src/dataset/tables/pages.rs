//! What the pages of a table say that they unpack to, read before any is: a header of a few bytes can say gigabytes.
//!
//! A page follows its header, which is a struct of [`super::thrift`]; the fields needed are the second and third, and the rest is
//! passed over. <https://parquet.apache.org/docs/file-format/data-pages/>

use std::io::{self, Read};

use parquet::file::metadata::{ColumnChunkMetaData, RowGroupMetaData};
use parquet::file::reader::ChunkReader;

use super::shapes::PAGE_HEADER;
use super::thrift::{next_field, number, odd, pass_over, unfolded};

/// Structs within structs, of which a header has two.
const DEEPEST: u32 = 8;

/// Bytes of the largest pages of a group's columns together: a reader holds one page of each column.
///
/// # Errors
///
/// What is wrong with a header.
pub(super) fn unpacked<R: ChunkReader>(from: &R, group: &RowGroupMetaData) -> io::Result<u64> {
    group.columns().iter().try_fold(0, |sum: u64, column| Ok(sum.saturating_add(largest(from, column)?)))
}

/// Bytes of the largest page of a column.
fn largest<R: ChunkReader>(from: &R, column: &ColumnChunkMetaData) -> io::Result<u64> {
    // Of a column that cannot be asked for its place the reader makes an error by itself.
    let whole = |number: i64| u64::try_from(number).map_err(|_| odd("a column begins before the file"));
    let start = whole(column.dictionary_page_offset().unwrap_or(column.data_page_offset()))?;
    let end = start.saturating_add(whole(column.compressed_size())?);
    let (mut at, mut largest) = (start, 0);
    while at < end {
        let mut counted = Counted { from: from.get_read(at).map_err(io::Error::other)?, bytes: 0 };
        let [unpacked, packed] = sizes(&mut counted)?;
        largest = largest.max(unpacked);
        at = at.saturating_add(counted.bytes).saturating_add(packed);
    }
    Ok(largest)
}

/// Unpacked and packed bytes of a page, from its header.
fn sizes(header: &mut impl Read) -> io::Result<[u64; 2]> {
    let [mut unpacked, mut packed] = [None; 2];
    let mut field = 0;
    while let Some(kind) = next_field(header, &mut field)? {
        match (field, kind) {
            (2, 4..=6) => unpacked = Some(size(header)?),
            (3, 4..=6) => packed = Some(size(header)?),
            _ => pass_over(header, kind, PAGE_HEADER.field(field), DEEPEST)?,
        }
    }
    unpacked.zip(packed).map(<[u64; 2]>::from).ok_or_else(|| odd("a page without a size"))
}

/// A size of 32 bits: more would be cut off by the library, which would then look for the next page elsewhere.
fn size(from: &mut impl Read) -> io::Result<u64> {
    let size = i32::try_from(unfolded(number(from)?)).ok().and_then(|size| u64::try_from(size).ok());
    size.ok_or_else(|| odd("a page of less than nothing, or of more than there can be"))
}

/// Bytes that were read.
struct Counted<R> {
    from: R,
    bytes: u64,
}

impl<R: Read> Read for Counted<R> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let read = self.from.read(into)?;
        self.bytes = self.bytes.saturating_add(read as u64);
        Ok(read)
    }
}
