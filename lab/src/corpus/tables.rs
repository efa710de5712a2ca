//! Small tables of Parquet with a column of images: what fuzzing of their reader starts from.

use std::sync::Arc;

use anyhow::Result;
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

/// The tables by name.
pub(super) fn all() -> Result<[(&'static str, Vec<u8>); 3]> {
    let bytes: ArrayRef = Arc::new(BinaryArray::from_opt_vec(vec![Some(b"no image"), None]));
    let names: ArrayRef = Arc::new(StringArray::from(vec![Some("a.jpg"), None]));
    let image: ArrayRef = Arc::new(StructArray::from(vec![
        (Arc::new(Field::new("bytes", DataType::Binary, true)), bytes),
        (Arc::new(Field::new("path", DataType::Utf8, true)), names),
    ]));
    let label: ArrayRef = Arc::new(Int32Array::from(vec![7, -1]));
    let plain = WriterProperties::builder().set_compression(Compression::SNAPPY);
    let columns = || vec![("image", image.clone()), ("label", label.clone())];
    let short = table(columns(), plain.clone(), false)?;
    let with_arrow = table(columns(), plain, true)?;

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
    let lists = table(columns, newer, false)?;
    Ok([("a.parquet", short), ("arrow.parquet", with_arrow), ("lists.parquet", lists)])
}

/// With Arrow's own schema or without it, for it doubles the file.
fn table(
    columns: Vec<(&str, ArrayRef)>,
    properties: WriterPropertiesBuilder,
    arrow: bool,
) -> Result<Vec<u8>> {
    let columns = columns.into_iter().map(|(name, column)| (name, column, true));
    let rows = RecordBatch::try_from_iter_with_nullable(columns)?;
    let options =
        ArrowWriterOptions::new().with_properties(properties.build()).with_skip_arrow_metadata(!arrow);
    let mut writer = ArrowWriter::try_new_with_options(Vec::new(), rows.schema(), options)?;
    writer.write(&rows)?;
    Ok(writer.into_inner()?)
}
