//! What the pages of a table say that they unpack to, read before any is: a header of a few bytes can say gigabytes.
//!
//! A page follows its header, which is a struct in Thrift's compact protocol; the fields needed are the second and third,
//! and the rest is passed over. <https://parquet.apache.org/docs/file-format/data-pages/>

use std::io::{self, ErrorKind, Read};

use parquet::file::metadata::{ColumnChunkMetaData, RowGroupMetaData};
use parquet::file::reader::ChunkReader;

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
            (2, 5) => unpacked = Some(size(header)?),
            (3, 5) => packed = Some(size(header)?),
            _ => pass_over(header, kind, DEEPEST)?,
        }
    }
    unpacked.zip(packed).map(<[u64; 2]>::from).ok_or_else(|| odd("a page without a size"))
}

fn size(from: &mut impl Read) -> io::Result<u64> {
    u64::try_from(unfolded(number(from)?)).map_err(|_| odd("a page of less than nothing"))
}

/// The kind of the next field of a struct, whose number goes on from that of the field before; none at its end.
fn next_field(from: &mut impl Read, field: &mut i64) -> io::Result<Option<u8>> {
    let byte = byte(from)?;
    if byte == 0 {
        return Ok(None);
    }
    *field = match byte >> 4 {
        0 => unfolded(number(from)?),
        further => field.saturating_add(i64::from(further)),
    };
    Ok(Some(byte & 0xf))
}

/// Reads a value and drops it.
fn pass_over(from: &mut impl Read, kind: u8, deepest: u32) -> io::Result<()> {
    let deeper = || deepest.checked_sub(1).ok_or_else(|| odd("structs within structs without end"));
    match kind {
        // Of a Boolean the kind is the value.
        1 | 2 => Ok(()),
        3 => byte(from).map(drop),
        4..=6 => number(from).map(drop),
        7 => bytes(from, 8),
        8 => {
            let length = number(from)?;
            bytes(from, length)
        }
        9 | 10 => {
            let head = byte(from)?;
            let length = if head >> 4 == 0xf { number(from)? } else { u64::from(head >> 4) };
            // Within a list a Boolean has a byte.
            let kind = if matches!(head & 0xf, 1 | 2) { 3 } else { head & 0xf };
            (0..length).try_for_each(|_| pass_over(from, kind, deeper()?))
        }
        12 => {
            let mut field = 0;
            while let Some(kind) = next_field(from, &mut field)? {
                pass_over(from, kind, deeper()?)?;
            }
            Ok(())
        }
        _ => Err(odd("a page's header of no known kind")),
    }
}

fn byte(from: &mut impl Read) -> io::Result<u8> {
    let mut byte = [0];
    from.read_exact(&mut byte)?;
    Ok(byte[0])
}

fn bytes(from: &mut impl Read, length: u64) -> io::Result<()> {
    let passed = io::copy(&mut from.take(length), &mut io::sink())?;
    if passed < length { Err(ErrorKind::UnexpectedEof.into()) } else { Ok(()) }
}

/// Seven bits a byte, the lowest first.
fn number(from: &mut impl Read) -> io::Result<u64> {
    let mut number = 0;
    for shift in (0..64).step_by(7) {
        let byte = byte(from)?;
        number |= u64::from(byte & 0x7f) << shift;
        if byte < 0x80 {
            return Ok(number);
        }
    }
    Err(odd("a number without end"))
}

/// A number with its sign, which is its lowest bit.
fn unfolded(number: u64) -> i64 {
    let half = (number >> 1).cast_signed();
    if number & 1 == 0 { half } else { !half }
}

fn odd(what: &str) -> io::Error {
    io::Error::new(ErrorKind::InvalidData, what)
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
