//! JSON with `images` and `annotations`: instances, key points, captions, whatever each annotation holds.
//!
//! A file is taken apart into the texts of its entries, and those are written as they stand: numbers keep their digits,
//! unknown fields their place. Ids and file names alone are ours.

mod entries;

use std::collections::{BTreeMap, BTreeSet};

use entries::Entries;
use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::value::RawValue;

use super::index::Made;
use super::tree::Tree;
use super::{Dataset, Fault, Index, Sample, inside, join, split, stem};
use crate::picture::{FileError, one_line};

/// As far as this beyond the picture's edge, in pixels, a box is rounded rather than wrong.
const SLACK: f64 = 1.0;

/// A file in the layout of COCO.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct File {
    /// Its path.
    pub(super) path: String,
    /// The picture of each entry of `images`, by its place there; none where it is not in the data set.
    keys: Vec<Option<String>>,
    /// The first id for a variant's entry in `images`, the same in all files of a data set.
    first_image: i64,
    /// The first id for a variant's annotation.
    first_annotation: i64,
}

/// What decides whether it is such a file.
#[derive(Deserialize)]
struct Probe {
    images: Vec<IgnoredAny>,
    annotations: Option<Vec<IgnoredAny>>,
    categories: Option<Vec<IgnoredAny>>,
}

#[derive(Deserialize)]
struct Image<'a> {
    #[serde(borrow)]
    id: &'a RawValue,
    file_name: String,
    width: Option<f64>,
    height: Option<f64>,
}

#[derive(Deserialize)]
struct Annotation<'a> {
    #[serde(borrow)]
    id: Option<&'a RawValue>,
    #[serde(borrow)]
    image_id: &'a RawValue,
    bbox: Option<Vec<f64>>,
}

/// The lists that are taken apart.
#[derive(Deserialize)]
struct Lists<'a> {
    #[serde(borrow)]
    images: Vec<&'a RawValue>,
    #[serde(borrow, default)]
    annotations: Vec<&'a RawValue>,
}

/// Where such files stand: at the top, in a folder of the top, or in `annotations`.
fn candidates(tree: &Tree) -> impl Iterator<Item = &String> {
    let fits = |path: &&String| {
        let folder = split(path).0;
        !folder.contains('/') || split(folder).1 == "annotations"
    };
    tree.ending(".json").filter(fits)
}

fn is_coco(tree: &Tree, path: &str) -> bool {
    let probe = |text: String| object::<Probe>(&text).ok();
    let probe = tree.read(path).ok().and_then(probe);
    probe.is_some_and(|found| {
        let Probe { images, annotations, categories } = found;
        !images.is_empty() && (annotations.is_some() || categories.is_some())
    })
}

pub(super) fn evidence(tree: &Tree) -> Option<String> {
    let path = candidates(tree).find(|path| is_coco(tree, path))?;
    Some(format!("{path} holds images and annotations"))
}

pub(super) fn read(tree: &Tree, dataset: &mut Dataset) -> Result<(), FileError> {
    let (mut keys, mut files, mut last) = (BTreeSet::new(), Vec::new(), 0);
    for path in candidates(tree).filter(|path| is_coco(tree, path)) {
        let text = tree.read(path)?;
        match examine(tree, path, &text) {
            Ok(found) => {
                keys.extend(found.file.keys.iter().flatten().cloned());
                last = last.max(found.last_image);
                dataset.faults.extend(found.faults);
                files.push(found.file);
            }
            Err(cause) => dataset.faults.push(Fault::new(path, cause)),
        }
    }
    for mut file in files {
        file.first_image = last.saturating_add(1);
        dataset.indices.push(Index::Coco(file));
    }
    dataset.samples = keys.into_iter().map(|key| Sample::new(key, Vec::new())).collect();
    Ok(())
}

/// What a file holds.
struct Found {
    file: File,
    last_image: i64,
    faults: Vec<Fault>,
}

