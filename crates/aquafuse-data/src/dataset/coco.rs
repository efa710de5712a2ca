//! JSON with `images` and `annotations`: instances, key points, captions, whatever each annotation holds.
//!
//! A file is split into the source text of its entries, which is copied unchanged: numbers keep their digits, unknown
//! fields their position. Only ids and file names are replaced.

pub(crate) mod entries;
mod id;
mod locate;

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::io;

use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::value::RawValue;

use entries::Sides;
pub(crate) use id::Id;
use locate::{Located, Pictures};

use super::tree::Tree;
use super::{Dataset, Fault, Faults, Index, Sample};
use crate::files::{FileError, one_line};
#[cfg(feature = "fuzz-targets")]
use crate::image_file::ReadOptions;

/// As far as this beyond the image's edge, in pixels, a box is rounded rather than wrong.
const SLACK: f64 = 1.0;

/// A file in the layout of COCO.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct File {
    /// Its path.
    pub(super) path: String,
    /// The images in the dataset that it has entries for.
    pub(crate) keys: Vec<String>,
    /// Those entries of `images`: their places there, and which of the images each is of.
    pub(crate) entries: Vec<(usize, u32)>,
    /// The first id for a variant's entry in `images`, the same in all files of a dataset.
    pub(crate) first_image: i64,
    /// The first id for a variant's annotation.
    pub(crate) first_annotation: i64,
}

/// What decides whether it is such a file.
#[derive(Deserialize)]
struct Probe {
    images: Vec<IgnoredAny>,
    annotations: Option<Vec<IgnoredAny>>,
    categories: Option<Vec<IgnoredAny>>,
}

#[derive(Deserialize)]
pub(crate) struct Image<'a> {
    #[serde(borrow)]
    pub(crate) id: &'a RawValue,
    pub(crate) file_name: String,
    width: Option<f64>,
    height: Option<f64>,
}

impl Image<'_> {
    /// Its sides in pixels, if they are said.
    pub(super) fn size(&self) -> Option<[f64; 2]> {
        Some([self.width?, self.height?]).filter(|sides| sides.iter().all(|side| *side > 0.0))
    }
}

impl<'a> Annotation<'a> {
    /// The left upper corner of its box and its sides, if it has one.
    pub(super) fn sides(&self) -> Option<[f64; 4]> {
        let sides: Sides = serde_json::from_str(self.bbox?.get()).ok()?;
        (sides.count == 4).then_some(sides.first)
    }

    /// Its id, if it has a good one.
    pub(crate) fn id(&self) -> Option<Id<'a>> {
        self.id.and_then(|raw| Id::of(raw).ok())
    }
}

#[derive(Deserialize)]
pub(crate) struct Annotation<'a> {
    #[serde(borrow)]
    id: Option<&'a RawValue>,
    #[serde(borrow)]
    pub(crate) image_id: &'a RawValue,
    #[serde(borrow)]
    bbox: Option<&'a RawValue>,
    segments_info: Option<IgnoredAny>,
}

/// The text of a file, if it is such a one.
fn coco(tree: &Tree, path: &str) -> Result<Option<String>, FileError> {
    let is_coco = |text: &String| match object::<Probe>(text) {
        Ok(Probe { images, annotations, categories }) => {
            !images.is_empty() && (annotations.is_some() || categories.is_some())
        }
        // One that has a list twice is one, with a fault.
        Err(cause) => cause.contains("duplicate field"),
    };
    Ok(tree.read(path)?.filter(is_coco))
}

pub(super) fn evidence(tree: &Tree) -> Result<Option<String>, FileError> {
    for path in tree.ending(".json") {
        if coco(tree, path)?.is_some() {
            return Ok(Some(format!("{path} holds images and annotations")));
        }
    }
    Ok(None)
}

pub(super) fn read(tree: &Tree, dataset: &mut Dataset) -> Result<(), FileError> {
    let (mut keys, mut files, mut last) = (BTreeSet::new(), Vec::new(), 0);
    let pictures = Pictures::of(tree);
    for path in tree.ending(".json") {
        let text = match coco(tree, path) {
            Ok(Some(text)) => text,
            Ok(None) => continue,
            // It may be about something else.
            Err(error) => {
                dataset.faults.add(Fault::new(path, one_line(&error.to_string())));
                continue;
            }
        };
        match examine(&pictures, path, &text, &mut dataset.faults) {
            Ok((file, last_image)) => {
                keys.extend(file.keys.iter().cloned());
                last = last.max(last_image);
                files.push(file);
            }
            Err(cause) => dataset.faults.add(Fault::new(path, cause)),
        }
    }
    for mut file in files {
        file.first_image = last.saturating_add(1);
        dataset.indices.push(Index::Coco(file));
    }
    dataset.samples = keys.into_iter().map(|key| Sample::new(key, Vec::new())).collect();
    Ok(())
}

