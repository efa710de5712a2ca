//! One table of Parquet, row by row: every variant is a row of its own, equal to its image's but for the image.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use arrow_array::{ArrayRef, RecordBatch, StructArray};
use arrow_schema::ArrowError;
use parquet::arrow::{ARROW_SCHEMA_META_KEY, ArrowWriter};
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::schema::types::ColumnPath;

use super::super::line::Container;
use super::super::make::Maker;
use super::{Held, written};
use crate::dataset::tables::{Cell, Table, binary, cell, strings};
use crate::dataset::{join, split, stem};
use crate::files::{FileError, one_line, write_atomically};
use crate::files::{Hashed, sha256_of};
use crate::image_file::{Format, ReadOptions, open_file};

/// Bytes of rows that are written as a group, so that no reader needs more.
const GROUP: usize = 32 << 20;

/// A row to write: the row read that it copies, and the image that replaces its image.
struct Row {
    of: u64,
    instead: Option<(String, Vec<u8>)>,
}

impl Row {
    /// Its bytes, where `images` has those of the row that it equals.
    fn bytes<'a>(&'a self, images: &'a StructArray) -> Option<&'a [u8]> {
        match &self.instead {
            Some((_, bytes)) => Some(bytes),
            None => cell(images, 0)?.bytes,
        }
    }

    /// Its image's name, likewise.
    fn name<'a>(&'a self, images: &'a StructArray) -> Option<&'a str> {
        match &self.instead {
            Some((name, _)) => Some(name),
            None => cell(images, 0)?.name,
        }
    }
}

impl Maker<'_> {
    /// Reads a table row by row, and writes each with its variants.
    pub(super) fn write_table(
        &self,
        input: &Path,
        container: &mut Container,
    ) -> Result<Vec<FileError>, FileError> {
        let path = self.job.output.join(&container.key);
        let (file, bytes) = open_file(input)?;
        container.source.bytes = bytes;
        container.source.sha256 = sha256_of(input)?;
        let mut table = Table::open(input, file, &self.job.run_options.reading)?;
        let mut failures = Vec::new();
        // What the table's own reading says is no fault of the writing.
        let mut unread = None;
        let result = write_atomically(&path, true, |out| {
            let mut hashed = Hashed::new(out);
            let mut writer = ArrowWriter::try_new(&mut hashed, table.schema.clone(), Some(as_read(&table)))?;
            let mut first = 0_u64;
            loop {
                let rows = match table.next() {
                    Ok(Some(rows)) => rows,
                    Ok(None) => break,
                    Err(error) => {
                        unread = Some(error);
                        return Err(parquet::errors::ParquetError::General("it cannot be read".into()));
                    }
                };
                let more = match self.rows(&table, &rows, first, input, container, &mut failures) {
                    Ok(more) => more,
                    Err(stopped) => {
                        unread = Some(stopped);
                        return Err(parquet::errors::ParquetError::General("the run was stopped".into()));
                    }
                };
                // One by one, for lists in a row may be as large as memory allows.
                for row in &more {
                    writer.write(&with(&table, &rows, row)?)?;
                    if writer.in_progress_size() > GROUP {
                        writer.flush()?;
                    }
                }
                first = first.saturating_add(rows.num_rows() as u64);
            }
            writer.close()?;
            (container.bytes, container.sha256) = hashed.result();
            Ok(())
        });
        match unread {
            Some(error) => return Err(error),
            None => result?,
        }
        Ok(failures)
    }

    /// What becomes of some rows, of which the first is the table's `first`.
    fn rows(
        &self,
        table: &Table,
        rows: &RecordBatch,
        first: u64,
        input: &Path,
        container: &mut Container,
        failures: &mut Vec<FileError>,
    ) -> Result<Vec<Row>, FileError> {
        let mut all = Vec::new();
        for of in 0..rows.num_rows() as u64 {
            let number = first.saturating_add(of);
            let found = table.images(rows).and_then(|images| cell(images, row(of)));
            let key = join(&container.key, &number.to_string());
            if self.job.recipe.keeps(&key, found.is_some()) {
                all.push(Row { of, instead: None });
                container.originals.extend(found.is_some().then(|| key.clone()));
            }
            let Some(found) = found else { continue };
            match self.variants(found, &key, number, input, container) {
                Ok(variants) => all.extend(variants.map(|instead| Row { of, instead: Some(instead) })),
                Err(error @ FileError::Stopped { .. }) => return Err(error),
                Err(error) => {
                    container.failed.push((key, one_line(&error.to_string())));
                    failures.push(error);
                }
            }
        }
        Ok(all)
    }

    /// The variants of the image of one row, with their names.
    fn variants(
        &self,
        found: Cell<'_>,
        key: &str,
        number: u64,
        input: &Path,
        container: &mut Container,
    ) -> Result<impl Iterator<Item = (String, Vec<u8>)> + use<>, FileError> {
        let name = input.join(number.to_string());
        let none = || FileError::Damaged {
            path: name.clone(),
            cause: "the row only names its image; embed the image files in the table first".into(),
        };
        let bytes = found.bytes.ok_or_else(none)?;
        let own_name = found.name.map_or("", |called| split(called).1);
        let stem = if own_name.is_empty() { number.to_string() } else { stem(own_name).to_owned() };
        let format = Format::of_content(bytes).map_or("png", Format::extension);
        let extension = written(format);
        let named = move |suffix: &str| format!("{stem}{suffix}.{extension}");
        let held =
            Held { draws: key.to_owned(), key: key.to_owned(), name: name.clone(), bytes: bytes.to_vec() };
        let variants = self.vary(held, container, &named)?;
        Ok(variants.into_iter().map(move |variant| (named(&variant.suffix), variant.bytes)))
    }
}

