//! The rows of a table, and the images in them.

use std::fs::File;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use arrow_array::cast::AsArray;
use arrow_array::{
    Array, ArrayRef, BinaryArray, BinaryViewArray, LargeBinaryArray, LargeStringArray, RecordBatch,
    StringArray, StringViewArray, StructArray,
};
use arrow_schema::{DataType, Field, SchemaRef};
use parquet::arrow::arrow_reader::{
    ArrowReaderMetadata, ArrowReaderOptions, ParquetRecordBatchReader, ParquetRecordBatchReaderBuilder,
};
use parquet::basic::Compression;
use parquet::file::metadata::{ColumnChunkMetaData, KeyValue};
use parquet::file::reader::ChunkReader;

use super::limits;
use crate::files::catch_panic;
use crate::files::{FileError, one_line};
use crate::image_file::ReadOptions;

/// Rows that are read at once: images are large.
const ROWS: usize = 4;

/// A table, row by row.
pub(crate) struct Table {
    path: PathBuf,
    reader: ParquetRecordBatchReader,
    pub(crate) schema: SchemaRef,
    /// The column that holds the images.
    pub(crate) column: usize,
    pub(crate) compression: Compression,
    /// Metadata beside the schema.
    pub(crate) notes: Vec<KeyValue>,
}

/// The image of a row, in its bytes or as a file elsewhere.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cell<'a> {
    pub(crate) bytes: Option<&'a [u8]>,
    /// The name of its original file.
    pub(crate) name: Option<&'a str>,
}

impl Table {
    /// Opens a table. Errors call it `path`.
    pub(crate) fn open(path: &Path, file: File, options: &ReadOptions) -> Result<Self, FileError> {
        Self::of(path, file, options)
    }

    fn of<R: ChunkReader + 'static>(path: &Path, from: R, options: &ReadOptions) -> Result<Self, FileError> {
        let damaged = |cause: String| FileError::Damaged { path: path.to_owned(), cause };
        let bytes = from.len();
        limits::check_footer(&from).map_err(|error| damaged(one_line(&error.to_string())))?;
        let loaded = catch_panic(|| ArrowReaderMetadata::load(&from, ArrowReaderOptions::new()));
        let loaded = loaded.ok_or_else(|| damaged(FELL.into()))?;
        let loaded = loaded.map_err(|error| damaged(one_line(&error.to_string())))?;
        let metadata = loaded.metadata();
        for group in metadata.row_groups() {
            let (said, most) =
                (u64::try_from(group.total_byte_size()).unwrap_or(u64::MAX), options.max_memory);
            let needed = catch_panic(|| limits::needed(&from, group, ROWS as u64, most));
            let needed = needed.ok_or_else(|| damaged(FELL.into()))?;
            let needed = needed.map_err(|error| match error.kind() {
                ErrorKind::Unsupported => FileError::UnsupportedPixels {
                    path: path.to_owned(),
                    found: format!("a table with strings in the encoding {error}"),
                    remedy: "Write it in the encodings PLAIN and RLE_DICTIONARY, as most programs do",
                },
                _ => damaged(one_line(&error.to_string())),
            })?;
            let needed = needed.max(said);
            if needed > most {
                let cause =
                    format!("a group of its rows takes {needed} bytes, {most} are allowed (--max-memory)");
                return Err(FileError::TooLarge { path: path.to_owned(), cause });
            }
        }
        // Rows of images take bytes; a few bytes can say that they are millions of rows with nothing in them.
        let rows =
            metadata.row_groups().iter().map(|group| u64::try_from(group.num_rows()).unwrap_or(u64::MAX));
        let rows = rows.fold(0, u64::saturating_add);
        if rows > bytes {
            return Err(damaged(format!("it declares {rows} rows, but has only {bytes} bytes")));
        }
        let schema = loaded.schema().clone();
        let column = column(&schema).map_err(damaged)?;
        let first = metadata.row_groups().first();
        let leaf = first.and_then(|group| {
            let name = schema.field(column).name();
            group.columns().iter().find(|leaf| leaf.column_path().parts().first() == Some(name))
        });
        let compression = leaf.map_or(Compression::SNAPPY, ColumnChunkMetaData::compression);
        let notes = metadata.file_metadata().key_value_metadata().cloned().unwrap_or_default();
        let builder = ParquetRecordBatchReaderBuilder::new_with_metadata(from, loaded);
        let built = catch_panic(|| builder.with_batch_size(ROWS).build());
        let built = built.ok_or_else(|| damaged(FELL.into()))?;
        let reader = built.map_err(|error| damaged(one_line(&error.to_string())))?;
        Ok(Self { path: path.to_owned(), reader, schema, column, compression, notes })
    }

    /// The next rows.
    pub(crate) fn next(&mut self) -> Result<Option<RecordBatch>, FileError> {
        let damaged = |cause: String| FileError::Damaged { path: self.path.clone(), cause };
        let next = catch_panic(|| self.reader.next()).ok_or_else(|| damaged(FELL.into()))?;
        next.transpose().map_err(|error| damaged(one_line(&error.to_string())))
    }

    /// The column of images of some rows.
    pub(crate) fn images<'a>(&self, rows: &'a RecordBatch) -> Option<&'a StructArray> {
        rows.columns().get(self.column)?.as_struct_opt()
    }
}