/// What is known of an image by its id: which of those in the dataset it is, if it is there, and its sides, NaN where they
/// are not said.
type Known = (Option<u32>, [f64; 2]);

/// Finds the images of a file, and what is wrong with it; gives the largest id of an image with it.
fn examine<'a>(
    pictures: &Pictures<'_>,
    path: &str,
    text: &'a str,
    faults: &mut Faults,
) -> Result<(File, i64), String> {
    let (mut keys, mut places) = (Vec::<String>::new(), HashMap::<String, u32>::new());
    let (mut entries, mut by_id, mut last_image) = (Vec::new(), BTreeMap::<Id<'a>, Known>::new(), 0);
    let [images, annotations] = lists(text).map_err(|error| error.to_string())?;
    let mut see_image = |number: usize, raw: &'a RawValue| {
        let fault = |cause: String| Fault::new(format!("{path}, images[{number}]"), cause);
        let image: Image<'_> = match object(raw.get()) {
            Ok(image) => image,
            Err(cause) => return faults.add(fault(cause)),
        };
        let id = match Id::of(image.id) {
            Ok(id) => id,
            Err(cause) => return faults.add(fault(cause)),
        };
        last_image = last_image.max(id.number());
        let key = match pictures.locate(path, &image.file_name) {
            Ok(Located::One(key)) => key.clone(),
            Ok(Located::None) => {
                faults.add(fault(format!("the dataset has no image {:?}", image.file_name)));
                by_id.entry(id).or_insert((None, [f64::NAN; 2]));
                return;
            }
            Ok(Located::Several(one, other)) => {
                let name = image.file_name;
                faults.add(fault(format!("{name:?} may be {one} or {other}; give its folder in file_name")));
                by_id.entry(id).or_insert((None, [f64::NAN; 2]));
                return;
            }
            Err(cause) => {
                return faults.add(fault(format!("file_name {:?} is {cause}", image.file_name)));
            }
        };
        let place = match places.get(&key) {
            Some(place) => {
                faults.add(fault(format!("{key} has more than one entry")).of(&key));
                *place
            }
            None => {
                let place = u32::try_from(keys.len()).unwrap_or(u32::MAX);
                places.insert(key.clone(), place);
                keys.push(key.clone());
                place
            }
        };
        let sides = [image.width, image.height].map(|side| side.unwrap_or(f64::NAN));
        if by_id.insert(id, (Some(place), sides)).is_some() {
            faults.add(fault(format!("another image has its id {id}")).of(&key));
        }
        entries.push((number, place));
    };
    each(images, &mut |number, raw| {
        see_image(number, raw);
        Ok(())
    })
    .map_err(|error| error.to_string())?;
    let (mut ids, mut last_annotation) = (BTreeSet::new(), 0);
    let mut see_annotation = |number: usize, raw: &'a RawValue| {
        let fault = |cause: String| Fault::new(format!("{path}, annotations[{number}]"), cause);
        let annotation: Annotation<'_> = match object(raw.get()) {
            Ok(annotation) => annotation,
            Err(cause) => return faults.add(fault(cause)),
        };
        let known = match Id::of(annotation.image_id) {
            Ok(id) => by_id.get(&id).ok_or_else(|| format!("no image has the id {id}")),
            Err(cause) => Err(format!("of its image {cause}")),
        };
        let (key, size) = match known {
            Ok(known) => known,
            Err(cause) => return faults.add(fault(cause)),
        };
        let mut wrong = |cause: String| {
            let fault = fault(cause);
            faults.add(match key.and_then(|place| keys.get(place as usize)) {
                Some(key) => fault.of(key),
                None => fault,
            });
        };
        match annotation.id.map(Id::of) {
            Some(Ok(id)) => {
                last_annotation = last_annotation.max(id.number());
                if !ids.insert(id) {
                    wrong(format!("another annotation has its id {id}"));
                }
            }
            Some(Err(cause)) => wrong(cause),
            None => {}
        }
        if annotation.segments_info.is_some() {
            wrong("it is a panoptic map, which cannot be carried; export outlines or boxes".to_owned());
        }
        if let Some(cause) = annotation.bbox.and_then(|sides| outside(sides, *size)) {
            wrong(cause);
        }
    };
    each(annotations, &mut |number, raw| {
        see_annotation(number, raw);
        Ok(())
    })
    .map_err(|error| error.to_string())?;
    let first_annotation = last_annotation.saturating_add(1);
    Ok((File { path: path.to_owned(), keys, entries, first_image: 0, first_annotation }, last_image))
}

