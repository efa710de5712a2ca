//! Tables of Parquet, multiplied.

use std::fs::{self, File};
use std::path::Path;
use std::sync::Arc;

use arrow_array::builder::{Int64Builder, ListBuilder};
use arrow_array::cast::AsArray;
use arrow_array::types::Int64Type;
use arrow_array::{
    Array, ArrayRef, FixedSizeListArray, Int64Array, RecordBatch, StringArray, StructArray, new_null_array,
};
use arrow_schema::{DataType, Field, Fields, Schema};
use parquet::arrow::ArrowWriter;
use parquet::basic::{Compression, Encoding};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{FileReader, SerializedFileReader};

use super::gathered::{check, remake};
use super::{files, job, making, run};

use crate::dataset::Layout;
use crate::dataset::tables::{Table, binary, cell, strings};
use crate::image_file::{ReadOptions, open_file};

const NOTE: &str = r#"{"info": {"features": {"image": {"_type": "Image"}}}}"#;

/// A table of three images, a row that only names one, a row without one, and two columns beside them.
fn table(root: &Path, bytes: &DataType) {
    fs::create_dir_all(root).unwrap();
    let image_files: Vec<Vec<u8>> = (0..3).map(super::image_file).collect();
    let mut held: Vec<Option<&[u8]>> = image_files.iter().map(|bytes| Some(bytes.as_slice())).collect();
    held.extend([None, None]);
    let fields = Fields::from(vec![
        Field::new("bytes", bytes.clone(), true),
        Field::new("path", DataType::Utf8, true),
    ]);
    let names =
        strings(&DataType::Utf8, &[Some("a.jpg"), None, Some("deep/c.v2.jpg"), Some("d.jpg"), None]).unwrap();
    let image: ArrayRef = Arc::new(StructArray::new(fields, vec![binary(bytes, &held), names], None));
    let mut boxes = ListBuilder::new(Int64Builder::new());
    for row in 0..5_i64 {
        boxes.append_value((0..row).map(|place| Some(10 * row + place)));
    }
    let boxes: ArrayRef = Arc::new(boxes.finish());
    let label = strings(&DataType::Utf8, &[Some("fish"), None, Some("reef"), Some("sand"), None]).unwrap();
    let columns = [("label", label), ("image", image), ("boxes", boxes)];
    let fields: Vec<Field> =
        columns.iter().map(|(name, column)| Field::new(*name, column.data_type().clone(), true)).collect();
    let schema = Schema::new(fields)
        .with_metadata(std::collections::HashMap::from([("huggingface".to_owned(), NOTE.to_owned())]));
    let rows =
        RecordBatch::try_new(Arc::new(schema), columns.into_iter().map(|(_, column)| column).collect())
            .unwrap();
    let file = File::create(root.join("train-0.parquet")).unwrap();
    // As Hugging Face's own writer does, beside Arrow's schema.
    let notes = vec![KeyValue::new("huggingface".to_owned(), NOTE.to_owned())];
    let groups = WriterProperties::builder()
        .set_max_row_group_row_count(Some(3))
        .set_key_value_metadata(Some(notes))
        .build();
    let mut writer = ArrowWriter::try_new(file, rows.schema(), Some(groups)).unwrap();
    writer.write(&rows).unwrap();
    writer.close().unwrap();
}

/// Name, bytes, label and boxes of every row.
type Row = (Option<String>, Option<Vec<u8>>, Option<String>, Vec<i64>);

fn rows(path: &Path) -> Vec<Row> {
    let (file, _) = open_file(path).unwrap();
    let mut table = Table::open(path, file, &ReadOptions::default()).unwrap();
    assert!(table.notes.iter().any(|note| note.key == "huggingface" && note.value.as_deref() == Some(NOTE)));
    assert_eq!(table.schema.metadata().get("huggingface").map(String::as_str), Some(NOTE));
    let mut all = Vec::new();
    while let Some(rows) = table.next().unwrap() {
        let labels = rows.column_by_name("label").unwrap().as_string::<i32>();
        let boxes = rows.column_by_name("boxes").unwrap().as_list::<i32>();
        for row in 0..rows.num_rows() {
            let found = cell(table.images(&rows).unwrap(), row);
            let label = (!labels.is_null(row)).then(|| labels.value(row).to_owned());
            let boxes = boxes.value(row).as_primitive::<Int64Type>().values().to_vec();
            let name = found.and_then(|found| found.name).map(str::to_owned);
            all.push((name, found.and_then(|found| found.bytes).map(<[u8]>::to_vec), label, boxes));
        }
    }
    all
}

