//! A small table of Parquet with a column of pictures: what fuzzing of its reader starts from.
//!
//! cargo run --release -p aquafuse-data --features parquet --example small_table -- FILE

use std::error::Error;
use std::fs::File;
use std::sync::Arc;

use arrow_array::{ArrayRef, BinaryArray, Int32Array, RecordBatch, StringArray, StructArray};
use arrow_schema::{DataType, Field};
use parquet::arrow::ArrowWriter;
use parquet::arrow::arrow_writer::ArrowWriterOptions;
use parquet::basic::Compression;
use parquet::file::properties::WriterProperties;

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args_os().nth(1).ok_or("give the file to write")?;
    let bytes: ArrayRef = Arc::new(BinaryArray::from_opt_vec(vec![Some(b"no picture"), None]));
    let names: ArrayRef = Arc::new(StringArray::from(vec![Some("a.jpg"), None]));
    let image: ArrayRef = Arc::new(StructArray::from(vec![
        (Arc::new(Field::new("bytes", DataType::Binary, true)), bytes),
        (Arc::new(Field::new("path", DataType::Utf8, true)), names),
    ]));
    let label: ArrayRef = Arc::new(Int32Array::from(vec![7, -1]));
    let rows = RecordBatch::try_from_iter_with_nullable([("image", image, true), ("label", label, true)])?;
    let properties = WriterProperties::builder().set_compression(Compression::SNAPPY).build();
    // Without Arrow's own schema, which doubles the file.
    let options = ArrowWriterOptions::new().with_properties(properties).with_skip_arrow_metadata(true);
    let mut writer = ArrowWriter::try_new_with_options(File::create(path)?, rows.schema(), options)?;
    writer.write(&rows)?;
    writer.close()?;
    Ok(())
}
