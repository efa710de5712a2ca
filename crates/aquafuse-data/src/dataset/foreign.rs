//! Formats of annotations that are not read, known by their words, and what converts them.

use std::io::Read;

use super::tree::Tree;

/// A format of others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Format {
    pub(super) name: &'static str,
    /// What to do.
    pub(super) remedy: &'static str,
}

/// The ends of the names of a format's files, words that each of them contains, its name, and what to do.
type Known = (&'static [&'static str], &'static [&'static str], &'static str, &'static str);

/// The first one that fits is it.
const KNOWN: [Known; 14] = [
    (&[".json"], &["\"shapes\"", "\"imagePath\""], "labelme", "convert them to COCO with labelme2coco"),
    (&[".json"], &["\"_via_"], "VIA", "export them from VIA as COCO"),
    (&[".json"], &["\"regions\"", "\"shape_attributes\""], "VIA", "export them from VIA as COCO"),
    (&[".json"], &["\"objects\"", "\"classTitle\""], "Supervisely", "export them from Supervisely as COCO"),
    (
        &[".json"],
        &["\"annotations\"", "\"coordinates\""],
        "CreateML",
        "convert them to COCO with datumaro or Roboflow",
    ),
    (&[".json"], &["\"categories\"", "\"items\""], "datumaro", "run `datum convert -f coco`"),
    (
        &[".xml"],
        &["<annotations", "<image "],
        "CVAT's XML",
        "export them from CVAT as COCO, YOLO or Pascal VOC",
    ),
    (
        &[".csv", ".tsv"],
        &[","],
        "a table",
        "convert it to COCO, YOLO or Pascal VOC, for example with supervision or datumaro",
    ),
    (
        &[".jsonl", ".ndjson"],
        &["\"file_name\""],
        "metadata of Hugging Face",
        "save them as Parquet (`push_to_hub` or `to_parquet`), or as COCO",
    ),
    (&[".tar.gz", ".tgz"], &[], "a compressed shard", "decompress it with gunzip"),
    (&[".gz", ".zip", ".zst", ".bz2", ".xz", ".7z", ".rar"], &[], "an archive", "unpack it"),
    (&[".tfrecord", ".tfrecords", ".record"], &[], "TensorFlow's records", "export the data set as COCO"),
    (&[".parquet", ".arrow"], &[], "a table of Hugging Face", "give --format parquet"),
    (
        &[".mat", ".npy", ".npz", ".pkl", ".h5"],
        &[],
        "arrays",
        "save them as masks in PNG, or convert them to COCO",
    ),
];

impl Format {
    /// The format of a file of this name, and with this text, if it is text.
    pub(super) fn of(path: &str, text: Option<&str>) -> Option<Self> {
        let small = path.to_lowercase();
        let fits = |(ends, words, ..): &&Known| {
            ends.iter().any(|end| small.ends_with(end))
                && words.iter().all(|word| text.is_some_and(|text| text.contains(word)))
        };
        let (_, _, name, remedy) = KNOWN.iter().find(fits)?;
        Some(Self { name, remedy })
    }
}

/// Whether the first line of a text file begins with the name of an image, or has as many numbers as a box and nothing
/// else.
pub(super) fn is_table(tree: &Tree, path: &str) -> bool {
    let Ok(Some(text)) = tree.read(path) else { return false };
    let Some(line) = text.lines().find(|line| !line.trim().is_empty()) else { return false };
    let cells: Vec<&str> = line.split([' ', '\t', ',', ';']).filter(|cell| !cell.is_empty()).collect();
    let is_image = |cell: &&str| crate::image_file::Format::listed(std::path::Path::new(cell));
    cells.first().is_some_and(is_image)
        || cells.len() >= 4 && cells.iter().all(|cell| cell.parse::<f64>().is_ok())
}

/// Whether a file begins as JSON of objects or lists does, or as XML of annotations.
pub(super) fn is_marked_up(tree: &Tree, path: &str) -> bool {
    let mut begin = Vec::new();
    let file = std::fs::File::open(tree.root.join(path));
    if !file.is_ok_and(|file| file.take(BEGIN).read_to_end(&mut begin).is_ok()) {
        return false;
    }
    let text = String::from_utf8_lossy(&begin);
    let text = text.trim_start_matches('\u{feff}').trim_start();
    let is_list = text.strip_prefix('[').is_some_and(|rest| rest.trim_start().starts_with(['{', '[', '"']));
    let is_object = text.strip_prefix('{').is_some_and(|rest| rest.trim_start().starts_with('"'));
    is_list || is_object || text.contains("<annotation")
}

/// Bytes of a file that are looked at.
const BEGIN: u64 = 200;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_of_others_are_known_by_their_words() {
        let name = |path: &str, text| Format::of(path, Some(text)).map(|format| format.name);
        assert_eq!(name("a.json", r#"{"shapes": [], "imagePath": "a.jpg"}"#), Some("labelme"));
        assert_eq!(
            name("x/Annotations.XML", "<annotations><image id=\"0\"/></annotations>"),
            Some("CVAT's XML")
        );
        assert_eq!(name("s.tar.gz", ""), Some("a compressed shard"));
        assert_eq!(name("a.json", "{}"), None);
    }
}