#[test]
fn tables_are_multiplied_row_by_row_and_keep_every_other_column() {
    for bytes in [DataType::Binary, DataType::LargeBinary, DataType::BinaryView] {
        let place = tempfile::tempdir().unwrap();
        let (root, out) = (place.path().join("set"), place.path().join("out"));
        table(&root, &bytes);
        let mut job = job(&root, &out);
        job.manifest_table = true;
        assert_eq!(job.dataset.layout, Layout::Parquet);
        // The row that only names its image fails, and is carried over, as is the one without.
        assert_eq!(run(&job).failed, 1);
        let manifest = fs::read_to_string(out.join("manifest.jsonl")).unwrap();
        assert!(manifest.contains("the row only names its image"), "{manifest}");
        let (before, after) = (rows(&root.join("train-0.parquet")), rows(&out.join("train-0.parquet")));
        assert_eq!(after.len(), 5 + 3 * job.recipe.per_image as usize);
        let names: Vec<&str> = after.iter().filter_map(|row| row.0.as_deref()).collect();
        assert!(names[1].starts_with("a__") && names[1].ends_with("__0.jpg"), "{names:?}");
        assert!(names[4].starts_with("1__") && names.contains(&"deep/c.v2.jpg"), "{names:?}");
        let mut at = 0;
        for old in &before {
            assert_eq!(*old, after[at]);
            let variants = if old.1.is_some() { 3 } else { 0 };
            for new in &after[at + 1..=at + variants] {
                assert_eq!((&new.2, &new.3), (&old.2, &old.3));
                assert_ne!(new.1, old.1);
            }
            at += 1 + variants;
        }
        assert!(check(&out, Some(&root), &ReadOptions::default()).unwrap().wrong.is_empty());

        let again = place.path().join("again");
        let only = Some("train-0.parquet/2");
        let made = remake(&out.join("manifest.jsonl"), &making(only, None, &again)).unwrap();
        assert_eq!((made.equal.len(), made.failed.len()), (3, 0));
        for (name, bytes) in files(&again) {
            assert!(after.iter().any(|row| row.0.as_ref() == Some(&name) && row.1.as_ref() == Some(&bytes)));
        }
    }
}

#[test]
fn a_manifest_is_a_table_too_and_is_no_data_set() {
    let place = tempfile::tempdir().unwrap();
    let (root, out) = (place.path().join("set"), place.path().join("out"));
    table(&root, &DataType::Binary);
    let mut job = job(&root, &out);
    job.manifest_table = true;
    run(&job);
    let file = File::open(out.join("manifest.parquet")).unwrap();
    let reader = parquet::arrow::arrow_reader::ParquetRecordBatchReader::try_new(file, 64).unwrap();
    let rows: Vec<RecordBatch> = reader.map(Result::unwrap).collect();
    let count: usize = rows.iter().map(RecordBatch::num_rows).sum();
    assert_eq!(count, 9);
    let containers = rows[0].column_by_name("container").unwrap().as_string::<i32>();
    assert_eq!(containers.value(0), "train-0.parquet");
    let about = check(&out, None, &ReadOptions::default()).unwrap();
    assert!(about.wrong.is_empty() && about.unlisted.is_empty(), "{about:?}");

    fs::remove_file(out.join("train-0.parquet")).unwrap();
    let again = crate::dataset::Dataset::open(&out, None, &ReadOptions::default());
    let refused = again.unwrap_err().to_string();
    assert!(refused.contains("holds no images"), "{refused}");
}

#[test]
fn tables_that_are_damaged_or_hold_no_images_are_refused_by_name() {
    let place = tempfile::tempdir().unwrap();
    let (root, out) = (place.path().join("set"), place.path().join("out"));
    table(&root, &DataType::Binary);
    let path = root.join("train-0.parquet");
    let whole = fs::read(&path).unwrap();
    for cut in [4, whole.len() / 2, whole.len() - 1] {
        fs::write(&path, &whole[..cut]).unwrap();
        assert_eq!((run(&job(&root, &out)).failed, files(&out).len()), (1, 1), "cut at {cut}");
    }
    let plain = strings(&DataType::Utf8, &[Some("no image")]).unwrap();
    let rows = RecordBatch::try_from_iter([("image", plain)]).unwrap();
    let mut writer = ArrowWriter::try_new(File::create(&path).unwrap(), rows.schema(), None).unwrap();
    writer.write(&rows).unwrap();
    writer.close().unwrap();
    run(&job(&root, &out));
    let manifest = fs::read_to_string(out.join("manifest.jsonl")).unwrap();
    assert!(manifest.contains("it has no column of images"), "{manifest}");
}

