//! The memory that reading a group of rows takes, computed before it is taken: a value that is repeated costs a table no bytes,
//! and so a list in one row can be thousands of millions of values long, each of them a text.

use std::io;
use std::sync::Arc;

use parquet::basic::Type;
use parquet::column::page::{Page, PageReader};
use parquet::errors::Result as ParquetResult;
use parquet::file::metadata::{ColumnChunkMetaData, RowGroupMetaData};
use parquet::file::reader::{ChunkReader, Length, SerializedPageReader};

use super::pages::Pages;
use super::thrift::odd;

/// Times that values are held at once: as read, as an array, and as written. What was measured is 3.1.
const COPIES: u64 = 4;
/// Bytes of a value's place among lists and structs.
const PLACE: u64 = 4;
/// Bytes of where a text begins and ends.
const TEXT: u64 = 16;

/// Bytes that a reader of so many rows at once needs for a group.
///
/// # Errors
///
/// What is wrong with a page.
pub(in crate::dataset::tables) fn needed<R: ChunkReader>(
    from: &R,
    group: &RowGroupMetaData,
    rows: u64,
    most: u64,
) -> io::Result<u64> {
    group.columns().iter().try_fold(0, |sum: u64, column| {
        let pages = Pages::of(from, column)?;
        Ok(sum.saturating_add(of_column(from, column, &pages, rows, most)?))
    })
}

fn of_column<R: ChunkReader>(
    from: &R,
    column: &ColumnChunkMetaData,
    pages: &Pages,
    rows: u64,
    most: u64,
) -> io::Result<u64> {
    if pages.largest > most {
        return Ok(pages.largest);
    }
    let of = column.column_descr();
    let is_list = of.max_rep_level() > 0;
    let width = match of.physical_type() {
        Type::BOOLEAN => 1,
        Type::INT32 | Type::FLOAT => 4,
        Type::INT64 | Type::INT96 | Type::DOUBLE => 8,
        Type::BYTE_ARRAY => TEXT.saturating_add(longest(from, column, pages, is_list)?),
        // Decimals may be made wider than they are.
        Type::FIXED_LEN_BYTE_ARRAY => TEXT.saturating_add(u64::try_from(of.type_length()).unwrap_or(0)),
    };
    // A row of a list may have all values that there are.
    let (values, bytes) = if is_list {
        (pages.values, pages.bytes)
    } else {
        (rows.min(pages.values), pages.bytes.min(rows.saturating_mul(pages.largest)))
    };
    let copied = values.saturating_mul(width.saturating_add(PLACE)).saturating_mul(COPIES);
    Ok(copied.saturating_add(pages.largest).saturating_add(bytes))
}

/// Bytes that a text may have beyond those that it takes in its page.
fn longest<R: ChunkReader>(
    from: &R,
    column: &ColumnChunkMetaData,
    pages: &Pages,
    is_list: bool,
) -> io::Result<u64> {
    match pages.dictionary {
        0 => Ok(0),
        // Few values: it need not be looked at.
        bytes if !is_list => Ok(bytes),
        _ => longest_entry(from, column),
    }
}

/// Bytes of the longest text of a column's dictionary: each follows its length.
fn longest_entry<R: ChunkReader>(from: &R, column: &ColumnChunkMetaData) -> io::Result<u64> {
    let first = SerializedPageReader::new(Arc::new(Lent(from)), column, 0, None)
        .and_then(|mut pages| pages.get_next_page())
        .map_err(io::Error::other)?;
    let Some(page) = first.filter(Page::is_dictionary_page) else { return Ok(0) };
    let (mut rest, mut longest) = (page.buffer().as_ref(), 0);
    while let Some((length, after)) = rest.split_first_chunk() {
        let length = u32::from_le_bytes(*length);
        let after = usize::try_from(length).ok().and_then(|length| after.get(length..));
        rest = after.ok_or_else(|| odd("a dictionary with an entry longer than itself"))?;
        longest = longest.max(u64::from(length));
    }
    Ok(longest)
}

/// A file that someone else reads afterwards.
struct Lent<'a, R>(&'a R);

impl<R: ChunkReader> Length for Lent<'_, R> {
    fn len(&self) -> u64 {
        self.0.len()
    }
}

impl<R: ChunkReader> ChunkReader for Lent<'_, R> {
    type T = R::T;

    fn get_read(&self, start: u64) -> ParquetResult<R::T> {
        self.0.get_read(start)
    }

    fn get_bytes(&self, start: u64, length: usize) -> ParquetResult<bytes::Bytes> {
        self.0.get_bytes(start, length)
    }
}