/// A row of what was read at once.
fn row(of: u64) -> usize {
    usize::try_from(of).unwrap_or(usize::MAX)
}

/// As the table is compressed, and with what others wrote about it.
fn as_read(table: &Table) -> WriterProperties {
    let own = |note: &&parquet::file::metadata::KeyValue| note.key != ARROW_SCHEMA_META_KEY;
    let notes = table.notes.iter().filter(own).cloned().collect();
    let bytes = ColumnPath::from(vec![table.schema.field(table.column).name().clone(), "bytes".to_owned()]);
    WriterProperties::builder()
        .set_compression(table.compression)
        .set_key_value_metadata(Some(notes))
        // Images are neither alike nor in an order.
        .set_column_dictionary_enabled(bytes.clone(), false)
        .set_column_statistics_enabled(bytes, EnabledStatistics::None)
        .build()
}

/// A row equal to one that was read but for its image.
fn with(table: &Table, rows: &RecordBatch, one: &Row) -> Result<RecordBatch, ArrowError> {
    let taken = rows.slice(row(one.of), 1);
    let Some(images) = table.images(&taken) else { return Ok(taken) };
    let (fields, mut arrays, nulls) = images.clone().into_parts();
    for (field, array) in fields.iter().zip(&mut arrays) {
        let replaced: Option<ArrayRef> = match field.name().as_str() {
            "bytes" => Some(binary(field.data_type(), &[one.bytes(images)])),
            "path" => strings(field.data_type(), &[one.name(images)]),
            _ => None,
        };
        if let Some(replaced) = replaced {
            *array = replaced;
        }
    }
    let mut columns = taken.columns().to_vec();
    if let Some(column) = columns.get_mut(table.column) {
        *column = Arc::new(StructArray::try_new(fields, arrays, nulls)?);
    }
    RecordBatch::try_new(taken.schema(), columns)
}

/// The image of a key, TABLE/ROW, in a table: its name there, and its bytes.
pub(super) fn image_of(
    path: &Path,
    key: &str,
    options: &ReadOptions,
) -> Result<Option<(PathBuf, Vec<u8>)>, FileError> {
    let Ok(wanted) = split(key).1.parse::<usize>() else { return Ok(None) };
    let (file, _) = open_file(path)?;
    let mut table = Table::open(path, file, options)?;
    let mut first = 0_usize;
    while let Some(rows) = table.next()? {
        let after = first.saturating_add(rows.num_rows());
        if wanted < after {
            let found = table.images(&rows).and_then(|images| cell(images, wanted.saturating_sub(first)));
            let bytes = found.and_then(|cell| cell.bytes);
            return Ok(bytes.map(|bytes| (PathBuf::from(wanted.to_string()), bytes.to_vec())));
        }
        first = after;
    }
    Ok(None)
}