#[test]
fn a_few_bytes_that_say_they_are_many_rows_are_refused() {
    let place = tempfile::tempdir().unwrap();
    let fields = Fields::from(vec![Field::new("bytes", DataType::Binary, true)]);
    let empty: ArrayRef = Arc::new(StructArray::new_null(fields, 100_000));
    let rows = RecordBatch::try_from_iter_with_nullable([("image", empty, true)]).unwrap();
    let path = place.path().join("a.parquet");
    let mut writer = ArrowWriter::try_new(File::create(&path).unwrap(), rows.schema(), None).unwrap();
    writer.write(&rows).unwrap();
    writer.close().unwrap();
    let (file, bytes) = open_file(&path).unwrap();
    assert!(bytes < 10_000, "{bytes}");
    let refused = Table::open(&path, file, &ReadOptions::default()).err().unwrap().to_string();
    assert!(refused.contains("it declares 100000 rows"), "{refused}");
}

#[test]
fn a_page_that_says_it_unpacks_to_more_than_is_allowed_is_refused() {
    let place = tempfile::tempdir().unwrap();
    // Nothing that could be packed, so that a page is no smaller than what it holds.
    let noise: Vec<u8> = (0_u32..100_000).map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8).collect();
    let fields = Fields::from(vec![Field::new("bytes", DataType::Binary, true)]);
    let bytes = binary(&DataType::Binary, &[Some(&noise)]);
    let image_files: ArrayRef = Arc::new(StructArray::new(fields, vec![bytes], None));
    let rows = RecordBatch::try_from_iter([("image", image_files)]).unwrap();
    let path = place.path().join("a.parquet");
    let properties =
        WriterProperties::builder().set_compression(Compression::SNAPPY).set_dictionary_enabled(false);
    let file = File::create(&path).unwrap();
    let mut writer = ArrowWriter::try_new(file, rows.schema(), Some(properties.build())).unwrap();
    writer.write(&rows).unwrap();
    let at = usize::try_from(writer.close().unwrap().row_group(0).column(0).data_page_offset()).unwrap();

    let options = ReadOptions { max_memory: 1 << 19, ..ReadOptions::default() };
    let open = || Table::open(&path, open_file(&path).unwrap().0, &options);
    open().unwrap();
    // A page of data, and how much it unpacks to: three bytes hold a mebibyte at most.
    let mut written = fs::read(&path).unwrap();
    assert_eq!(written[at..at + 3], [0x15, 0, 0x15]);
    written[at + 3..at + 6].copy_from_slice(&[0xfe, 0xff, 0x7f]);
    fs::write(&path, written).unwrap();
    let refused = open().err().unwrap().to_string();
    assert!(refused.contains("1048575 bytes, 524288 are allowed"), "{refused}");
}

/// Lists in one row, of which a few kilobytes hold as many values as one likes.
#[test]
fn a_row_with_a_list_that_takes_more_memory_than_is_allowed_is_refused() {
    const MANY: usize = 100_000;
    let list = |values: ArrayRef| -> ArrayRef {
        let field = Arc::new(Field::new("item", values.data_type().clone(), true));
        Arc::new(FixedSizeListArray::new(field, i32::try_from(values.len()).unwrap(), values, None))
    };
    let text = "fish ".repeat(1_000);
    let lists: [ArrayRef; 3] = [
        Arc::new(Int64Array::from(vec![7; MANY])),
        new_null_array(&DataType::Int32, MANY),
        // One text in a dictionary.
        Arc::new(StringArray::from(vec![text.as_str(); MANY])),
    ];
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("a.parquet");
    let fields = Fields::from(vec![Field::new("bytes", DataType::Binary, true)]);
    let image_file = binary(&DataType::Binary, &[Some(&super::image_file(0))]);
    let image_file: ArrayRef = Arc::new(StructArray::new(fields, vec![image_file], None));
    for values in lists {
        let kind = values.data_type().clone();
        let rows = RecordBatch::try_from_iter([("image", image_file.clone()), ("of", list(values))]).unwrap();
        let mut writer = ArrowWriter::try_new(File::create(&path).unwrap(), rows.schema(), None).unwrap();
        writer.write(&rows).unwrap();
        writer.close().unwrap();
        let (file, bytes) = open_file(&path).unwrap();
        assert!(bytes < 1 << 16, "{kind}: {bytes}");
        let options = ReadOptions { max_memory: 1 << 20, ..ReadOptions::default() };
        let refused = Table::open(&path, file, &options).err().unwrap().to_string();
        assert!(refused.contains("bytes, 1048576 are allowed"), "{kind}: {refused}");
    }
}