const FELL: &str = "the Parquet decoder panicked on it";

/// The column of images: the only one, or the one with this name.
fn column(schema: &SchemaRef) -> Result<usize, String> {
    let is_image = |field: &Field| match field.data_type() {
        DataType::Struct(fields) => fields.iter().any(|field| {
            let binary =
                matches!(field.data_type(), DataType::Binary | DataType::LargeBinary | DataType::BinaryView);
            field.name() == "bytes" && binary
        }),
        _ => false,
    };
    let found: Vec<(usize, &str)> = schema
        .fields()
        .iter()
        .enumerate()
        .filter(|(_, field)| is_image(field))
        .map(|(column, field)| (column, field.name().as_str()))
        .collect();
    match found[..] {
        [(column, _)] => Ok(column),
        [] => Err("it has no column of images (structs with `bytes`, as Hugging Face's Image)".into()),
        [(_, one), (_, other), ..] => {
            found.iter().find(|(_, name)| *name == "image").map(|(column, _)| *column).ok_or_else(|| {
                format!("{one} and {other} may both hold the images; name the right column `image`")
            })
        }
    }
}

/// The image in a row of a column of images, if there is one.
pub(crate) fn cell(images: &StructArray, row: usize) -> Option<Cell<'_>> {
    if images.is_null(row) {
        return None;
    }
    let bytes = images.column_by_name("bytes").and_then(|bytes| bytes_at(bytes, row));
    let name = images.column_by_name("path").and_then(|names| text_at(names, row));
    (bytes.is_some() || name.is_some()).then_some(Cell { bytes, name })
}

fn bytes_at(array: &ArrayRef, row: usize) -> Option<&[u8]> {
    if array.is_null(row) {
        return None;
    }
    match array.data_type() {
        DataType::Binary => Some(array.as_binary_opt::<i32>()?.value(row)),
        DataType::LargeBinary => Some(array.as_binary_opt::<i64>()?.value(row)),
        _ => Some(array.as_binary_view_opt()?.value(row)),
    }
}

fn text_at(array: &ArrayRef, row: usize) -> Option<&str> {
    if array.is_null(row) {
        return None;
    }
    match array.data_type() {
        DataType::Utf8 => Some(array.as_string_opt::<i32>()?.value(row)),
        DataType::LargeUtf8 => Some(array.as_string_opt::<i64>()?.value(row)),
        _ => Some(array.as_string_view_opt()?.value(row)),
    }
}

/// Bytes as a column of this kind.
pub(crate) fn binary(kind: &DataType, values: &[Option<&[u8]>]) -> ArrayRef {
    let values = values.iter().copied();
    match kind {
        DataType::LargeBinary => Arc::new(values.collect::<LargeBinaryArray>()),
        DataType::BinaryView => Arc::new(values.collect::<BinaryViewArray>()),
        _ => Arc::new(values.collect::<BinaryArray>()),
    }
}

/// Strings as a column of this kind; `None` if it is a column of another kind.
pub(crate) fn strings(kind: &DataType, values: &[Option<&str>]) -> Option<ArrayRef> {
    let values = values.iter().copied();
    match kind {
        DataType::Utf8 => Some(Arc::new(values.collect::<StringArray>())),
        DataType::LargeUtf8 => Some(Arc::new(values.collect::<LargeStringArray>())),
        DataType::Utf8View => Some(Arc::new(values.collect::<StringViewArray>())),
        _ => None,
    }
}

/// Reads a table for nothing but that: a target of fuzzing.
#[cfg(feature = "fuzz-targets")]
pub(crate) fn try_parse(name: &Path, bytes: &[u8]) -> Result<(), FileError> {
    let options = ReadOptions { max_memory: 1 << 16, ..ReadOptions::default() };
    let mut table = Table::of(name, bytes::Bytes::copy_from_slice(bytes), &options)?;
    while let Some(rows) = table.next()? {
        let images = table.images(&rows);
        for row in 0..rows.num_rows() {
            let _ = images.and_then(|images| cell(images, row));
        }
    }
    Ok(())
}
