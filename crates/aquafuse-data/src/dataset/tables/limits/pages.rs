//! What the pages of a column say of themselves, read before any is unpacked: a header of a few bytes can say gigabytes.
//!
//! A page follows its header, which is a struct of [`super::thrift`]. <https://parquet.apache.org/docs/file-format/data-pages/>

use std::io::{self, ErrorKind, Read};

use parquet::file::metadata::ColumnChunkMetaData;
use parquet::file::reader::ChunkReader;

use super::shapes::{PAGE_HEADER, Shape};
use super::thrift::{next_field, number, odd, pass_over, unfolded};

/// Structs within structs, of which a header has two.
const DEEPEST: u32 = 8;
/// Encodings of strings in which the first bytes of a page say how many there are, and the library makes room for as many.
const DELTAS: [(u64, &str); 2] = [(6, "DELTA_LENGTH_BYTE_ARRAY"), (7, "DELTA_BYTE_ARRAY")];

/// The pages of a column in a group together.
#[derive(Debug, Default)]
pub(super) struct Pages {
    /// Bytes of the largest when it is unpacked.
    pub(super) largest: u64,
    /// Bytes of all of them.
    pub(super) bytes: u64,
    /// Values in pages of data, missing ones with them.
    pub(super) values: u64,
    /// Bytes of the dictionary, none where there is none.
    pub(super) dictionary: u64,
}

/// What one header says.
#[derive(Default)]
struct Header {
    unpacked: Option<u64>,
    packed: Option<u64>,
    values: u64,
    encodings: [u64; 2],
    entries: Option<u64>,
}

impl Pages {
    /// Reads the headers of a column's pages.
    ///
    /// # Errors
    ///
    /// What is wrong with a header, or the name of an encoding that cannot be read ([`ErrorKind::Unsupported`]).
    pub(super) fn of<R: ChunkReader>(from: &R, column: &ColumnChunkMetaData) -> io::Result<Self> {
        // Of a column that cannot be asked for its place the reader makes an error by itself.
        let whole = |number: i64| u64::try_from(number).map_err(|_| odd("a column begins before the file"));
        let start = whole(column.dictionary_page_offset().unwrap_or(column.data_page_offset()))?;
        let end = start.saturating_add(whole(column.compressed_size())?);
        let (mut at, mut pages) = (start, Self::default());
        while at < end {
            let mut counted = Counted { from: from.get_read(at).map_err(io::Error::other)?, bytes: 0 };
            let packed = pages.add(&Header::read(&mut counted)?)?;
            at = at.saturating_add(counted.bytes).saturating_add(packed);
        }
        Ok(pages)
    }

    /// Counts a page; gives the bytes until the next.
    fn add(&mut self, page: &Header) -> io::Result<u64> {
        let sizes = page.unpacked.zip(page.packed);
        let (unpacked, packed) = sizes.ok_or_else(|| odd("a page without a size"))?;
        if let Some(entries) = page.entries {
            if entries > unpacked {
                return Err(odd("a dictionary with more entries than bytes"));
            }
            if self.bytes > 0 || self.values > 0 {
                return Err(odd("a dictionary behind the values that it is for"));
            }
            self.dictionary = unpacked;
        }
        self.largest = self.largest.max(unpacked);
        self.bytes = self.bytes.saturating_add(unpacked);
        self.values = self.values.saturating_add(page.values);
        if let Some((_, name)) = DELTAS.iter().find(|(encoding, _)| page.encodings.contains(encoding)) {
            return Err(io::Error::new(ErrorKind::Unsupported, *name));
        }
        Ok(packed)
    }
}

impl Header {
    fn read(from: &mut impl Read) -> io::Result<Self> {
        let mut header = Self::default();
        let mut field = 0;
        while let Some(kind) = next_field(from, &mut field)? {
            let shape = PAGE_HEADER.field(field);
            match (field, kind) {
                (2, 4..=6) => header.unpacked = Some(size(from)?),
                (3, 4..=6) => header.packed = Some(size(from)?),
                (5, 12) => header.data(0, sizes(from, shape, [1, 2])?),
                (7, 12) => header.entries = sizes(from, shape, [1, 2])?[0],
                (8, 12) => header.data(1, sizes(from, shape, [1, 4])?),
                _ => pass_over(from, kind, shape, DEEPEST)?,
            }
        }
        Ok(header)
    }

    /// Number and encoding of values, in one of the two ways to write a page of them.
    fn data(&mut self, way: usize, [values, encoding]: [Option<u64>; 2]) {
        self.values = self.values.max(values.unwrap_or(0));
        if let Some(place) = self.encodings.get_mut(way) {
            *place = encoding.unwrap_or(0);
        }
    }
}

/// Two numbers of a struct.
fn sizes(from: &mut impl Read, shape: Option<Shape>, wanted: [i16; 2]) -> io::Result<[Option<u64>; 2]> {
    let mut found = [None; 2];
    let mut field = 0;
    while let Some(kind) = next_field(from, &mut field)? {
        let wanted = wanted.iter().zip(&mut found).find(|(of, _)| **of == field);
        match (wanted, kind) {
            (Some((_, found)), 4..=6) => *found = Some(size(from)?),
            _ => pass_over(from, kind, shape.and_then(|shape| shape.field(field)), DEEPEST)?,
        }
    }
    Ok(found)
}

/// A size of 32 bits: more would be cut off by the library, which would then look for the next page elsewhere.
fn size(from: &mut impl Read) -> io::Result<u64> {
    let size = i32::try_from(unfolded(number(from)?)).ok().and_then(|size| u64::try_from(size).ok());
    size.ok_or_else(|| odd("a page with an impossible size"))
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
