//! JSON in the layout of COCO, written for the variants: only ids and file names change.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::iter::Peekable;
use std::slice::Iter;

use super::Made;
use crate::dataset::coco::{Annotation, File, Id, each, entries, image_at, lists, object};
use crate::dataset::split;

/// A file, and what was made of its images.
struct Writer<'a> {
    file: &'a File,
    made: &'a Made<'a>,
}

/// Writes a file for the images that were made, entry by entry.
pub(super) fn write(file: &File, text: &str, made: &Made<'_>, out: &mut dyn Write) -> io::Result<()> {
    let writer = Writer { file, made };
    let by_id = writer.made_of(text)?;
    entries::write_with(text, out, &mut |name, value, out| {
        match name {
            "images" => writer.images(value.get(), out)?,
            "annotations" => writer.annotations(value.get(), &by_id, out)?,
            _ => return Ok(false),
        }
        Ok(true)
    })?;
    out.write_all(b"\n")
}

impl Writer<'_> {
    /// The images of which something was made, by their ids.
    fn made_of<'t>(&self, text: &'t str) -> io::Result<BTreeMap<Id<'t>, Numbered>> {
        let ([images, _], mut by_id) = (lists(text)?, BTreeMap::new());
        let mut entries = self.file.entries.iter().peekable();
        each(images, &mut |place, raw| {
            if let Some(key) = self.key_at(place, &mut entries)
                && let Some((sample, variants)) = self.made.of(key)
            {
                let numbers = variants.iter().map(|(number, _)| *number).collect();
                if let Ok(id) = Id::of(image_at(place, raw)?.id) {
                    by_id.insert(
                        id,
                        Numbered { is_kept: self.made.keeps(sample), rank: sample.rank, numbers },
                    );
                }
            }
            Ok(())
        })?;
        Ok(by_id)
    }

    fn images(&self, list: &str, out: &mut dyn Write) -> io::Result<()> {
        let (mut entries, mut written) = (self.file.entries.iter().peekable(), Lines::begin(out)?);
        entries::items(list, &mut |place, raw| {
            let Some(key) = self.key_at(place, &mut entries) else { return Ok(()) };
            let Some((sample, variants)) = self.made.of(key) else { return Ok(()) };
            let image = image_at(place, raw)?;
            if self.made.keeps(sample) {
                written.add()?.write_all(raw.get().as_bytes())?;
            }
            let Ok(own) = Id::of(image.id) else { return Ok(()) };
            for (number, path) in &variants {
                let name = renamed(&image.file_name, split(key).1, split(path).1);
                let id = own.another(self.image_id(sample.rank, *number));
                entries::write_with(raw.get(), written.add()?, &mut |field, _, out| {
                    match field {
                        "id" => write!(out, "{id}")?,
                        "file_name" => out.write_all(serde_json::to_string(&name)?.as_bytes())?,
                        _ => return Ok(false),
                    }
                    Ok(true)
                })?;
            }
            Ok(())
        })?;
        written.end()
    }

    fn annotations(
        &self,
        list: &str,
        by_id: &BTreeMap<Id<'_>, Numbered>,
        out: &mut dyn Write,
    ) -> io::Result<()> {
        let mut written = Lines::begin(out)?;
        entries::items(list, &mut |place, raw| {
            let Ok(annotation) = object::<Annotation<'_>>(raw.get()) else { return Ok(()) };
            let Ok(image) = Id::of(annotation.image_id) else { return Ok(()) };
            let Some(Numbered { is_kept, rank, numbers }) = by_id.get(&image) else { return Ok(()) };
            if *is_kept {
                written.add()?.write_all(raw.get().as_bytes())?;
            }
            for &number in numbers {
                let place = i64::try_from(place).unwrap_or(i64::MAX);
                let id = nth(self.file.first_annotation, place, self.made.per_image, number);
                let id = annotation.id().map_or_else(|| id.to_string(), |own| own.another(id));
                let image_id = image.another(self.image_id(*rank, number));
                entries::write_with(raw.get(), written.add()?, &mut |field, _, out| {
                    match field {
                        "id" => write!(out, "{id}")?,
                        "image_id" => write!(out, "{image_id}")?,
                        _ => return Ok(false),
                    }
                    Ok(true)
                })?;
            }
            Ok(())
        })?;
        written.end()
    }

    /// The image of an entry of `images`, by those that are left of the entries known.
    fn key_at(&self, place: usize, left: &mut Peekable<Iter<'_, (usize, u32)>>) -> Option<&String> {
        let (_, key) = left.next_if(|(own, _)| *own == place)?;
        self.file.keys.get(*key as usize)
    }

    /// The id of a variant: the same for any subset of the dataset.
    fn image_id(&self, rank: u64, number: u32) -> i64 {
        nth(self.file.first_image, i64::try_from(rank).unwrap_or(i64::MAX), self.made.per_image, number)
    }
}

/// An image of which something was made: whether it is there itself, its place in the dataset, and the numbers of its
/// variants.
struct Numbered {
    is_kept: bool,
    rank: u64,
    numbers: Vec<u32>,
}

/// A list that is written, a line each entry.
struct Lines<'o> {
    out: &'o mut dyn Write,
    between: &'static str,
}

