//! The variants of a manifest as a table of Parquet: one row each, for programs that filter and join.

use std::error::Error;
use std::path::Path;
use std::sync::Arc;

use arrow_array::{
    ArrayRef, BooleanArray, Float32Array, Float64Array, RecordBatch, StringArray, UInt32Array, UInt64Array,
};
use parquet::arrow::ArrowWriter;
use parquet::errors::ParquetError;

use super::Sea;
use super::header::Header;
use super::line::{Variant, Written};
use super::manifest::Entry;
use crate::files::sha256_of;
use crate::files::{FileError, write_atomically};

/// The columns that need not have a value in every row.
const LACKING: [&str; 5] = ["container", "depth_sha256", "water", "contrast_left", "change"];
/// Images whose rows are written at once.
const AT_ONCE: usize = 1000;

/// Writes the table `name` into `folder`.
pub(super) fn write(
    folder: &Path,
    name: String,
    header: &Header,
    mut entries: impl Iterator<Item = Result<Entry, FileError>>,
) -> Result<Written, FileError> {
    let path = folder.join(&name);
    write_atomically(&path, true, |out| -> Result<(), Box<dyn Error>> {
        let mut writer = ArrowWriter::try_new(out, rows(header, &[])?.schema(), None)?;
        loop {
            let some: Vec<Entry> = entries.by_ref().take(AT_ONCE).collect::<Result<_, _>>()?;
            if some.is_empty() {
                return Ok(writer.close().map(|_| ())?);
            }
            writer.write(&rows(header, &some.iter().flat_map(Entry::all_variants).collect::<Vec<_>>())?)?;
        }
    })?;
    let failed = |error| FileError::Read { path: path.clone(), error };
    let bytes = path.metadata().map_err(failed)?.len();
    Ok(Written { output: name, bytes, sha256: sha256_of(&path)? })
}

fn rows(header: &Header, all: &[(&Variant, Option<&str>)]) -> Result<RecordBatch, ParquetError> {
    fn strings<'a>(all: &[(&'a Variant, Option<&'a str>)], of: impl Fn(&'a Variant) -> &'a str) -> ArrayRef {
        Arc::new(StringArray::from_iter_values(all.iter().map(|(variant, _)| of(variant))))
    }
    let water = |variant: &Variant| match (variant.water, variant.sea) {
        (Some(at), _) => header.waters.get(at).map(|water| water.name.clone()),
        (None, number) => number.map(Sea::name),
    };
    let reasons = all.iter().map(|(variant, _)| {
        let words: Vec<&str> = variant.reasons.iter().map(|reason| reason.describe()).collect();
        Some(words.join("; "))
    });
    let columns: Vec<(&str, ArrayRef)> = vec![
        ("key", strings(all, |variant| &variant.key)),
        ("number", Arc::new(all.iter().map(|(variant, _)| Some(variant.number)).collect::<UInt32Array>())),
        ("output", strings(all, |variant| &variant.output)),
        ("container", Arc::new(all.iter().map(|(_, container)| *container).collect::<StringArray>())),
        ("bytes", Arc::new(all.iter().map(|(variant, _)| Some(variant.bytes)).collect::<UInt64Array>())),
        ("sha256", strings(all, |variant| &variant.sha256)),
        (
            "source_bytes",
            Arc::new(all.iter().map(|(variant, _)| Some(variant.source.bytes)).collect::<UInt64Array>()),
        ),
        ("source_sha256", strings(all, |variant| &variant.source.sha256)),
        (
            "depth_sha256",
            Arc::new(
                all.iter()
                    .map(|(variant, _)| variant.source.depth_sha256.as_deref())
                    .collect::<StringArray>(),
            ),
        ),
        ("water", Arc::new(all.iter().map(|(variant, _)| water(variant)).collect::<StringArray>())),
        ("model", Arc::new(StringArray::from_iter_values(all.iter().map(|_| &header.settings.model)))),
        ("theta", Arc::new(all.iter().map(|(variant, _)| Some(variant.theta)).collect::<Float32Array>())),
        ("alpha", Arc::new(all.iter().map(|(variant, _)| Some(variant.alpha)).collect::<Float32Array>())),
        ("redrawn", Arc::new(all.iter().map(|(variant, _)| Some(variant.redrawn)).collect::<UInt32Array>())),
        ("verdict", strings(all, |variant| &variant.verdict)),
        ("reasons", Arc::new(reasons.collect::<StringArray>())),
        ("clipped", Arc::new(all.iter().map(|(variant, _)| Some(variant.clipped)).collect::<Float64Array>())),
        (
            "contrast_left",
            Arc::new(all.iter().map(|(variant, _)| variant.contrast_left).collect::<Float64Array>()),
        ),
        ("change", Arc::new(all.iter().map(|(variant, _)| variant.change).collect::<Float64Array>())),
        ("instead", Arc::new(all.iter().map(|(variant, _)| Some(variant.instead)).collect::<BooleanArray>())),
        ("seed", Arc::new(all.iter().map(|_| Some(header.settings.seed)).collect::<UInt64Array>())),
        ("version", Arc::new(StringArray::from_iter_values(all.iter().map(|_| &header.version)))),
    ];
    // Whether a column may lack values is said of the table, not of these rows.
    let columns = columns.into_iter().map(|(name, column)| (name, column, LACKING.contains(&name)));
    Ok(RecordBatch::try_from_iter_with_nullable(columns)?)
}