/// An object with the fields of `T`: a list of their values, which would do as well for the reader of JSON, is none.
pub(crate) fn object<'a, T: Deserialize<'a>>(text: &'a str) -> Result<T, String> {
    if !text.trim_start().starts_with('{') {
        return Err("it is not a JSON object".into());
    }
    serde_json::from_str(text).map_err(|error| one_line(&error.to_string()))
}

/// Why a text is no JSON, with the place, and what to do.
pub(super) fn no_json(text: &str, error: &serde_json::Error) -> String {
    let (line, column) = (error.line(), error.column());
    if error.is_eof() {
        return format!(
            "it is not JSON: it ends too early, at line {line} column {column}; get a complete copy"
        );
    }
    let words = text.lines().nth(line.saturating_sub(1)).unwrap_or_default();
    let begins = |back: usize, name: &str| {
        words.get(column.saturating_sub(back)..).is_some_and(|rest| rest.starts_with(name))
    };
    let is_python = ["NaN", "Infinity", "-Infinity"].iter().any(|name| (1..3).any(|back| begins(back, name)));
    let remedy = if is_python { "NaN and Infinity are no JSON: write null" } else { "correct it there" };
    format!("it is not JSON: {}; {remedy}", one_line(&error.to_string()))
}

/// What is wrong with a box, where it is not inside its image. A box without numbers is none.
fn outside(sides: &RawValue, [width, height]: [f64; 2]) -> Option<String> {
    let Ok(sides) = serde_json::from_str::<Sides>(sides.get()) else {
        return Some("its box is not a list of numbers".to_owned());
    };
    let [x, y, w, h] = match sides {
        Sides { count: 0, .. } => return None,
        Sides { first, count: 4 } => first,
        Sides { count, .. } => return Some(format!("its box has {count} numbers instead of 4")),
    };
    let within = |low: f64, length: f64, size: f64| {
        low >= -SLACK && length >= 0.0 && (size.is_nan() || low + length <= size + SLACK)
    };
    (!(within(x, w, width) && within(y, h, height)))
        .then(|| format!("the box {x}, {y}, {w}, {h} is not inside the image"))
}

/// The entry of an image, which was read before.
pub(crate) fn image_at(place: usize, raw: &RawValue) -> io::Result<Image<'_>> {
    object(raw.get()).map_err(|cause| invalid(format!("images[{place}]: {cause}")))
}

fn invalid(cause: String) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, cause)
}

/// The lists of a file that are taken apart, `images` and `annotations`, as they stand.
pub(crate) fn lists(text: &str) -> io::Result<[Option<&RawValue>; 2]> {
    let [mut images, mut annotations, mut categories] = [None; 3];
    entries::fields(text, &mut |name, value| {
        let list = match name {
            "images" => &mut images,
            "annotations" => &mut annotations,
            "categories" => &mut categories,
            _ => return Ok(()),
        };
        match list.replace(value) {
            None => Ok(()),
            Some(_) => Err(invalid(format!("it has `{name}` twice"))),
        }
    })?;
    Ok([images, annotations])
}

/// Shows the items of a list that may be missing.
pub(crate) fn each<'a>(
    list: Option<&'a RawValue>,
    see: &mut dyn FnMut(usize, &'a RawValue) -> io::Result<()>,
) -> io::Result<()> {
    list.map_or(Ok(()), |list| entries::items(list.get(), see))
}

/// Reads a file for nothing but that, as one about two images: for a target of fuzzing.
#[cfg(feature = "fuzz-targets")]
pub(crate) fn try_examine(text: &str) -> Option<(File, Vec<Sample>)> {
    let files = ["a.jpg", "images/b.jpg"].map(str::to_owned).into_iter().collect();
    let tree = Tree::holding(std::path::PathBuf::new(), files, &ReadOptions::default());
    let (file, _) = examine(&Pictures::of(&tree), "instances.json", text, &mut Faults::default()).ok()?;
    let keys: BTreeSet<&String> = file.keys.iter().collect();
    let samples = keys.into_iter().map(|key| Sample::new(key, Vec::new())).collect();
    Some((file, samples))
}