impl<'o> Lines<'o> {
    fn begin(out: &'o mut dyn Write) -> io::Result<Self> {
        out.write_all(b"[\n")?;
        Ok(Self { out, between: "" })
    }

    /// Where the next entry is written to.
    fn add(&mut self) -> io::Result<&mut dyn Write> {
        self.out.write_all(self.between.as_bytes())?;
        self.between = ",\n";
        Ok(&mut *self.out)
    }

    fn end(self) -> io::Result<()> {
        self.out.write_all(b"\n]")
    }
}

/// The name of an image in a file, with another image's instead of its own, in the same folder. Folders may stand between
/// backslashes.
fn renamed(said: &str, own: &str, new: &str) -> String {
    let after = said.rfind(['/', '\\']).map_or(0, |at| at.saturating_add(1));
    let folder = said.strip_suffix(own).or_else(|| said.get(..after)).unwrap_or_default();
    format!("{folder}{new}")
}

/// `first` + `place` * `each` + `number`.
fn nth(first: i64, place: i64, each: u32, number: u32) -> i64 {
    first.saturating_add(place.saturating_mul(each.into())).saturating_add(number.into())
}

/// Reads a file and writes it for two images with a variant each: a target of fuzzing.
#[cfg(feature = "fuzz-targets")]
pub(crate) fn try_parse(text: &str) {
    let Some((file, samples)) = crate::dataset::coco::try_examine(text) else { return };
    let variants = |_| Some(vec![(0, "v.jpg".to_owned())]);
    let made =
        Made { samples: &samples, variants: &variants, per_image: 1, originals: true, keeps: &|_| true };
    let mut written = Vec::new();
    write(&file, text, &made, &mut written).expect("what was read is written");
    let written = String::from_utf8(written).expect("text stays text");
    let [images, annotations] = lists(&written).expect("what is written is read");
    for list in [images, annotations] {
        each(list, &mut |_, _| Ok(())).expect("its lists are lists");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::Dataset;
    use crate::image_file::ReadOptions;

    const COCO: &str = r#"{"info": {"year": 2024},
    "images": [{"id": 7, "file_name": "a.jpg", "width": 64, "height": 48, "licence": 1.50},
               {"file_name": "b.jpg", "id": 9, "width": 64, "height": 48}],
    "annotations": [{"id": 3, "image_id": 7, "bbox": [1.0, 2, 30.25, 40], "score": 1e-3, "category_id": 1},
                    {"id": 5, "image_id": 9, "caption": "two fish"}],
    "categories": [{"id": 1, "name": "fish"}]}"#;

    fn folder() -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in [("a.jpg", ""), ("b.jpg", ""), ("instances.json", COCO)] {
            std::fs::write(folder.path().join(name), text).unwrap();
        }
        folder
    }

    #[test]
    fn of_coco_nothing_changes_but_ids_and_names() {
        let source = folder();
        let dataset = Dataset::open(source.path(), None, &ReadOptions::default()).unwrap();
        let variants = |place: usize| {
            let key = &dataset.samples[place].key;
            Some(vec![(0, key.replace(".jpg", "__w__0.jpg")), (1, key.replace(".jpg", "__w__1.jpg"))])
        };
        let made = Made {
            samples: &dataset.samples,
            variants: &variants,
            per_image: 2,
            originals: true,
            keeps: &|_| false,
        };
        let written = |made: &Made<'_>| {
            let bytes = dataset.indices[0].read(&dataset.root, &ReadOptions::default()).unwrap();
            let mut out = Vec::new();
            super::super::write(&dataset.indices[0], &bytes, made, &mut out).unwrap();
            String::from_utf8(out).unwrap()
        };
        let whole = written(&made);
        // Digits stay digits, fields their order.
        assert!(
            whole.contains(
                r#"{"id": 10, "file_name": "a__w__0.jpg", "width": 64, "height": 48, "licence": 1.50}"#
            ),
            "{whole}"
        );
        assert!(
            whole.contains(
                r#"{"id": 7, "image_id": 11, "bbox": [1.0, 2, 30.25, 40], "score": 1e-3, "category_id": 1}"#
            ),
            "{whole}"
        );
        let json: serde_json::Value = serde_json::from_str(&whole).unwrap();
        let before: serde_json::Value = serde_json::from_str(COCO).unwrap();
        assert_eq!((&json["info"], &json["categories"]), (&before["info"], &before["categories"]));
        for list in ["images", "annotations"] {
            let ids: std::collections::BTreeSet<i64> =
                json[list].as_array().unwrap().iter().map(|entry| entry["id"].as_i64().unwrap()).collect();
            assert_eq!(ids.len(), 6, "{list}");
        }
        // The same ids for the part that holds one image only.
        let second = |place: usize| if place == 1 { variants(place) } else { None };
        let part = Made { variants: &second, originals: false, ..made };
        let part: serde_json::Value = serde_json::from_str(&written(&part)).unwrap();
        for (list, count) in [("images", 2), ("annotations", 2)] {
            let entries = part[list].as_array().unwrap();
            assert_eq!(entries.len(), count);
            assert!(entries.iter().all(|entry| json[list].as_array().unwrap().contains(entry)), "{list}");
        }
    }
}