/// Finds the pictures of a file, and what is wrong with it.
fn examine(tree: &Tree, path: &str, text: &str) -> Result<Found, String> {
    let lists: Lists<'_> = object(text)?;
    let (mut faults, mut keys) = (Vec::new(), Vec::new());
    let mut by_id: BTreeMap<&str, (Option<String>, [Option<f64>; 2])> = BTreeMap::new();
    let (mut last_image, mut last_annotation) = (0, 0);
    let mut seen = BTreeSet::new();
    for (raw, number) in lists.images.iter().zip(0_usize..) {
        let place = format!("{path}, images[{number}]");
        let image: Image<'_> = match object(raw.get()) {
            Ok(image) => image,
            Err(cause) => {
                faults.push(Fault::new(place, cause));
                keys.push(None);
                continue;
            }
        };
        let key = match inside(&image.file_name) {
            Ok(name) => locate(tree, path, &name),
            Err(cause) => {
                faults.push(Fault::new(&place, format!("file_name {:?} is {cause}", image.file_name)));
                keys.push(None);
                continue;
            }
        };
        let Some(key) = key else {
            faults.push(Fault::new(place, format!("there is no picture {:?}", image.file_name)));
            keys.push(None);
            by_id.entry(image.id.get()).or_insert((None, [None; 2]));
            continue;
        };
        if !seen.insert(key.clone()) {
            faults.push(Fault::new(&place, format!("{key} has an entry already")).of(&key));
        }
        match id(image.id) {
            Ok(id) => last_image = last_image.max(id),
            Err(cause) => faults.push(Fault::new(&place, cause).of(&key)),
        }
        if by_id.insert(image.id.get(), (Some(key.clone()), [image.width, image.height])).is_some() {
            let cause = format!("another picture has its id {}", image.id.get());
            faults.push(Fault::new(place, cause).of(&key));
        }
        keys.push(Some(key));
    }
    let mut ids = BTreeSet::new();
    for (raw, number) in lists.annotations.iter().zip(0_usize..) {
        let place = format!("{path}, annotations[{number}]");
        let annotation: Annotation<'_> = match object(raw.get()) {
            Ok(annotation) => annotation,
            Err(cause) => {
                faults.push(Fault::new(place, cause));
                continue;
            }
        };
        let Some((key, size)) = by_id.get(annotation.image_id.get()) else {
            let cause = format!("no picture has the id {}", annotation.image_id.get());
            faults.push(Fault::new(place, cause));
            continue;
        };
        let mut fault = |cause: String| {
            let fault = Fault::new(&place, cause);
            faults.push(key.as_ref().map_or_else(|| fault.clone(), |key| fault.clone().of(key)));
        };
        match annotation.id.map(|raw| (id(raw), raw.get())) {
            Some((Ok(id), text)) => {
                last_annotation = last_annotation.max(id);
                if !ids.insert(text) {
                    fault(format!("another annotation has its id {text}"));
                }
            }
            Some((Err(cause), _)) => fault(cause),
            None => {}
        }
        if let Some(cause) = annotation.bbox.and_then(|sides| outside(&sides, *size)) {
            fault(cause);
        }
    }
    let first_annotation = last_annotation.saturating_add(1);
    let file = File { path: path.to_owned(), keys, first_image: 0, first_annotation };
    Ok(Found { file, last_image, faults })
}

/// Where the picture of a name stands, by the habits of those who write such files.
fn locate(tree: &Tree, file: &str, name: &str) -> Option<String> {
    let (folder, file_name) = split(file);
    let above = split(folder).0;
    let part = stem(file_name).rsplit('_').next().unwrap_or_default();
    let beside = [folder.to_owned(), join(folder, "images")];
    let around = ["".to_owned(), "images".into(), part.to_owned(), join("images", part)];
    let around = around.map(|folder| if above.is_empty() { folder } else { join(above, &folder) });
    beside.into_iter().chain(around).map(|folder| join(&folder, name)).find(|path| tree.holds(path))
}

/// An object with the fields of `T`: a list of their values, which would do as well for the reader of JSON, is none.
fn object<'a, T: Deserialize<'a>>(text: &'a str) -> Result<T, String> {
    if !text.trim_start().starts_with('{') {
        return Err("it is no object".into());
    }
    serde_json::from_str(text).map_err(|error| one_line(&error.to_string()))
}

/// An id as a number.
fn id(raw: &RawValue) -> Result<i64, String> {
    let said: String = raw.get().chars().take(20).collect();
    raw.get().parse().map_err(|_| format!("the id is {said}, but is a whole number"))
}