/// Such a page begins with the number of its strings, and its reader makes room for them, however many, before it looks further.
#[test]
fn texts_written_as_differences_are_refused() {
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("a.parquet");
    let text: ArrayRef = Arc::new(StringArray::from(vec!["fish", "fishes"]));
    let rows = RecordBatch::try_from_iter([("text", text)]).unwrap();
    for encoding in [Encoding::DELTA_BYTE_ARRAY, Encoding::DELTA_LENGTH_BYTE_ARRAY] {
        let properties = WriterProperties::builder().set_dictionary_enabled(false).set_encoding(encoding);
        let file = File::create(&path).unwrap();
        let mut writer = ArrowWriter::try_new(file, rows.schema(), Some(properties.build())).unwrap();
        writer.write(&rows).unwrap();
        writer.close().unwrap();
        let refused = Table::open(&path, open_file(&path).unwrap().0, &ReadOptions::default()).err().unwrap();
        assert!(refused.to_string().contains(&format!("in the encoding {encoding}. Write")), "{refused}");
    }
}

/// What a page of a dictionary says that it holds is what its reader makes room for.
#[test]
fn a_dictionary_that_says_it_has_more_entries_than_bytes_is_refused() {
    let place = tempfile::tempdir().unwrap();
    let root = place.path().join("set");
    table(&root, &DataType::Binary);
    let path = root.join("train-0.parquet");
    let (file, _) = open_file(&path).unwrap();
    let footer = SerializedFileReader::new(file).unwrap();
    let column =
        footer.metadata().row_group(0).columns().iter().find(|of| of.dictionary_page_offset().is_some());
    let at = usize::try_from(column.unwrap().dictionary_page_offset().unwrap()).unwrap();
    let mut written = fs::read(&path).unwrap();
    // The struct of a dictionary, and its number of entries, the first number in it.
    let head = at + written[at..].windows(2).position(|two| two == [0x4c, 0x15]).unwrap();
    assert!(head < at + 20 && written[head + 2] < 0x40, "{:x?}", &written[at..head + 4]);
    written[head + 2] = 0x7e;
    fs::write(&path, written).unwrap();
    let refused = Table::open(&path, open_file(&path).unwrap().0, &ReadOptions::default()).err().unwrap();
    assert!(refused.to_string().contains("more entries than bytes"), "{refused}");
}

#[test]
fn a_footer_whose_list_has_more_values_than_bytes_is_refused_and_not_counted_through() {
    // A field of a number that no table has: a list of this kind, its length apart: 2^31 - 1.
    let refused = |kind: u8| refusal_of_footer(&[&[0xf9, 0xf0 | kind][..], &[0xff; 4], &[7, 0]].concat());
    let [bytes, booleans] = [3, 1].map(refused);
    assert!(bytes.contains("its footer ends too soon"), "{bytes}");
    assert!(booleans.contains("a list of Booleans"), "{booleans}");
}

/// The library would take the bytes of such a field for something else, and what follows for other fields.
#[test]
fn a_footer_whose_field_holds_what_it_never_holds_is_refused() {
    let never = "a field of the wrong type";
    let refused = [
        // The version, a struct; the schema, a number; the schema, a list of strings; the name in it, a struct.
        [0x1c, 0, 0, 0, 0].as_slice(),
        &[0x25, 0, 0],
        &[0x29, 0x18, 0, 0],
        &[0x29, 0x1c, 0x4c, 0, 0, 0],
        // The same number, written out, after a later field.
        &[0x35, 0, 0x0c, 2, 0, 0],
    ];
    for footer in refused {
        let said = refusal_of_footer(footer);
        assert!(said.contains(never), "{footer:x?}: {said}");
    }
    // What the format has not is passed over: a struct with a number in it, of the number 9.
    let unknown = refusal_of_footer(&[0x9c, 0x15, 0, 0, 0]);
    assert!(unknown.contains("version is missing"), "{unknown}");
    // Nor does a number of 16 bits wrap, so that it is one that is known.
    let beyond = refusal_of_footer(&[0x0c, 0x82, 0x80, 8, 0, 0]);
    assert!(beyond.contains("a field number that is out of range"), "{beyond}");
}

/// Why a table of nothing but this footer is refused.
fn refusal_of_footer(footer: &[u8]) -> String {
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("a.parquet");
    let tail = u32::try_from(footer.len()).unwrap().to_le_bytes();
    fs::write(&path, [b"PAR1", footer, &tail, b"PAR1"].concat()).unwrap();
    let (file, _) = open_file(&path).unwrap();
    Table::open(&path, file, &ReadOptions::default()).err().unwrap().to_string()
}
