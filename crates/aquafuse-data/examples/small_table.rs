//! Small tables of Parquet with a column of images: what fuzzing of their reader starts from.
//!
//! cargo run --release -p aquafuse-data --features parquet --example small_table -- FOLDER

use std::error::Error;
use std::fs::File;
use std::path::Path;
use std::sync::Arc;

use arrow_array::builder::{Int64Builder, ListBuilder, StringBuilder};
use arrow_array::{
    ArrayRef, BinaryArray, FixedSizeBinaryArray, Int32Array, RecordBatch, StringArray, StructArray,
    TimestampMicrosecondArray,
};
use arrow_schema::{DataType, Field};
use parquet::arrow::ArrowWriter;
use parquet::arrow::arrow_writer::ArrowWriterOptions;
use parquet::basic::{Compression, Encoding};
use parquet::file::properties::{WriterProperties, WriterPropertiesBuilder, WriterVersion};
use parquet::schema::types::ColumnPath;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args_os().nth(1).ok_or("give the folder to write to")?;
    let folder = Path::new(&folder);
    let bytes: ArrayRef = Arc::new(BinaryArray::from_opt_vec(vec![Some(b"no image"), None]));
    let names: ArrayRef = Arc::new(StringArray::from(vec![Some("a.jpg"), None]));
    let image: ArrayRef = Arc::new(StructArray::from(vec![
        (Arc::new(Field::new("bytes", DataType::Binary, true)), bytes),
        (Arc::new(Field::new("path", DataType::Utf8, true)), names),
    ]));
    let label: ArrayRef = Arc::new(Int32Array::from(vec![7, -1]));
    let plain = WriterProperties::builder().set_compression(Compression::SNAPPY);
    let columns = || vec![("image", image.clone()), ("label", label.clone())];
    write(&folder.join("a.parquet"), columns(), plain.clone(), false)?;
    write(&folder.join("arrow.parquet"), columns(), plain, true)?;

    let (mut tags, mut sizes) =
        (ListBuilder::new(StringBuilder::new()), ListBuilder::new(Int64Builder::new()));
    tags.append_value(["fish", "reef", "fish"].map(Some));
    tags.append_null();
    sizes.append_value([Some(3), None]);
    sizes.append_value([]);
    let texts: ArrayRef = Arc::new(StringArray::from(vec!["sand at 4 m", "sand at 40 m"]));
    let marks: ArrayRef = Arc::new(FixedSizeBinaryArray::try_from_iter(["abcd", "abce"].into_iter())?);
    let times: ArrayRef = Arc::new(TimestampMicrosecondArray::from(vec![Some(0), None]));
    let columns: Vec<(&str, ArrayRef)> = vec![
        ("image", image),
        ("tags", Arc::new(tags.finish())),
        ("sizes", Arc::new(sizes.finish())),
        ("texts", texts),
        ("marks", marks),
        ("times", times),
    ];
    let packed = ColumnPath::from(["sizes", "list", "item"].map(String::from).to_vec());
    let newer = WriterProperties::builder()
        .set_writer_version(WriterVersion::PARQUET_2_0)
        .set_column_dictionary_enabled(packed.clone(), false)
        .set_column_encoding(packed, Encoding::DELTA_BINARY_PACKED);
    write(&folder.join("lists.parquet"), columns, newer, false)
}

/// With Arrow's own schema or without it, for it doubles the file.
fn write(
    path: &Path,
    columns: Vec<(&str, ArrayRef)>,
    properties: WriterPropertiesBuilder,
    arrow: bool,
) -> Result<(), Box<dyn Error>> {
    let columns = columns.into_iter().map(|(name, column)| (name, column, true));
    let rows = RecordBatch::try_from_iter_with_nullable(columns)?;
    let options =
        ArrowWriterOptions::new().with_properties(properties.build()).with_skip_arrow_metadata(!arrow);
    let mut writer = ArrowWriter::try_new_with_options(File::create(path)?, rows.schema(), options)?;
    writer.write(&rows)?;
    writer.close()?;
    Ok(())
}