/// What is wrong with a box, where it is not inside its picture.
fn outside(sides: &[f64], [width, height]: [Option<f64>; 2]) -> Option<String> {
    let [x, y, w, h] = *sides else {
        return Some(format!("its box has {} numbers, but a box has 4", sides.len()));
    };
    let within = |low: f64, length: f64, size: Option<f64>| {
        low >= -SLACK && length >= 0.0 && size.is_none_or(|size| low + length <= size + SLACK)
    };
    (!(within(x, w, width) && within(y, h, height)))
        .then(|| format!("the box {x}, {y}, {w}, {h} is not inside the picture"))
}

impl File {
    /// The file for the pictures that were made.
    pub(super) fn for_made(&self, text: &str, made: &Made<'_>) -> Result<Vec<u8>, String> {
        let said = |error: serde_json::Error| one_line(&error.to_string());
        let top: Entries<'_> = serde_json::from_str(text).map_err(said)?;
        let lists: Lists<'_> = serde_json::from_str(text).map_err(said)?;
        let mut images = Vec::new();
        let mut by_id = BTreeMap::new();
        for (raw, key) in lists.images.iter().zip(&self.keys) {
            let Some((sample, variants)) = key.as_deref().and_then(|key| made.of(key)) else { continue };
            let image: Image<'_> = serde_json::from_str(raw.get()).map_err(said)?;
            let numbers: Vec<u32> = variants.iter().map(|(number, _)| *number).collect();
            by_id.insert(image.id.get(), (sample.rank, numbers));
            if made.originals {
                images.push(raw.get().to_owned());
            }
            let fields: Entries<'_> = serde_json::from_str(raw.get()).map_err(said)?;
            for (number, path) in &variants {
                let name = join(split(&image.file_name).0, split(path).1);
                let name = serde_json::to_string(&name).map_err(said)?;
                let id = self.image_id(made, sample.rank, *number).to_string();
                images.push(fields.with(&[("id", &id), ("file_name", &name)]));
            }
        }
        let mut annotations = Vec::new();
        for (raw, place) in lists.annotations.iter().zip(0_i64..) {
            let Ok(annotation) = object::<Annotation<'_>>(raw.get()) else { continue };
            let Some((rank, numbers)) = by_id.get(annotation.image_id.get()) else { continue };
            if made.originals {
                annotations.push(raw.get().to_owned());
            }
            let fields: Entries<'_> = serde_json::from_str(raw.get()).map_err(said)?;
            for number in numbers {
                let id = nth(self.first_annotation, place, made.per_image, *number).to_string();
                let image_id = self.image_id(made, *rank, *number).to_string();
                annotations.push(fields.with(&[("id", &id), ("image_id", &image_id)]));
            }
        }
        let list = |entries: Vec<String>| format!("[\n{}\n]", entries.join(",\n"));
        Ok((top.with(&[("images", &list(images)), ("annotations", &list(annotations))]) + "\n").into_bytes())
    }

    /// The id of a variant: the same for any subset of the data set.
    fn image_id(&self, made: &Made<'_>, rank: u64, number: u32) -> i64 {
        nth(self.first_image, i64::try_from(rank).unwrap_or(i64::MAX), made.per_image, number)
    }
}

/// `first` + `place` * `each` + `number`.
fn nth(first: i64, place: i64, each: u32, number: u32) -> i64 {
    first.saturating_add(place.saturating_mul(each.into())).saturating_add(number.into())
}

/// Reads a file for nothing but that: a target of fuzzing.
#[cfg(feature = "fuzz-targets")]
pub(crate) fn try_parse(text: &str) {
    let files = ["a.jpg", "images/b.jpg"].map(str::to_owned).into_iter().collect();
    let tree = Tree { root: std::path::PathBuf::new(), files, faults: Vec::new() };
    let Ok(found) = examine(&tree, "instances.json", text) else { return };
    let keys: BTreeSet<&String> = found.file.keys.iter().flatten().collect();
    let samples: Vec<Sample> = keys.into_iter().map(|key| Sample::new(key, Vec::new())).collect();
    let variants = |_| Some(vec![(0, "v.jpg".to_owned())]);
    let made = Made { samples: &samples, variants: &variants, per_image: 1, originals: true };
    let written = found.file.for_made(text, &made).expect("what was read is written");
    let written = String::from_utf8(written).expect("text stays text");
    assert!(serde_json::from_str::<Lists<'_>>(&written).is_ok(), "what is written is read");
}
